"""What failed, was refused, was left out or gave a warning: from a run, and by kind for a page."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from nodegraph.execute import Run
from nodegraph.formatting import labels_of
from nodegraph.plan import Step
from nodegraph.report.study import Kind, StepNote, Study
from nodegraph.runs.settings import RunSettings
from nodegraph.state import State

_KIND_OF_STATE: dict[State, Kind] = {
    State.FAILED: Kind.FAILED,
    State.REFUSED: Kind.REFUSED,
    State.SKIPPED: Kind.LEFT_OUT,
}
_TITLES: tuple[tuple[Kind, str, str], ...] = (
    (
        Kind.FAILED,
        "Failed",
        "An error stopped these; what depends on a step that failed was not run.",
    ),
    (Kind.REFUSED, "Refused", "The method cannot process this data, and gives the reason."),
    (
        Kind.LEFT_OUT,
        "Left out",
        "These combinations were not wanted, or lack an input.",
    ),
    (Kind.WARNING, "Warnings", "These steps ran, with warnings about their results."),
)
_NUMBER = re.compile(r"(?<![A-Za-z_\d])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?", re.IGNORECASE)


def step_notes(run: Run, settings: RunSettings) -> tuple[StepNote, ...]:
    """Return a note for everything in a run that failed, was left out, or gave a warning."""
    return (
        *_settled(run, settings),
        *_left_out_by_plan(run),
        *_left_out_by_command(run),
        *_noticed(run),
        *_warned(run),
    )


def _settled(run: Run, settings: RunSettings) -> Iterator[StepNote]:
    for step, outcome in run.settled(*_KIND_OF_STATE):
        repeat = settings.repeat(step) if outcome.state is State.FAILED else ""
        yield StepNote(
            _name(step),
            labels_of(step.labels),
            outcome.message,
            _KIND_OF_STATE[outcome.state],
            repeat=repeat,
            trace=outcome.trace,
        )


def _left_out_by_plan(run: Run) -> Iterator[StepNote]:
    for reason, counts in run.plan.skipped_together().items():
        yield StepNote(", ".join(counts), "", reason, Kind.LEFT_OUT, count=sum(counts.values()))


def _left_out_by_command(run: Run) -> Iterable[StepNote]:
    return (
        StepNote(", ".join(nodes), "", reason, Kind.LEFT_OUT, count=len(nodes))
        for reason, nodes in run.plan.graph.left_out_together().items()
    )


def _noticed(run: Run) -> Iterable[StepNote]:
    return (
        StepNote(str(notice.place), "", f"{notice.message}: {notice.instead}", Kind.WARNING)
        for notice in run.plan.graph.notices
    )


def _warned(run: Run) -> Iterator[StepNote]:
    for step, outcome in run.settled():
        for message in outcome.warnings:
            yield StepNote(_name(step), labels_of(step.labels), message, Kind.WARNING)


def _name(step: Step) -> str:
    return f"{step.node} ({step.method.node.name})"


@dataclass(frozen=True, slots=True)
class NoteGroup:
    """Notes of one node with one reason, apart from the numbers in warnings."""

    node: str
    reason: str
    count: int
    labels: tuple[str, ...]
    repeat: str
    trace: str


@dataclass(frozen=True, slots=True)
class NoteKind:
    """All notes of one kind."""

    kind: Kind
    title: str
    meaning: str
    anchor: str
    count: int
    steps: int
    groups: tuple[NoteGroup, ...]

    def __str__(self) -> str:
        if self.kind is not Kind.WARNING:
            return f"{self.count} {self.kind}"
        if len(self.groups) == self.count:
            return _counted(self.count, "warning")
        kinds = (
            "1 kind of warning"
            if len(self.groups) == 1
            else f"{len(self.groups)} kinds of warnings"
        )
        return f"{kinds} in {_counted(self.steps, 'step')}"


def note_kinds(study: Study) -> tuple[NoteKind, ...]:
    """Return the notes of a study by kind, the most severe first, without empty kinds."""
    kinds = []
    for kind, title, meaning in _TITLES:
        notes = [note for note in study.notes if note.kind == kind]
        count = sum(note.count for note in notes)
        anchor = f"notes-{kind.replace(' ', '-')}"
        if notes:
            steps = len({(note.node, note.labels) for note in notes})
            kinds.append(NoteKind(kind, title, meaning, anchor, count, steps, _groups(notes)))
    return tuple(kinds)


def _groups(notes: Iterable[StepNote]) -> tuple[NoteGroup, ...]:
    together: dict[tuple[str, str], list[StepNote]] = {}
    for note in notes:
        together.setdefault((note.node, _alike(note)), []).append(note)
    groups = [
        NoteGroup(
            node=node,
            reason=same[0].reason if _have_one_reason(same) else reason,
            count=sum(note.count for note in same),
            labels=tuple(
                _labels(note, with_reason=not _have_one_reason(same))
                for note in same
                if note.labels
            ),
            repeat=next((note.repeat for note in same if note.repeat), ""),
            trace=next((note.trace for note in same if note.trace), ""),
        )
        for (node, reason), same in together.items()
    ]
    return tuple(sorted(groups, key=lambda group: -group.count))


def _alike(note: StepNote) -> str:
    """Return the reason of a note; of a warning without its numbers, which differ by step."""
    return _NUMBER.sub("…", note.reason) if note.kind is Kind.WARNING else note.reason


def _have_one_reason(notes: Iterable[StepNote]) -> bool:
    return len({note.reason for note in notes}) == 1


def _labels(note: StepNote, *, with_reason: bool) -> str:
    return f"{note.labels}: {note.reason}" if with_reason else note.labels


def _counted(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"

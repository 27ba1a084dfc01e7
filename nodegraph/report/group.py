"""Equal things of a study put together, so that thousands of them can be read."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import groupby

from nodegraph.report.study import Kind, Section, StepNote, Study

_KINDS: tuple[tuple[Kind, str, str], ...] = (
    (
        "failed",
        "Failed",
        "An error stopped these; what depends on a step that failed was not run.",
    ),
    ("refused", "Refused", "The method cannot do what is asked of this data, and says why."),
    ("left out", "Left out", "These combinations were not asked for, or had nothing to work on."),
    ("warning", "Warnings", "These steps ran, and have something to say about their result."),
)
_NUMBER = re.compile(r"(?<![A-Za-z_\d])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Titled:
    """Sections with one title."""

    title: str
    anchor: str
    sections: tuple[Section, ...]


@dataclass(frozen=True, slots=True)
class NoteGroup:
    """Notes of one node with one reason, but for the numbers in warnings."""

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
        if self.kind != "warning":
            return f"{self.count} {self.kind}"
        if len(self.groups) == self.count:
            return _counted(self.count, "warning")
        kinds = (
            "1 kind of warning"
            if len(self.groups) == 1
            else f"{len(self.groups)} kinds of warnings"
        )
        return f"{kinds} in {_counted(self.steps, 'step')}"


def titled(sections: Iterable[Section]) -> tuple[Titled, ...]:
    """Return sections that follow each other with one title as one."""
    runs = groupby(sections, key=lambda section: section.title)
    return tuple(
        Titled(title, f"result-{number}", tuple(run)) for number, (title, run) in enumerate(runs, 1)
    )


def note_kinds(study: Study) -> tuple[NoteKind, ...]:
    """Return the study's notes by kind, the gravest first; kinds without notes are left out."""
    kinds = []
    for kind, title, meaning in _KINDS:
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
            reason=same[0].reason if _one_reason(same) else reason,
            count=sum(note.count for note in same),
            labels=tuple(_labels(note, say=not _one_reason(same)) for note in same if note.labels),
            repeat=next((note.repeat for note in same if note.repeat), ""),
            trace=next((note.trace for note in same if note.trace), ""),
        )
        for (node, reason), same in together.items()
    ]
    return tuple(sorted(groups, key=lambda group: -group.count))


def _alike(note: StepNote) -> str:
    """Return a note's reason; of a warning without its numbers, of which each step has its own."""
    return _NUMBER.sub("…", note.reason) if note.kind == "warning" else note.reason


def _one_reason(notes: Iterable[StepNote]) -> bool:
    return len({note.reason for note in notes}) == 1


def _labels(note: StepNote, *, say: bool) -> str:
    return f"{note.labels}: {note.reason}" if say else note.labels


def _counted(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"

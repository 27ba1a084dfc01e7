"""Notes on failures, refusals, exclusions and warnings: from a run, and by kind for a page."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from nodegraph.errors import listed
from nodegraph.formatting import labels_of, number_of
from nodegraph.report.study import NoteSubject, StepNote, Study
from nodegraph.state import State

if TYPE_CHECKING:
    from nodegraph.execute.results import Run
    from nodegraph.graph import Graph

_KIND_OF_STATE: dict[State, NoteSubject] = {
    State.FAILED: NoteSubject.FAILED,
    State.REFUSED: NoteSubject.REFUSED,
    State.SKIPPED: NoteSubject.LEFT_OUT,
}
_TITLES: tuple[tuple[NoteSubject, str, str], ...] = (
    (
        NoteSubject.FAILED,
        "Failed",
        "An error stopped these; what depends on a step that failed was not run.",
    ),
    (NoteSubject.REFUSED, "Refused", "The method cannot process this data, and gives the reason."),
    (
        NoteSubject.LEFT_OUT,
        "Left out",
        "These combinations were not wanted, or lack an input.",
    ),
    (NoteSubject.WARNING, "Warnings", "These steps ran, with warnings about their results."),
)
_QUOTE = re.compile(r"(?<!\w)(?:'[^']*'|\"[^\"]*\"|`[^`]*`)(?!\w)")
_NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?!\w)", re.IGNORECASE)
_NAME = re.compile(r"(?<![\w.])(?:\w*[A-Za-z]_?\d\w*|\w+_\w+)")
_LIST = re.compile(r"(?<=: )[^\s,;:]+(?:, (?:and )?[^\s,;:]+)*(?: more)?(?=[,;.]? |[;.]?$)")
_SEVERAL = re.compile(r"…(?:(?:,? and|,|;)? …)+")
_MOST_METHODS = 8


def step_notes(run: Run) -> tuple[StepNote, ...]:
    """Return a note for everything in a run that failed, was left out, or gave a warning."""
    return (
        *_settled(run),
        *_left_out(run),
        *_noticed(run),
        *_warned(run),
    )


def _settled(run: Run) -> Iterator[StepNote]:
    for step, outcome in run.settled(*_KIND_OF_STATE):
        repeat = run.settings.repeat(step) if outcome.state is State.FAILED else ""
        yield StepNote(
            step.node,
            labels_of(step.labels),
            outcome.message,
            _KIND_OF_STATE[outcome.state],
            repeat=repeat,
            trace=outcome.trace,
            method=step.method.node.name,
        )


def _left_out(run: Run) -> Iterator[StepNote]:
    """Yield notes on combinations that are not planned, and on nodes that are not in the run."""
    nodes = run.plan.graph.left_out_together()
    counts = [*run.plan.skipped_together().items()]
    counts += [(reason, Counter(names)) for reason, names in nodes.items()]
    for reason, count in counts:
        yield StepNote(
            ", ".join(count), "", reason, NoteSubject.LEFT_OUT, count=sum(count.values())
        )


def _noticed(run: Run) -> Iterable[StepNote]:
    return (
        StepNote(str(notice.place), "", f"{notice.message}: {notice.instead}", NoteSubject.WARNING)
        for notice in run.plan.graph.notices
    )


def _warned(run: Run) -> Iterator[StepNote]:
    for step, outcome in run.settled():
        for message in outcome.warnings:
            yield StepNote(
                step.node,
                labels_of(step.labels),
                message,
                NoteSubject.WARNING,
                method=step.method.node.name,
            )


def with_relevance(
    notes: Iterable[StepNote], graph: Graph, numbers: Iterable[str]
) -> Iterator[StepNote]:
    """Yield notes; warnings say whether the numbers of the report depend on their nodes.

    Parameters
    ----------
    notes
    graph
    numbers
        The nodes whose numbers the report shows.
    """
    import networkx as nx

    ends = set(numbers) & set(graph.nodes)
    touching = ends.union(*(nx.ancestors(graph.network, end) for end in ends))
    for note in notes:
        known = note.kind is NoteSubject.WARNING and note.node in graph.nodes
        yield replace(note, matters=note.node in touching) if known else note


@dataclass(frozen=True, slots=True)
class NoteGroup:
    """Notes of one node with one reason, apart from the numbers and names in warnings.

    Attributes
    ----------
    node : str
        Several, if they were left out for the same reason.
    methods : tuple of str
        The methods of the node that gave such a note, by their full names.
    reason : str
        With ``…`` for what differs among the notes.
    count : int
        Number of combinations.
    labels : tuple of str
        The combinations, each with its reason where these differ.
    repeat, trace : str
        The command to repeat the first, and its traceback.
    matters : bool, optional
        Whether the numbers of the report depend on the node; None where that is not known.
    """

    node: str
    methods: tuple[str, ...]
    reason: str
    count: int
    labels: tuple[str, ...]
    repeat: str
    trace: str
    matters: bool | None

    @property
    def where(self) -> str:
        """The node with its methods: ``fill (akima, linear)``."""
        names = [method.rpartition(".")[2] for method in self.methods]
        if len(names) == 1:
            names = list(self.methods)
        return f"{self.node} ({listed(names, _MOST_METHODS)})" if names else self.node


@dataclass(frozen=True, slots=True)
class NoteKind:
    """The notes of one kind."""

    kind: NoteSubject
    title: str
    meaning: str
    anchor: str
    count: int
    steps: int
    groups: tuple[NoteGroup, ...]

    def __str__(self) -> str:
        if self.kind is not NoteSubject.WARNING:
            return f"{self.count} {self.kind}"
        if len(self.groups) == self.count:
            return number_of(self.count, "warning")
        kinds = (
            "1 kind of warning"
            if len(self.groups) == 1
            else f"{len(self.groups)} kinds of warnings"
        )
        return f"{kinds} in {number_of(self.steps, 'step')}"


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
    alike: dict[tuple[str, str], list[StepNote]] = {}
    for note in notes:
        # what was left out together is one thing, whatever nodes it has
        node = "" if note.kind is NoteSubject.LEFT_OUT else note.node
        alike.setdefault((node, _template(note)), []).append(note)
    groups = [_group(together, template) for (_, template), together in alike.items()]
    return tuple(sorted(groups, key=lambda group: (not group.matters, -group.count)))


def _template(note: StepNote) -> str:
    """Return a reason; of a warning with ``…`` for numbers, names and lists of them.

    The names are those in quotes, with digits or underscores, or in a list after a colon.
    """
    if note.kind is not NoteSubject.WARNING:
        return note.reason
    text = _NAME.sub("…", _NUMBER.sub("…", _QUOTE.sub("…", note.reason)))
    return _SEVERAL.sub("…", _LIST.sub("…", text))


def _group(notes: list[StepNote], template: str) -> NoteGroup:
    same = len({note.reason for note in notes}) == 1
    return NoteGroup(
        node=", ".join(dict.fromkeys(note.node for note in notes)),
        methods=tuple(dict.fromkeys(note.method for note in notes if note.method)),
        reason=notes[0].reason if same else template,
        count=sum(note.count for note in notes),
        labels=tuple(
            note.labels if same else f"{note.labels}: {note.reason}"
            for note in notes
            if note.labels
        ),
        repeat=next((note.repeat for note in notes if note.repeat), ""),
        trace=next((note.trace for note in notes if note.trace), ""),
        matters=notes[0].matters,
    )

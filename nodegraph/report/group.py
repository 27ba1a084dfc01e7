"""Equal things of a study put together, so that thousands of them can be read."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import groupby

from nodegraph.report.study import Kind, Section, StepNote, Study

_KINDS: tuple[tuple[Kind, str, str], ...] = (
    ("failed", "Failed", "An error stopped these steps; what depends on them was not run."),
    ("refused", "Refused", "The method cannot do what is asked of this data, and says why."),
    ("left out", "Left out", "These combinations were not asked for, or had nothing to work on."),
    ("warning", "Warnings", "These steps ran, and have something to say about their result."),
)


@dataclass(frozen=True, slots=True)
class Titled:
    """Sections with one title."""

    title: str
    anchor: str
    sections: tuple[Section, ...]


@dataclass(frozen=True, slots=True)
class NoteGroup:
    """Notes of one node with one reason."""

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
    groups: tuple[NoteGroup, ...]

    def __str__(self) -> str:
        plural = "s" if self.kind == "warning" and self.count != 1 else ""
        return f"{self.count} {self.kind}{plural}"


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
            kinds.append(NoteKind(kind, title, meaning, anchor, count, _groups(notes)))
    return tuple(kinds)


def _groups(notes: Iterable[StepNote]) -> tuple[NoteGroup, ...]:
    together: dict[tuple[str, str], list[StepNote]] = {}
    for note in notes:
        together.setdefault((note.node, note.reason), []).append(note)
    groups = [
        NoteGroup(
            node=node,
            reason=reason,
            count=sum(note.count for note in same),
            labels=tuple(note.labels for note in same if note.labels),
            repeat=next((note.repeat for note in same if note.repeat), ""),
            trace=next((note.trace for note in same if note.trace), ""),
        )
        for (node, reason), same in together.items()
    ]
    return tuple(sorted(groups, key=lambda group: -group.count))

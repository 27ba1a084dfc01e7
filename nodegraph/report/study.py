"""What a report shows, as plain data: nothing here knows where it came from."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import PurePosixPath
from typing import Literal, TypeVar

from nodegraph.plugin.hook_types import Rendered

Kind = Literal["failed", "refused", "left out", "warning"]


@dataclass(frozen=True, slots=True)
class Link:
    """A file beside the report: what it is called, and its path from the report's folder."""

    text: str
    path: str


@dataclass(frozen=True, slots=True)
class Section:
    """One result.

    Attributes
    ----------
    title : str
        Sections that follow each other with one title are shown together.
    rendered : Rendered
        Its HTML is taken as it is; without HTML, its text is shown.
    labels : str
        Which combination, if the node still has axes: ``length=5``.
    files : tuple of Link
    """

    title: str
    rendered: Rendered
    labels: str = ""
    files: tuple[Link, ...] = ()


@dataclass(frozen=True, slots=True)
class SettingRow:
    """A setting as it was used; several values are written as one text.

    Attributes
    ----------
    name, value, unit : str
    default : bool
    meaning : str
    in_print : str
        The value with the names of files alone, where it has their folders too.
    """

    name: str
    value: str
    unit: str = ""
    default: bool = False
    meaning: str = ""
    in_print: str = ""


@dataclass(frozen=True, slots=True)
class MethodRow:
    """A method that gave a result.

    Attributes
    ----------
    node, label, use : str
        The node in the graph, the alternative's label if it is one, the method's full name.
    summary : str
        The first sentence of the method's documentation.
    settings : tuple of SettingRow
        Their values are those at which there is a result.
    citation : str
        The sources to cite, as they are printed, a line each.
    plugin : str
        Which package brought the method.
    keys : tuple of str
        The BibTeX entries that it cites.
    """

    node: str
    use: str
    summary: str = ""
    label: str = ""
    settings: tuple[SettingRow, ...] = ()
    citation: str = ""
    plugin: str = ""
    keys: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class WithoutResult:
    """A method of the graph that gave no result at any combination.

    Attributes
    ----------
    node, use, label : str
        As in `MethodRow`.
    reason : str
        What became of its combinations: ``2 failed, 1 left out``.
    """

    node: str
    use: str
    label: str = ""
    reason: str = ""

    def __str__(self) -> str:
        called = f"{self.node}={self.label}" if self.label else self.node
        return f"{called} ({self.use}): {self.reason}"


@dataclass(frozen=True, slots=True)
class AxisRow:
    """An axis with its labels."""

    name: str
    labels: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class StepNote:
    """Something that the reader must know about a step.

    Attributes
    ----------
    node, labels : str
        The node and the combination: ``fill=muscle, trial=3``.
    reason : str
    kind : {"failed", "refused", "left out", "warning"}
    count : int
        For how many combinations the note stands.
    repeat : str
        The command that runs this step alone.
    trace : str
        Where an error happened, for the method's author.
    """

    node: str
    labels: str
    reason: str
    kind: Kind
    count: int = 1
    repeat: str = ""
    trace: str = ""


@dataclass(frozen=True, slots=True)
class TimingRow:
    """How long a node took: its steps, all their seconds, those of the longest; how many stored.

    A stored step counts with the time that it took when it was computed.
    """

    node: str
    steps: int
    seconds: float
    longest: float = 0.0
    stored: int = 0


@dataclass(frozen=True, slots=True)
class Study:
    """Everything that a report shows, in the order in which it is shown.

    Attributes
    ----------
    title : str
    answer : tuple of str
        The conclusions, a sentence each.
    notes_markdown : str
        The author's notes: the question. Raw HTML and pictures in it are shown as text.
    sections : tuple of Section
    graph_svg : str
        Taken as it is; see `nodegraph.draw.svg`.
    axes : tuple of AxisRow
    inputs : tuple of SettingRow
        The graph's inputs as they were set.
    known : tuple of str
        What methods were allowed to know of the answer.
    methods : tuple of MethodRow
    without_result : tuple of WithoutResult
    bibtex : str
        The entries that the methods cite.
    notes : tuple of StepNote
        Everything that failed or cannot be shown, was refused, was left out, or warned.
    timings : tuple of TimingRow
    seconds : float
        Wall-clock time of the run.
    versions : tuple of (name, version)
    seeds : tuple of (node, seeds)
    command : str
        Repeats the run, quoted for a shell.
    graph_file, graph_text : str
        The graph as it was run.
    files : tuple of Link
        Files of the whole run.
    created, machine : str
        When and where it ran.
    runs : int
        How many runs it shows, their results beside each other.
    """

    title: str
    answer: tuple[str, ...] = ()
    notes_markdown: str = ""
    sections: tuple[Section, ...] = ()
    graph_svg: str = ""
    axes: tuple[AxisRow, ...] = ()
    inputs: tuple[SettingRow, ...] = ()
    known: tuple[str, ...] = ()
    methods: tuple[MethodRow, ...] = ()
    without_result: tuple[WithoutResult, ...] = ()
    bibtex: str = ""
    notes: tuple[StepNote, ...] = ()
    timings: tuple[TimingRow, ...] = ()
    seconds: float = 0.0
    versions: tuple[tuple[str, str], ...] = ()
    seeds: tuple[tuple[str, str], ...] = ()
    command: str = ""
    graph_file: str = ""
    graph_text: str = ""
    files: tuple[Link, ...] = ()
    created: str = ""
    machine: str = ""
    runs: int = 1

    @property
    def ok(self) -> bool:
        """Whether no step failed, and all that the report lists is shown."""
        return not any(note.kind == "failed" for note in self.notes)


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


T = TypeVar("T")


def merged(studies: Mapping[str, Study]) -> Study:
    """Return one study of several runs.

    What has one title stands together, a run after the other; each result, note, method and time
    is labelled with the name of its run. A method that ran alike everywhere is told once.

    Parameters
    ----------
    studies
        By the names of the runs, two at least.
    """
    first = next(iter(studies.values()))
    every = studies.items()
    return Study(
        title=" | ".join(dict.fromkeys(one.title for one in studies.values())),
        answer=tuple(f"{name}: {line}" for name, one in every for line in one.answer),
        notes_markdown="\n\n".join(dict.fromkeys(one.notes_markdown for one in studies.values())),
        sections=tuple(_sections(studies)),
        graph_svg=first.graph_svg,
        axes=first.axes if _same(one.axes for one in studies.values()) else (),
        inputs=tuple(_inputs(studies)),
        known=tuple(dict.fromkeys(one for study in studies.values() for one in study.known)),
        methods=tuple(dict.fromkeys(one for study in studies.values() for one in study.methods)),
        without_result=tuple(
            replace(one, reason=f"{one.reason} ({name})")
            for name, study in every
            for one in study.without_result
        ),
        bibtex="\n".join(dict.fromkeys(one.bibtex for one in studies.values() if one.bibtex)),
        notes=tuple(
            replace(note, labels=_and(name, note.labels))
            for name, one in every
            for note in one.notes
        ),
        timings=tuple(
            replace(row, node=f"{row.node} ({name})") for name, one in every for row in one.timings
        ),
        seconds=sum(one.seconds for one in studies.values()),
        versions=tuple(_versions(studies)),
        seeds=tuple((f"{node} ({name})", text) for name, one in every for node, text in one.seeds),
        command="\n".join(one.command for one in studies.values()),
        graph_file=first.graph_file,
        graph_text=first.graph_text,
        files=tuple(
            replace(link, text=f"{name}: {link.text}") for name, one in every for link in one.files
        ),
        created=" | ".join(dict.fromkeys(one.created for one in studies.values())),
        machine=" | ".join(dict.fromkeys(one.machine for one in studies.values())),
        runs=len(studies),
    )


def linked(study: Study, folder: str) -> Study:
    """Return a study whose files lie in a folder, as seen from the page: ``../runs/fill``."""
    sections = (replace(one, files=_moved(one.files, folder)) for one in study.sections)
    return replace(study, sections=tuple(sections), files=_moved(study.files, folder))


def _moved(links: Iterable[Link], folder: str) -> tuple[Link, ...]:
    return tuple(replace(link, path=str(PurePosixPath(folder, link.path))) for link in links)


def _sections(studies: Mapping[str, Study]) -> Iterator[Section]:
    titles = dict.fromkeys(one.title for study in studies.values() for one in study.sections)
    for title in titles:
        for name, study in studies.items():
            for one in study.sections:
                if one.title == title:
                    yield replace(one, labels=_and(name, one.labels))


def _inputs(studies: Mapping[str, Study]) -> Iterator[SettingRow]:
    """Yield the inputs, those that differ once per run."""
    for name in dict.fromkeys(row.name for one in studies.values() for row in one.inputs):
        rows = {run: row for run, one in studies.items() for row in one.inputs if row.name == name}
        if _same(rows.values()) and len(rows) == len(studies):
            yield next(iter(rows.values()))
        else:
            yield from (replace(row, name=f"{name} ({run})") for run, row in rows.items())


def _versions(studies: Mapping[str, Study]) -> Iterator[tuple[str, str]]:
    for name in dict.fromkeys(name for one in studies.values() for name, _ in one.versions):
        found = [dict(one.versions).get(name, "none") for one in studies.values()]
        yield name, " | ".join(dict.fromkeys(found))


def _same(values: Iterable[T]) -> bool:
    found = list(values)
    return all(one == found[0] for one in found)


def _and(name: str, labels: str) -> str:
    return f"{name}, {labels}" if labels else name

"""The study that a report shows, as plain data, and the file that keeps it beside the report."""

from __future__ import annotations

import gzip
import json
import warnings
import zlib
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path, PurePath

from nodegraph.errors import NodegraphError
from nodegraph.formatting import number_of
from nodegraph.plugin.hook_types import Rendered
from nodegraph.report.foreign import passive, without_foreign_code
from nodegraph.runs.folder import STUDY, content_of, missing
from nodegraph.validation_errors import adapter_of, first_error

_MOST_BYTES = 256_000_000
"""Largest study file that is read, in bytes; the file may be another person's."""


class NoteSubject(StrEnum):
    """The subject of a note."""

    FAILED = "failed"
    REFUSED = "refused"
    LEFT_OUT = "left out"
    WARNING = "warning"


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
        The combination, if the node still has axes: ``length=5``.
    files : tuple of Link
    node, output : str
        Where it comes from.
    caption : str
        The author's; empty for none.
    notes_markdown : str
        The author's notes beside it, as those of the study.
    number : str
        ``Table 1``; empty for what has none.
    is_replaced : bool
        Whether another section of the node shows it too, so that only its files are linked.
    run, question : str
        The run that it is of, and the title of its study, where there are several.
    """

    title: str
    rendered: Rendered
    labels: str = ""
    files: tuple[Link, ...] = ()
    node: str = ""
    output: str = ""
    caption: str = ""
    notes_markdown: str = ""
    number: str = ""
    is_replaced: bool = False
    run: str = ""
    question: str = ""

    @property
    def answer(self) -> tuple[str, ...]:
        """The answer of the value, each sentence with the combination that it is about."""
        place = f"{self.where}: " if self.where else ""
        return tuple(f"{place}{sentence}" for sentence in self.rendered.answer)

    @property
    def first_answer(self) -> str:
        """What the value answers at a glance, and what that holds for."""
        return " ".join((*self.answer[:1], *self.rendered.answer[1:2]))

    @property
    def where(self) -> str:
        """The run and the combination, as far as there are several."""
        labels = ", ".join(part.replace("=", " ", 1) for part in self.labels.split(", "))
        return ", ".join(filter(None, [self.run, labels]))


def numbered(sections: Iterable[Section]) -> tuple[Section, ...]:
    """Return sections with the numbers of their tables and figures.

    What another section of the same node shows too has none. Sections of one title come together,
    those with a lead first. Notes that several sections of a node have stand with the first.
    """
    listed = list(sections)
    places: dict[tuple[str, str], int] = {}
    for section in listed:
        places.setdefault((section.question, section.title), len(places))
    listed.sort(key=lambda each: (places[each.question, each.title], not each.rendered.lead))
    replaced = {
        (section.run, section.node, output)
        for section in listed
        for output in section.rendered.replaces
    }
    counts: Counter[str] = Counter()
    noted: set[tuple[str, str, str]] = set()
    result = []
    for section in listed:
        is_replaced = (section.run, section.node, section.output) in replaced
        kind = "" if is_replaced else section.rendered.kind
        counts[kind] += 1
        number = f"{kind.capitalize()} {counts[kind]}" if kind else ""
        words = (section.run, section.node, section.notes_markdown)
        notes = "" if words in noted else section.notes_markdown
        noted.add(words)
        result.append(
            replace(section, number=number, is_replaced=is_replaced, notes_markdown=notes)
        )
    return tuple(result)


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
    declared : tuple of str
        Declarations: its source, how far it looks ahead, whether it meets the ends of gaps.
    settings : tuple of SettingRow
        Their values are those at which there is a result.
    citation : str
        The sources to cite, as they are printed, a line each.
    plugin : str
        Package that provides the method.
    keys : tuple of str
        The BibTeX entries that it cites.
    damages : bool
        Whether it damages what it takes, and also gives the truth.
    """

    node: str
    use: str
    summary: str = ""
    label: str = ""
    settings: tuple[SettingRow, ...] = ()
    citation: str = ""
    plugin: str = ""
    keys: tuple[str, ...] = ()
    declared: tuple[str, ...] = ()
    damages: bool = False


@dataclass(frozen=True, slots=True)
class WithoutResult:
    """A method of the graph that gave no result at any combination.

    Attributes
    ----------
    node, use, label : str
        As in `MethodRow`.
    reason : str
        How its combinations ended: ``2 failed, 1 left out``.
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
    """An axis with its labels, their unit, and what they are."""

    name: str
    labels: tuple[str, ...]
    unit: str = ""
    meaning: str = ""


@dataclass(frozen=True, slots=True)
class StepNote:
    """Something that the reader must know about a step.

    Attributes
    ----------
    node, labels : str
        The node and the combination: ``fill=muscle, trial=3``.
    reason : str
    kind : NoteSubject
    count : int
        For how many combinations the note stands.
    repeat : str
        The command that runs this step alone.
    trace : str
        Where an error happened, for the method's author.
    method : str
        The method's full name: ``fill.muscle``.
    matters : bool, optional
        Whether a table of the report depends on the node; None where that is not known.
    """

    node: str
    labels: str
    reason: str
    kind: NoteSubject
    count: int = 1
    repeat: str = ""
    trace: str = ""
    method: str = ""
    matters: bool | None = None


@dataclass(frozen=True, slots=True)
class TimingRow:
    """Time of a node: its steps, all their seconds, those of the longest, and the stored steps.

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
    chosen : str
        The options by which the run has other inputs or labels than the author wrote of.
    sections : tuple of Section
    graph_svg, graph_unfolded_svg : str
        Taken as they are; see `nodegraph.draw.svg`. The second shows all nodes, where the first
        has one box for several.
    axes : tuple of AxisRow
    inputs : tuple of SettingRow
        The graph's inputs as they were set.
    known : tuple of str
        Nodes of which methods were allowed to know the answer.
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
        How many runs it shows, their results side by side.
    """

    title: str
    answer: tuple[str, ...] = ()
    notes_markdown: str = ""
    chosen: str = ""
    sections: tuple[Section, ...] = ()
    graph_svg: str = ""
    graph_unfolded_svg: str = ""
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

    def short_answer(self, most: int) -> tuple[str, ...]:
        """Return the first sentences of every value that answers at a glance, as many of each.

        Without such a value, the first of all sentences. What several say stands once.
        """
        leads = [each.answer for each in self.sections if each.rendered.lead]
        answers = leads if any(leads) else [self.answer]
        places = [(line, at) for at, answer in enumerate(answers) for line in range(len(answer))]
        first: dict[str, tuple[int, int]] = {}
        for line, at in sorted(places):
            first.setdefault(answers[at][line], (at, line))
        return tuple(sorted([*first][:most], key=first.__getitem__))

    @property
    def first_answer(self) -> str:
        """What the first value answers that answers at a glance, and what that holds for.

        Without such a value, the first of all sentences.
        """
        leads = (each.first_answer for each in self.sections if each.rendered.lead)
        return next(leads, "".join(self.answer[:1]))

    @property
    def kinds_of_files(self) -> tuple[str, ...]:
        """How many files of each kind belong to results: ``3 CSV``, ``1 C3D``."""
        paths = [PurePath(link.path) for section in self.sections for link in section.files]
        kinds = Counter(path.suffix[1:].upper() or path.name for path in paths)
        return tuple(f"{count:,} {kind}" for kind, count in kinds.items())

    @property
    def ok(self) -> bool:
        """Whether no step failed, and all that the report lists is shown."""
        return not any(note.kind is NoteSubject.FAILED for note in self.notes)


def study_bytes(study: Study) -> bytes:
    """Return a study as compressed JSON."""
    # an error may name a file whose name is not valid text: only JSON's escapes can carry that
    content = json.dumps(adapter_of(Study).dump_python(study))
    return gzip.compress(content.encode(), compresslevel=6, mtime=0)


def read_study(folder: Path) -> Study:
    """Return the study of a saved run, without code that is of no installed package.

    Raises
    ------
    NodegraphError
        If there is none, or this version cannot read it.
    """
    from pydantic import ValidationError

    path = folder / STUDY
    try:
        data = json.loads(content_of(path, _MOST_BYTES))
        return _without_foreign_code(path, adapter_of(Study).validate_python(data))
    except (FileNotFoundError, NotADirectoryError):
        raise missing(path) from None
    except ValidationError as error:
        reason = first_error(error, data)
        raise NodegraphError(f"{path} cannot be read ({reason}); run the graph again") from error
    except (OSError, EOFError, zlib.error, ValueError, RecursionError) as error:
        raise NodegraphError(f"{path} cannot be read ({error}); run the graph again") from error


def _without_foreign_code(path: Path, study: Study) -> Study:
    sections: list[Section] = []
    drawings = study.graph_svg, study.graph_unfolded_svg
    folded, unfolded = map(passive, drawings)
    count = int((folded, unfolded) != drawings)
    for section in study.sections:
        rendered = without_foreign_code(section.rendered)
        count += rendered is not section.rendered
        sections.append(replace(section, rendered=rendered))
    if count:
        warnings.warn(
            f"{path}: {number_of(count, 'result')} with scripts, styles or elements that could "
            "act on the rest of the page and are of no installed package, or of another version of "
            "it; shown without them until the graph is run again",
            stacklevel=3,
        )
    return replace(study, sections=tuple(sections), graph_svg=folded, graph_unfolded_svg=unfolded)

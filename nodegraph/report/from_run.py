"""A run -> the study that its report shows, and the files beside it."""

from __future__ import annotations

import traceback
import warnings
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from typing import NamedTuple

from nodegraph.draw.from_graph import drawing_for_page
from nodegraph.errors import NodegraphError
from nodegraph.execute.events import plain
from nodegraph.execute.results import NotStored, Run, Values
from nodegraph.filenames import file_stem, fold, portable_paths
from nodegraph.formatting import labels_of, size_text
from nodegraph.graph.axis_text import axis_text
from nodegraph.graphfile.spec import ReportEntry
from nodegraph.node.description import value_text
from nodegraph.node.ports import Label
from nodegraph.node.values import Files
from nodegraph.plugin.hook_types import Rendered
from nodegraph.plugin.loading import error_text
from nodegraph.report.methods import Methods
from nodegraph.report.notes import step_notes, with_relevance
from nodegraph.report.origin import RunOrigin, render_in_run
from nodegraph.report.study import (
    AxisRow,
    Link,
    NoteSubject,
    Section,
    SettingRow,
    StepNote,
    Study,
    TimingRow,
    numbered,
)
from nodegraph.runs.folder import EVENTS, RECORD, REPORT, STEPS, STUDY, graph_name
from nodegraph.runs.record import NotShown, versions
from nodegraph.state import State

_FILES = (Link("what ran", RECORD), Link("steps", STEPS), Link("events", EVENTS))

Write = Callable[[str, bytes], str]
"""Writes a file beside the report by its name; returns why that failed, empty if it did not."""


class Composed(NamedTuple):
    """The study of a run, and the results that it should show and cannot."""

    study: Study
    not_shown: tuple[NotShown, ...]


def compose(run: Run, *, write: Write = lambda name, content: "") -> Composed:
    """Return the study of a run; write its tables, its figures and the files of its nodes.

    Parameters
    ----------
    run
    write
        Called with each file as soon as there is one; nothing is written by default.
    """
    graph = run.plan.graph
    shown = _Shown(run, write)
    for result in _results(run):
        shown.add(result)
    software, methods = versions(graph), Methods(run)
    sections = numbered(_with_titles(shown.sections))
    planned = {label for step in run.plan.steps for label in step.labels.items()}
    folded, unfolded = drawing_for_page(graph), drawing_for_page(graph, fold=False)
    study = Study(
        title=graph.title,
        answer=_answer(sections),
        notes_markdown=graph.spec.notes,
        chosen=run.settings.chosen,
        sections=sections,
        graph_svg=folded,
        graph_unfolded_svg=unfolded if unfolded != folded else "",
        axes=tuple(
            AxisRow(
                name,
                tuple(str(label) for label in axis.labels if (name, label) in planned),
                *axis_text(graph, name),
            )
            for name, axis in graph.axes.items()
        ),
        inputs=tuple(SettingRow(name, value_text(value)) for name, value in graph.inputs.items()),
        known=tuple(map(str, graph.spec.known)),
        methods=methods.rows(),
        without_result=methods.without_result(),
        bibtex=methods.bibtex(),
        notes=tuple(with_relevance((*shown.notes, *step_notes(run)), graph, _numbers(shown))),
        timings=_timings(run),
        seconds=run.seconds,
        versions=tuple(software.items()),
        seeds=methods.seeds(),
        command=run.settings.command,
        graph_file=graph.spec.file,
        graph_text=graph.spec.text,
        files=_FILES,
        created=datetime.now().astimezone().isoformat(timespec="minutes"),
        machine=software["platform"],
    )
    return Composed(study, tuple(shown.not_shown))


def first_answer(run: Run) -> str:
    """Return what answers at a glance, and what it holds for, before the run has ended.

    It is empty as long as a result is missing that stands before it in the report.
    """
    for result in _results(run):
        try:
            value = result.values.shown_at(result.labels)
        except NotStored:
            return ""
        entry = result.entry
        origin = RunOrigin(run, result.node, result.labels, entry.caption, entry.answer)
        rendered = render_in_run(value, str(result), origin)
        if rendered is not None and rendered.lead:
            return Section("", rendered, result.combination).first_answer
    return ""


def _answer(sections: Sequence[Section]) -> tuple[str, ...]:
    """Return what all sections answer, those first with which the report begins."""
    if not sections:
        return ("No step that the report shows has a result.",)
    order = sorted(sections, key=lambda section: not section.rendered.lead)
    return tuple(dict.fromkeys(line for section in order for line in section.answer))


def _numbers(shown: _Shown) -> Iterator[str]:
    """Yield the nodes that give numbers: tables, and answers."""
    for section in shown.sections:
        if section.rendered.kind == "table" or section.rendered.answer or section.rendered.lead:
            yield section.node


def _with_titles(sections: Sequence[Section]) -> Iterator[Section]:
    """Yield sections with a heading: of another output of the node, or the name in the graph."""
    titles = {each.node: each.title for each in reversed(sections) if each.title}
    for section in sections:
        title = section.title or titles.get(section.node) or _heading(section)
        yield replace(section, title=title)


def _heading(section: Section) -> str:
    """Return the names in the graph as a heading: ``Errors on the face``."""
    text = f"{section.node} {section.output}".replace("_", " ").replace(".", " ").strip()
    return text[:1].upper() + text[1:]


@dataclass(frozen=True)
class _Result:
    """A value that the report shows.

    Attributes
    ----------
    node : str
    output : str
        Empty for the output with the node's own name, and where there is no other.
    labels : mapping of axis to label
    values : Values
        Values of the output, at all combinations.
    entry : ReportEntry
        Under which it is listed.
    """

    node: str
    output: str
    labels: Mapping[str, Label]
    values: Values
    entry: ReportEntry

    @property
    def name(self) -> str:
        """The node and its output, as messages name them."""
        return f"{self.node} {self.output}".strip()

    @property
    def combination(self) -> str:
        return labels_of(self.labels)

    def __str__(self) -> str:
        return f"{self.name} {self.combination}".strip()


def _results(run: Run) -> Iterator[_Result]:
    """Yield everything that the report shows."""
    for node, port in run.plan.graph.reported:
        first = run.plan.graph.nodes[node].first.node.outputs[0].name
        rest = [name for name in run.plan.graph.nodes[node].outputs if name != first]
        for output in [port] if port else ["", *rest]:
            name = output or (first if rest else "")
            values = run[f"{node}.{output}" if output else node]
            for labels in values.labels():
                entry = run.plan.graph.report_entry(node, port, labels)
                if entry is not None:
                    yield _Result(node, "" if name == node else name, labels, values, entry)


class _Shown:
    """The results as the report shows them, and their files."""

    def __init__(self, run: Run, write: Write) -> None:
        graph = run.plan.graph
        self._run = run
        used = graph.spec.included
        own = (RECORD, STEPS, EVENTS, STUDY, REPORT, graph_name(used), *used)
        self._own_files = {fold(path.partition("/")[0]) for path in own}
        self._write = write
        self.sections: list[Section] = []
        self.notes: list[StepNote] = []
        self.not_shown: list[NotShown] = []

    def add(self, result: _Result) -> None:
        """Add a result; a value of a type without a renderer is not shown."""
        try:
            value = result.values.shown_at(result.labels)
            if isinstance(value, Files):
                self._add_files(result, value)
                return
            entry = result.entry
            title = entry.title or str(result)
            origin = RunOrigin(self._run, result.node, result.labels, entry.caption, entry.answer)
            try:
                rendered = render_in_run(value, title, origin)
            except NodegraphError as error:
                if not entry.answer:
                    raise
                self._refuse_answer(result, str(error))
                rendered = render_in_run(value, title, replace(origin, answer=()))
            if rendered is not None:
                self._add_rendered(result, rendered)
        except Exception as error:  # a result that cannot be shown must not cost the others
            self._add_error(result, error)

    def _stem(self, result: _Result, suffixes: Iterable[str]) -> str:
        """Return the name that the files of a result have before their suffixes."""
        words: list[list[object]] = [[name] for name in (result.node, result.output) if name]
        words += [[axis, label] for axis, label in result.labels.items()]
        stem = file_stem(words)
        meets = any(fold(f"{stem}{suffix}") in self._own_files for suffix in suffixes)
        return file_stem(words, digest=True) if meets else stem

    def _add_rendered(self, result: _Result, rendered: Rendered) -> None:
        stem = self._stem(result, rendered.files)
        files = {f"{stem}{suffix}": content for suffix, content in rendered.files.items()}
        lost = self._write_all(result, files)
        links = (Link(path.rpartition(".")[2].upper(), path) for path in files if path not in lost)
        # files may be large, and are written by now
        self._add(result, replace(rendered, files={}), links)

    def _add_files(self, result: _Result, value: Files) -> None:
        folder = self._stem(result, [""])
        paths = {name: f"{folder}/{path}" for name, path in portable_paths(value.content).items()}
        lost = self._write_all(
            result, {paths[name]: content for name, content in value.content.items()}
        )
        lines = [
            f"{paths[name]} ({lost.get(paths[name]) or size_text(len(content))})"
            for name, content in value.content.items()
        ]
        links = (
            Link(name.rpartition("/")[2], path) for name, path in paths.items() if path not in lost
        )
        self._add(result, Rendered("", "\n".join(lines) or "no files"), links)

    def _write_all(self, result: _Result, files: Mapping[str, bytes]) -> dict[str, str]:
        """Write files; return the reasons for those that could not be written."""
        reasons = {path: self._write(path, content) for path, content in files.items()}
        lost = {path: reason for path, reason in reasons.items() if reason}
        for path, reason in lost.items():
            message = f"{path} cannot be written: {reason}"
            self.notes.append(
                StepNote(result.name, result.combination, message, NoteSubject.FAILED)
            )
        return lost

    def _refuse_answer(self, result: _Result, why: str) -> None:
        """Note that the author's answer is contradicted, once for all outputs of a node.

        It is no failure where the data or the methods are not those that the author wrote of.
        """
        is_other = bool(self._run.settings.chosen)
        of_others = " is written for other data or labels, so it is not shown" if is_other else ""
        message = f"{result.entry.answer_place}: 'answer'{of_others}: {why}"
        if any(note.reason == message for note in self.notes):
            return
        kind = NoteSubject.WARNING if is_other else NoteSubject.FAILED
        self.notes.append(StepNote(result.node, result.combination, message, kind))
        if not is_other:
            self.not_shown.append(NotShown(result.node, plain(result.labels), message, "", ""))

    def _add_error(self, result: _Result, error: Exception) -> None:
        # matplotlib begins some of its messages with an empty line
        reason = " ".join(error_text(error).split())
        message = f"cannot be shown: {reason}"
        warnings.warn(f"{result}: {message}", stacklevel=4)
        trace = "".join(traceback.format_exception(error))
        self._add(result, Rendered("", message), ())
        self.notes.append(
            StepNote(result.name, result.combination, message, NoteSubject.FAILED, trace=trace)
        )
        self.not_shown.append(
            NotShown(result.node, plain(result.labels), reason, result.output, trace)
        )

    def _add(self, result: _Result, rendered: Rendered, links: Iterable[Link]) -> None:
        section = Section(
            result.entry.title or rendered.title,
            rendered,
            result.combination,
            tuple(links),
            node=result.node,
            output=result.output,
            caption=result.entry.caption,
            notes_markdown=result.entry.notes,
        )
        self.sections.append(section)


def _timings(run: Run) -> tuple[TimingRow, ...]:
    seconds: dict[str, list[float]] = defaultdict(list)
    stored: Counter[str] = Counter()
    for step, outcome in run.settled(State.DONE):
        seconds[step.node].append(outcome.seconds)
        stored[step.node] += outcome.stored
    return tuple(
        TimingRow(node, len(times), sum(times), max(times), stored[node])
        for node, times in seconds.items()
    )

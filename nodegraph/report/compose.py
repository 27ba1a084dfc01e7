"""A run -> the study that its report shows, the files of the report, and a summary as text."""

from __future__ import annotations

import traceback
import warnings
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from datetime import datetime
from typing import Any

from nodegraph.draw.from_graph import drawing_for_page
from nodegraph.execute import Run
from nodegraph.formatting import labels_of, size_text
from nodegraph.node.description import value_text
from nodegraph.node.values import Files
from nodegraph.plugin.hook_types import Rendered, Renderer
from nodegraph.plugin.loading import error_text
from nodegraph.report.methods import Methods
from nodegraph.report.notes import step_notes
from nodegraph.report.page import page
from nodegraph.report.study import (
    STUDY,
    AxisRow,
    Link,
    Section,
    SettingRow,
    StepNote,
    Study,
    TimingRow,
    study_bytes,
)
from nodegraph.runs.record import versions
from nodegraph.runs.settings import RunSettings
from nodegraph.state import State

_MOST_FAILURES = 5
_WORDS: dict[str, str] = {State.DONE: "computed", State.UNNEEDED: "not needed"}
_FILES = (Link("what ran", "run.json"), Link("events", "events.jsonl"))


def compose(run: Run, settings: RunSettings) -> tuple[Study, dict[str, bytes]]:
    """Return the study of a run, and the files of its tables and figures.

    Parameters
    ----------
    run
    settings
        What the run was started with.
    """
    graph = run.plan.graph
    shown = _Shown()
    for result in _results(run):
        shown.add(result, graph.registry.hooks.renderers)
    software, methods = versions(graph), Methods(run)
    study = Study(
        title=graph.title,
        answer=tuple(dict.fromkeys(shown.answer)),
        notes_markdown=graph.spec.notes,
        sections=tuple(shown.sections),
        graph_svg=drawing_for_page(graph),
        axes=tuple(
            AxisRow(name, tuple(map(str, axis.labels))) for name, axis in graph.axes.items()
        ),
        inputs=tuple(SettingRow(name, value_text(value)) for name, value in graph.inputs.items()),
        known=tuple(map(str, graph.spec.known)),
        methods=methods.rows(),
        without_result=methods.without_result(),
        bibtex=methods.bibtex(),
        notes=(*shown.notes, *step_notes(run, settings)),
        timings=_timings(run),
        seconds=run.seconds,
        versions=tuple(software.items()),
        seeds=methods.seeds(),
        command=settings.command,
        graph_file=graph.spec.file,
        graph_text=graph.spec.text,
        files=_FILES,
        created=datetime.now().astimezone().isoformat(timespec="minutes"),
        machine=software["platform"],
    )
    return study, shown.files


@dataclass(frozen=True)
class _Result:
    """A value that the report shows, and the name of the files that it gives."""

    title: str
    labels: str
    file: str
    value: Any


def _results(run: Run) -> Iterator[_Result]:
    """Yield everything that the report shows."""
    for node, port in run.plan.graph.reported:
        first = run.plan.graph.nodes[node].first.node.outputs[0].name
        rest = [name for name in run.plan.graph.nodes[node].outputs if name != first]
        for output in [port] if port else ["", *rest]:
            name = output or (first if rest else "")
            words = [node] if name in ("", node) else [node, name]
            for labels, value in run[f"{node}.{output}" if output else node].shown():
                file = _file_name([*words, *(f"{axis}-{label}" for axis, label in labels.items())])
                yield _Result(" ".join(words), labels_of(labels), file, value)


def _file_name(words: Iterable[str]) -> str:
    return "_".join(
        "".join(sign if sign.isalnum() or sign in ".-" else "-" for sign in word) for word in words
    )


@dataclass
class _Shown:
    """The results as the report shows them."""

    sections: list[Section] = field(default_factory=list)
    answer: list[str] = field(default_factory=list)
    notes: list[StepNote] = field(default_factory=list)
    files: dict[str, bytes] = field(default_factory=dict)

    def add(self, result: _Result, renderers: Iterable[Renderer]) -> None:
        """Add a result; a value of a type without a renderer is not shown."""
        if isinstance(result.value, Files):
            self._add_files(result, result.value)
            return
        try:
            rendered = _render(result, renderers)
        except Exception as error:  # a result that cannot be drawn must not cost the others
            self.notes.append(_cannot_be_shown(result, error))
            rendered = Rendered("", self.notes[-1].reason)
        if rendered is not None:
            files = {f"{result.file}{suffix}": data for suffix, data in rendered.files.items()}
            links = tuple(Link(path.rpartition(".")[2].upper(), path) for path in files)
            place = f"{result.labels.replace('=', ' ')}: " if result.labels else ""
            self.answer += [f"{place}{sentence}" for sentence in rendered.answer]
            self._add(result, replace(rendered, answer=()), files, links)

    def _add_files(self, result: _Result, value: Files) -> None:
        files = {f"{result.file}/{name}": data for name, data in value.content.items()}
        lines = [f"{path} ({size_text(len(data))})" for path, data in files.items()]
        links = tuple(Link(path.rpartition("/")[2], path) for path in files)
        self._add(result, Rendered("", "\n".join(lines) or "no files"), files, links)

    def _add(
        self,
        result: _Result,
        rendered: Rendered,
        files: Mapping[str, bytes],
        links: tuple[Link, ...],
    ) -> None:
        self.sections.append(Section(result.title, rendered, result.labels, links))
        self.files |= files


def _render(result: _Result, renderers: Iterable[Renderer]) -> Rendered | None:
    value = result.value
    for renderer in renderers:
        if isinstance(value, renderer.type):
            return renderer.render(value, f"{result.title} {result.labels}".strip())
    return Rendered("", str(value)) if isinstance(value, (str, int, float)) else None


def _cannot_be_shown(result: _Result, error: Exception) -> StepNote:
    # matplotlib begins some of its messages with an empty line
    message = f"cannot be shown: {' '.join(error_text(error).split())}"
    warnings.warn(f"{result.title} {result.labels}".strip() + f": {message}", stacklevel=4)
    trace = "".join(traceback.format_exception(error))
    return StepNote(result.title, result.labels, message, "failed", trace=trace)


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


def report_files(run: Run, settings: RunSettings) -> tuple[dict[str, bytes], Study]:
    """Return the report, the tables and the figures of a run by file name, and its study."""
    study, files = compose(run, settings)
    # an error may name a file whose name is not valid text
    text = page(study).encode(errors="backslashreplace")
    return {**files, STUDY: study_bytes(study), "report.html": text}, study


def summary(study: Study, run: Run) -> str:
    """Return what a terminal shows of a run: its tables, its answer, how its steps ended."""
    parts = [
        f"{f'{section.title} {section.labels}'.strip()}\n{section.rendered.text}"
        for section in study.sections
        if section.rendered.text
    ]
    parts += ["\n".join(study.answer)] if study.answer else []
    counts = [
        f"{count} {_WORDS.get(state, state)}" for state, count in run.counts().items() if count
    ]
    parts += [f"{len(run.plan.steps)} steps: {', '.join(counts)}"]
    parts += [*_failures(study), *run.not_stored()]
    return "\n\n".join(parts)


def _failures(study: Study) -> Iterator[str]:
    """Yield the first failures, with the command that repeats each step alone."""
    failed = [note for note in study.notes if note.kind == "failed"]
    for note in failed[:_MOST_FAILURES]:
        where = f"{note.node} at {note.labels}" if note.labels else note.node
        repeat = f"\n    repeat it alone: {note.repeat}" if note.repeat else ""
        yield f"failed: {where}: {note.reason}{repeat}"
    if len(failed) > _MOST_FAILURES:
        yield f"{len(failed) - _MOST_FAILURES} more failed; the report says which and why"

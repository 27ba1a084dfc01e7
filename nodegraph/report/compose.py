"""A run -> the study that its report shows."""

from __future__ import annotations

import traceback
import warnings
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from datetime import datetime
from pathlib import PurePosixPath, PureWindowsPath
from typing import Any

from nodegraph.draw.from_graph import drawing_for_page
from nodegraph.execute import Run
from nodegraph.formatting import labels_of, size_text
from nodegraph.graph import GraphNode, Method
from nodegraph.node.description import SettingText, describe_settings, value_text
from nodegraph.node.values import Files
from nodegraph.plan import Combination, Step
from nodegraph.plugin.bibliography import bibtex_of, references
from nodegraph.plugin.hook_types import Rendered, Renderer
from nodegraph.plugin.loading import error_text
from nodegraph.report.study import (
    AxisRow,
    Kind,
    Link,
    MethodRow,
    Section,
    SettingRow,
    StepNote,
    Study,
    TimingRow,
    WithoutResult,
)
from nodegraph.runs.record import versions
from nodegraph.runs.settings import RunSettings
from nodegraph.state import State

_KINDS: dict[State, Kind] = {
    State.FAILED: "failed",
    State.REFUSED: "refused",
    State.SKIPPED: "left out",
}


def step_notes(run: Run, settings: RunSettings) -> tuple[StepNote, ...]:
    """Return a note for everything in a run that did not simply go well."""
    return tuple(
        (
            *_settled(run, settings),
            *_left_out_by_plan(run),
            *_left_out_by_command(run),
            *_deprecated(run),
            *_warned(run),
        )
    )


def _settled(run: Run, settings: RunSettings) -> Iterator[StepNote]:
    for step, outcome in run.settled(*_KINDS):
        repeat = settings.repeat(step) if outcome.state is State.FAILED else ""
        yield StepNote(
            _name(step),
            labels_of(step.labels),
            outcome.message,
            _KINDS[outcome.state],
            repeat=repeat,
            trace=outcome.trace,
        )


def _left_out_by_plan(run: Run) -> Iterator[StepNote]:
    for name, cells in run.plan.skipped.items():
        axes = run.plan.graph.nodes[name].axes
        for at, reason in cells.items():
            yield StepNote(name, labels_of(dict(zip(axes, at, strict=True))), reason, "left out")


def _left_out_by_command(run: Run) -> Iterable[StepNote]:
    return (
        StepNote(", ".join(nodes), "", reason, "left out", count=len(nodes))
        for reason, nodes in run.plan.graph.left_out_together().items()
    )


def _deprecated(run: Run) -> Iterable[StepNote]:
    notices = run.plan.graph.notices
    return (
        StepNote(str(one.place), "", f"{one.message}: {one.instead}", "warning") for one in notices
    )


def _warned(run: Run) -> Iterator[StepNote]:
    for step, outcome in run.settled():
        for said in outcome.warnings:
            yield StepNote(_name(step), labels_of(step.labels), said, "warning")


def _name(step: Step) -> str:
    return f"{step.node} ({step.method.node.name})"


_MOST_VALUES = 12
_LEFT_OUT = "left out"


@dataclass
class _Ended:
    """How the combinations of a method ended.

    Attributes
    ----------
    settings : set of Combination
        Those of the settings' own axes at which there is a result.
    others : Counter of str
        How many combinations have no result, by what became of them.
    """

    settings: set[Combination] = field(default_factory=set)
    others: Counter[str] = field(default_factory=Counter)


class Methods:
    """What is said of the methods of a run."""

    def __init__(self, run: Run) -> None:
        nodes = run.plan.graph.nodes.values()
        ended = {node.name: _ended(run, node) for node in nodes}
        self._bibtex = run.plan.graph.registry.hooks.bibtex
        self._every = [
            (node, one, ended[node.name][label])
            for node in nodes
            for label, one in node.methods.items()
        ]
        self._used = [one for one in self._every if one[2].settings]

    def rows(self) -> tuple[MethodRow, ...]:
        """Return the methods that gave a result, with the settings at which they did."""
        texts = references(self._bibtex, self._keys())
        return tuple(_row(node, one, ended, texts) for node, one, ended in self._used)

    def without_result(self) -> tuple[WithoutResult, ...]:
        """Return the methods that gave none, and what became of them."""
        return tuple(
            WithoutResult(node.name, one.node.name, one.label, _counted(ended.others))
            for node, one, ended in self._every
            if not ended.settings
        )

    def bibtex(self) -> str:
        """Return the BibTeX of what the methods that gave a result cite."""
        return bibtex_of(self._bibtex, self._keys())

    def seeds(self) -> tuple[tuple[str, str], ...]:
        """Return the seeds of each node."""
        return tuple(
            (node.name, _joined(_values(method, "seed", ended)))
            for node, method, ended in self._used
            if "seed" in method.node.settings
        )

    def _keys(self) -> Iterator[str]:
        for _, method, _ in self._used:
            yield from method.node.cite


def _ended(run: Run, node: GraphNode) -> Mapping[str, _Ended]:
    """Return how the combinations of each method of a node ended, by label."""
    found: defaultdict[str, _Ended] = defaultdict(_Ended)
    for at, index in run.plan.cells.get(node.name, {}).items():
        label, state = _label(node, at), run.outcomes[index].state
        if state.has_value:
            labels = dict(zip(node.axes, at, strict=True))
            axes = node.methods[label].settings.axes
            found[label].settings.add(tuple(labels[axis] for axis in axes))
        else:
            found[label].others[_LEFT_OUT if state is State.SKIPPED else state] += 1
    for at in run.plan.skipped.get(node.name, {}):
        found[_label(node, at)].others[_LEFT_OUT] += 1
    return found


def _label(node: GraphNode, at: Combination) -> str:
    """Return the label of the method that computes a combination."""
    own = node.axes.index(node.name) if node.has_alternatives else None
    return next(iter(node.methods)) if own is None else str(at[own])


def _row(node: GraphNode, method: Method, ended: _Ended, texts: Mapping[str, str]) -> MethodRow:
    settings = tuple(_setting(method, one, ended) for one in describe_settings(method.node))
    return MethodRow(
        node.name,
        method.node.name,
        method.node.summary,
        method.label,
        settings,
        citation="\n".join(texts[key] for key in method.node.cite),
        plugin=method.distribution or method.plugin,
        keys=tuple(method.node.cite),
    )


def _setting(method: Method, one: SettingText, ended: _Ended) -> SettingRow:
    values = _values(method, one.name, ended)
    value, named = _joined(values), _joined(map(_by_name, values))
    in_print = named if named != value else ""
    return SettingRow(one.name, value, one.unit, value == one.default, one.meaning, in_print)


def _values(method: Method, name: str, ended: _Ended) -> list[Any]:
    """Return each value of a setting at which there is a result, once."""
    every = (one.get(name) for at, one in method.settings.shown.items() if at in ended.settings)
    return list({value_text(one): one for one in every}.values())


def _joined(values: Iterable[Any]) -> str:
    texts = list(map(value_text, values))
    more = f" and {len(texts) - _MOST_VALUES} more" if len(texts) > _MOST_VALUES else ""
    return ", ".join(texts[:_MOST_VALUES]) + more


def _by_name(value: Any) -> Any:
    """Return a value in which files have their names alone: folders are of one machine."""
    if isinstance(value, (list, tuple)):
        return [_by_name(one) for one in value]
    if isinstance(value, Mapping):
        return {name: _by_name(one) for name, one in value.items()}
    text = str(value)
    for path in (PurePosixPath(text), PureWindowsPath(text)):
        if path.is_absolute() and len(path.parts) > 2:
            return path.name
    return value


def _counted(others: Counter[str]) -> str:
    return ", ".join(f"{count} {state}" for state, count in others.items()) or _LEFT_OUT


_FILES = (Link("what ran", "run.json"), Link("events", "events.jsonl"))


def compose(run: Run, settings: RunSettings) -> tuple[Study, dict[str, bytes]]:
    """Return what the report of a run says, and the files of its tables and figures.

    Parameters
    ----------
    run
    settings
        What the run was started with.
    """
    graph = run.plan.graph
    found = list(_reported(run))
    sections, answer, files, unshown = _sections(found, graph.registry.hooks.renderers)
    there, methods = versions(graph), Methods(run)
    study = Study(
        title=graph.title,
        answer=answer,
        notes_markdown=graph.spec.notes,
        sections=sections,
        graph_svg=drawing_for_page(graph),
        axes=tuple(AxisRow(one.name, tuple(map(str, one.labels))) for one in graph.axes.values()),
        inputs=tuple(SettingRow(name, value_text(value)) for name, value in graph.inputs.items()),
        known=tuple(str(one) for one in graph.spec.known),
        methods=methods.rows(),
        without_result=methods.without_result(),
        bibtex=methods.bibtex(),
        notes=(*unshown, *step_notes(run, settings)),
        timings=_timings(run),
        seconds=run.seconds,
        versions=tuple(there.items()),
        seeds=methods.seeds(),
        command=settings.command,
        graph_file=graph.spec.file,
        graph_text=graph.spec.text,
        files=_FILES,
        created=datetime.now().astimezone().isoformat(timespec="minutes"),
        machine=there["platform"],
    )
    return study, files


def _reported(run: Run) -> Iterator[tuple[str, str, str, Any]]:
    """Yield (title, labels, file name, value) of everything that the report shows."""
    for node, port in run.plan.graph.reported:
        first = run.plan.graph.nodes[node].first.node.outputs[0].name
        others = [name for name in run.plan.graph.nodes[node].outputs if name != first]
        for output in [port] if port else ["", *others]:
            name = output or (first if others else "")
            plain = name in ("", node)
            for labels, value in run[f"{node}.{output}" if output else node].shown():
                at = labels_of(labels)
                words = [node] if plain else [node, name]
                named = [f"{axis}-{label}" for axis, label in labels.items()]
                yield " ".join(words), at, _file_name([*words, *named]), value


def _file_name(words: Iterable[str]) -> str:
    return "_".join("".join(c if c.isalnum() or c in ".-" else "-" for c in one) for one in words)


def _sections(
    found: Iterable[tuple[str, str, str, Any]], renderers: Iterable[Renderer]
) -> tuple[tuple[Section, ...], tuple[str, ...], dict[str, bytes], tuple[StepNote, ...]]:
    sections: list[Section] = []
    answer: list[str] = []
    unshown: list[StepNote] = []
    files: dict[str, bytes] = {}
    for title, labels, name, value in found:
        if isinstance(value, Files):
            made = {f"{name}/{file}": content for file, content in value.content.items()}
            sections.append(_files_section(title, labels, made))
            files |= made
            continue
        try:
            rendered = _rendered(value, f"{title} {labels}".strip(), renderers)
        except Exception as error:  # a picture that cannot be drawn must not cost the other results
            unshown.append(_unshown(title, labels, error))
            rendered = Rendered("", unshown[-1].reason)
        if rendered is None:
            continue
        beside = {f"{name}{suffix}": content for suffix, content in rendered.files.items()}
        files |= beside
        links = tuple(Link(one.rpartition(".")[2].upper(), one) for one in beside)
        place = f"{labels.replace('=', ' ')}: " if labels else ""
        answer += [f"{place}{sentence}" for sentence in rendered.answer]
        sections.append(Section(title, replace(rendered, answer=()), labels, links))
    return tuple(sections), tuple(dict.fromkeys(answer)), files, tuple(unshown)


def _files_section(title: str, labels: str, made: Mapping[str, bytes]) -> Section:
    said = [f"{path} ({size_text(len(content))})" for path, content in made.items()]
    links = tuple(Link(path.rpartition("/")[2], path) for path in made)
    return Section(title, Rendered("", "\n".join(said) or "no files"), labels, links)


def _rendered(value: Any, title: str, renderers: Iterable[Renderer]) -> Rendered | None:
    for renderer in renderers:
        if isinstance(value, renderer.type):
            return renderer.render(value, title)
    return Rendered("", str(value)) if isinstance(value, (str, int, float)) else None


def _unshown(title: str, labels: str, error: Exception) -> StepNote:
    """Return what is said of a result that is there, and for which its renderer failed."""
    # matplotlib begins some of its messages with an empty line
    said = f"cannot be shown: {' '.join(error_text(error).split())}"
    warnings.warn(f"{title} {labels}".strip() + f": {said}", stacklevel=3)
    trace = "".join(traceback.format_exception(error))
    return StepNote(title, labels, said, "failed", trace=trace)


def _timings(run: Run) -> tuple[TimingRow, ...]:
    took: dict[str, list[float]] = defaultdict(list)
    stored: Counter[str] = Counter()
    for step, outcome in run.settled(State.DONE):
        took[step.node].append(outcome.seconds)
        stored[step.node] += outcome.stored
    return tuple(
        TimingRow(node, len(one), sum(one), max(one), stored[node]) for node, one in took.items()
    )

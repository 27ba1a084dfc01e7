"""A run -> the study that its report shows."""

from __future__ import annotations

import warnings
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping
from datetime import datetime
from typing import Any

from nodegraph.bibliography import bibtex_of, references
from nodegraph.describe import describe_settings, shown
from nodegraph.display import size_text
from nodegraph.draw.from_graph import drawing_for_page
from nodegraph.execute import Run
from nodegraph.execute.record import versions
from nodegraph.graph import Graph, GraphNode, Method
from nodegraph.hooks import Rendered, Renderer
from nodegraph.report.notes import step_notes
from nodegraph.report.study import (
    AxisRow,
    Link,
    MethodRow,
    Section,
    SettingRow,
    Study,
    TimingRow,
)
from nodegraph.values import Files

_MOST_VALUES = 12


def compose(run: Run, *, command: str) -> tuple[Study, dict[str, bytes]]:
    """Return what the report of a run says, and the files of its tables and figures.

    Parameters
    ----------
    run
    command
        How the run was started, so that a reader can start it again.
    """
    graph = run.plan.graph
    found = list(_reported(run))
    sections, files = _sections(found, graph.registry.renderers)
    there = versions(graph)
    study = Study(
        title=graph.title,
        answer=_answer((labels, value) for _, labels, _, value in found),
        notes_markdown=graph.spec.notes,
        sections=sections,
        graph_svg=drawing_for_page(graph),
        axes=tuple(AxisRow(one.name, tuple(map(str, one.labels))) for one in graph.axes.values()),
        inputs=tuple(SettingRow(name, shown(value)) for name, value in graph.inputs.items()),
        known=tuple(str(one) for one in graph.spec.known),
        methods=_methods(graph),
        bibtex=bibtex_of(graph.registry.bibtex, _keys(graph)),
        notes=step_notes(run, command),
        timings=_timings(run),
        seconds=run.seconds,
        versions=tuple(there.items()),
        seeds=_seeds(graph),
        command=command,
        graph_file=graph.spec.file,
        graph_text=graph.spec.text,
        files=(Link("what ran", "run.json"), Link("events", "events.jsonl")),
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
                at = ", ".join(f"{axis}={label}" for axis, label in labels.items())
                words = [node] if plain else [node, name]
                named = [f"{axis}-{label}" for axis, label in labels.items()]
                yield " ".join(words), at, _file_name([*words, *named]), value


def _file_name(words: Iterable[str]) -> str:
    return "_".join("".join(c if c.isalnum() or c in ".-" else "-" for c in one) for one in words)


def _sections(
    found: Iterable[tuple[str, str, str, Any]], renderers: Iterable[Renderer]
) -> tuple[tuple[Section, ...], dict[str, bytes]]:
    sections: list[Section] = []
    files: dict[str, bytes] = {}
    for title, labels, name, value in found:
        if isinstance(value, Files):
            made = {f"{name}/{file}": content for file, content in value.content.items()}
            sections.append(_files_section(title, labels, made))
            files |= made
            continue
        rendered = _rendered(value, f"{title} {labels}".strip(), renderers)
        if rendered is None:
            continue
        beside = {f"{name}{suffix}": content for suffix, content in rendered.files.items()}
        files |= beside
        links = tuple(Link(one.rpartition(".")[2].upper(), one) for one in beside)
        sections.append(Section(title, rendered, labels, links))
    return tuple(sections), files


def _files_section(title: str, labels: str, made: Mapping[str, bytes]) -> Section:
    said = [f"{path} ({size_text(len(content))})" for path, content in made.items()]
    links = tuple(Link(path.rpartition("/")[2], path) for path in made)
    return Section(title, Rendered("", "\n".join(said) or "no files"), labels, links)


def _rendered(value: Any, title: str, renderers: Iterable[Renderer]) -> Rendered | None:
    for renderer in renderers:
        if isinstance(value, renderer.type):
            return _shown_or_said(renderer, value, title)
    return Rendered("", str(value)) if isinstance(value, (str, int, float)) else None


def _shown_or_said(renderer: Renderer, value: Any, title: str) -> Rendered:
    try:
        return renderer.render(value, title)
    except Exception as error:  # a picture that cannot be drawn must not cost the other results
        said = f"cannot be shown: {type(error).__name__}: {error}"
        warnings.warn(f"{title}: {said}", stacklevel=2)
        return Rendered("", said)


def _answer(values: Iterable[tuple[str, Any]]) -> tuple[str, ...]:
    """Return the sentences that values carry with them, as tables do in ``attrs``."""
    said: list[str] = []
    for labels, value in values:
        attributes = getattr(value, "attrs", None)
        sentences = attributes.get("answer", ()) if isinstance(attributes, Mapping) else ()
        place = labels.replace("=", " ")
        said += [f"{place}: {one}" if place else one for one in sentences]
    return tuple(dict.fromkeys(said))


def _methods(graph: Graph) -> tuple[MethodRow, ...]:
    methods = [(node, one) for node in graph.nodes.values() for one in node.methods.values()]
    texts = references(graph.registry.bibtex, _keys(graph))
    return tuple(_method_row(node, one, texts) for node, one in methods)


def _keys(graph: Graph) -> Iterator[str]:
    for node in graph.nodes.values():
        for method in node.methods.values():
            yield from method.node.cite


def _method_row(node: GraphNode, method: Method, texts: Mapping[str, str]) -> MethodRow:
    settings = tuple(
        SettingRow(one.name, value, one.unit, value == one.default, one.meaning)
        for one in describe_settings(method.node)
        for value in [_values(method, one.name)]
    )
    citation = "\n".join(texts[key] for key in method.node.cite)
    use, summary = method.node.name, method.node.summary
    plugin = method.distribution or method.plugin
    keys = tuple(method.node.cite)
    return MethodRow(node.name, use, summary, method.label, settings, citation, plugin, keys)


def _values(method: Method, name: str) -> str:
    texts = list(dict.fromkeys(shown(one.get(name)) for one in method.settings.shown.values()))
    more = f" and {len(texts) - _MOST_VALUES} more" if len(texts) > _MOST_VALUES else ""
    return ", ".join(texts[:_MOST_VALUES]) + more


def _seeds(graph: Graph) -> tuple[tuple[str, str], ...]:
    return tuple(
        (node.name, _values(method, "seed"))
        for node in graph.nodes.values()
        for method in node.methods.values()
        if "seed" in method.node.settings
    )


def _timings(run: Run) -> tuple[TimingRow, ...]:
    took: dict[str, list[float]] = defaultdict(list)
    stored: Counter[str] = Counter()
    for step, outcome in run.settled("done"):
        took[step.node].append(outcome.seconds)
        stored[step.node] += outcome.stored
    return tuple(
        TimingRow(node, len(one), sum(one), max(one), stored[node]) for node, one in took.items()
    )

"""A run -> the study that its report shows."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from typing import Any

from nodegraph.bibliography import references
from nodegraph.describe import describe_settings, shown
from nodegraph.draw import svg
from nodegraph.draw.from_graph import picture_of
from nodegraph.execute import Run
from nodegraph.execute.record import versions
from nodegraph.graph import Graph, GraphNode, Method
from nodegraph.hooks import Rendered, Renderer
from nodegraph.plan import Step
from nodegraph.report.study import MethodRow, Note, Section, Study, Timing


def compose(run: Run, *, command: str) -> Study:
    """Return what the report of a run says.

    Parameters
    ----------
    run
    command
        How the run was started, so that a reader can start it again.
    """
    graph = run.plan.graph
    values = list(_reported(run))
    return Study(
        title=graph.title,
        notes=graph.spec.notes,
        answer=_answer(value for _, _, value in values),
        sections=_sections(values, graph.registry.renderers),
        drawing=svg(picture_of(graph)),
        axes={name: ", ".join(map(str, axis.labels)) for name, axis in graph.axes.items()},
        inputs={name: shown(value) for name, value in graph.inputs.items()},
        known=tuple(str(one) for one in graph.spec.known),
        methods=_methods(graph),
        failed=_notes(run, "failed"),
        refused=_notes(run, "refused"),
        skipped=_notes(run, "skipped") + _left_by_plan(run),
        left_out=tuple(Note(one.node, one.reason, ("",)) for one in graph.left_out),
        warned=_warned(run),
        counts=run.counts(),
        timings=_timings(run),
        seconds=run.seconds,
        versions=versions(graph),
        command=command,
        graph_text=graph.spec.text,
    )


def _reported(run: Run) -> Iterable[tuple[str, str, Any]]:
    """Yield (title, file name, value) of everything that the report shows."""
    for node, port in _asked(run.plan.graph):
        outputs = run.plan.graph.nodes[node].first.node.outputs
        wanted = [one.name for one in outputs if port in ("", one.name)]
        for output in wanted:
            for labels, value in run[f"{node}.{output}"]:
                named = "" if len(wanted) == 1 and not port else f" {output}"
                at = ", ".join(f"{axis} = {label}" for axis, label in labels.items())
                title = f"{node}{named if output != node else ''}" + (f" ({at})" if at else "")
                yield title, _file_name(node, output if named else "", labels), value


def _asked(graph: Graph) -> list[tuple[str, str]]:
    if graph.spec.report:
        found = [(one.node, one.port) for one in graph.spec.report]
        return [one for one in dict.fromkeys(found) if one[0] in graph.nodes]
    read = {source.node for _, _, source, _ in graph.wires()}
    return [(name, "") for name in graph.nodes if name not in read]


def _file_name(node: str, port: str, labels: Mapping[str, Any]) -> str:
    words = [node, *([port] if port else []), *(f"{k}-{v}" for k, v in labels.items())]
    return "_".join("".join(c if c.isalnum() or c in ".-" else "-" for c in word) for word in words)


def _sections(
    values: Iterable[tuple[str, str, Any]], renderers: tuple[Renderer, ...]
) -> tuple[Section, ...]:
    made = []
    for title, name, value in values:
        renderer = next((one for one in renderers if isinstance(value, one.type)), None)
        if renderer is not None:
            made.append(Section(title, name, renderer.render(value, title)))
        elif isinstance(value, (str, int, float)):
            made.append(Section(title, name, Rendered(_escaped(str(value)), str(value))))
    return tuple(made)


def _answer(values: Iterable[Any]) -> tuple[str, ...]:
    """Return the sentences that values carry with them, as tables do in ``attrs``."""
    said: list[str] = []
    for value in values:
        attributes = getattr(value, "attrs", None)
        said += attributes.get("answer", ()) if isinstance(attributes, Mapping) else ()
    return tuple(dict.fromkeys(said))


def _methods(graph: Graph) -> tuple[MethodRow, ...]:
    methods = [(node, one) for node in graph.nodes.values() for one in node.methods.values()]
    texts = references(graph.registry.bibtex, (key for _, one in methods for key in one.node.cite))
    return tuple(_method_row(node, one, texts) for node, one in methods)


def _method_row(node: GraphNode, method: Method, texts: Mapping[str, str]) -> MethodRow:
    name = f"{node.name}, {method.label}" if method.label else node.name
    settings = tuple((one, _values(method, one.name)) for one in describe_settings(method.node))
    return MethodRow(
        name,
        method.node.name,
        method.distribution or method.plugin,
        method.node.summary,
        settings,
        tuple(texts[key] for key in method.node.cite),
    )


def _values(method: Method, name: str) -> str:
    texts = list(dict.fromkeys(shown(one.get(name)) for one in method.settings.shown.values()))
    more = f" and {len(texts) - 12} more" if len(texts) > 12 else ""
    return ", ".join(texts[:12]) + more


def _notes(run: Run, state: str) -> tuple[Note, ...]:
    grouped: dict[tuple[str, str], list[str]] = defaultdict(list)
    traces: dict[tuple[str, str], str] = {}
    for step, outcome in run.settled(state):
        grouped[_node_and_use(step), outcome.reason].append(_combination(step))
        traces.setdefault((_node_and_use(step), outcome.reason), outcome.trace)
    return tuple(
        Note(node, reason, tuple(found), traces[node, reason])
        for (node, reason), found in grouped.items()
    )


def _warned(run: Run) -> tuple[Note, ...]:
    grouped: dict[tuple[str, str], list[str]] = defaultdict(list)
    for step, outcome in run.settled():
        for said in outcome.warnings:
            grouped[_node_and_use(step), said].append(_combination(step))
    return tuple(Note(node, said, tuple(found)) for (node, said), found in grouped.items())


def _left_by_plan(run: Run) -> tuple[Note, ...]:
    grouped: dict[tuple[str, str], list[str]] = defaultdict(list)
    for name, cells in run.plan.skipped.items():
        for at, reason in cells.items():
            grouped[name, reason].append(", ".join(map(str, at)))
    return tuple(Note(node, reason, tuple(found)) for (node, reason), found in grouped.items())


def _timings(run: Run) -> tuple[Timing, ...]:
    took: dict[tuple[str, str], list[float]] = defaultdict(list)
    for step, outcome in run.settled("done"):
        took[step.node, step.method.node.name].append(outcome.seconds)
    found = (Timing(node, use, len(all_), sum(all_)) for (node, use), all_ in took.items())
    return tuple(sorted(found, key=lambda one: -one.seconds))


def _node_and_use(step: Step) -> str:
    return f"{step.node} ({step.method.node.name})"


def _combination(step: Step) -> str:
    return ", ".join(f"{axis} = {label}" for axis, label in step.labels.items())


def _escaped(text: str) -> str:
    from html import escape

    return f"<p>{escape(text)}</p>"

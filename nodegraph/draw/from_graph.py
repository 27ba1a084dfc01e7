"""A checked graph as a picture."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from operator import contains, eq
from pathlib import Path
from typing import NamedTuple

from nodegraph.draw.boxes import shortened
from nodegraph.draw.picture import (
    UNCHANGED,
    Alternative,
    Arrow,
    Axis,
    Box,
    Kind,
    Picture,
    Socket,
    answering,
    folded,
    origins,
)
from nodegraph.draw.svg import svg
from nodegraph.formatting import labels_of
from nodegraph.graph import Gather, Graph, GraphNode
from nodegraph.graph.axis_text import axis_unit
from nodegraph.graph.model import Method
from nodegraph.graph.pass_through import PassThrough
from nodegraph.graphfile.keys import PASS
from nodegraph.graphfile.spec import Reference
from nodegraph.node.description import value_text
from nodegraph.node.ports import Label, Port

_LONGEST = 28
"""Characters of the values that a setting has along axes."""
_MOST_VALUES = 6
"""Labels of an axis that are drawn with the settings for which they stand."""
MOST_ON_A_PAGE = 500
_LONGEST_LABEL = 32
_LONGEST_SERIES = 24
_CLAUSES = re.compile(r"([^:;(.]{,60}|[^,:;(.]+)(?=[,:;(.]|$)")
"""Of what a method does, without after whom."""
_NUMBERED = re.compile(r"(\D*)\d+")

_Ends = tuple[str, str, str, str]
"""A node and its output, and the node and port that read it."""


def drawing_for_page(graph: Graph, *, fold: bool = True) -> str:
    """Return a graph as SVG for a page, or an empty string if it is too large for one.

    A drawing of thousands of nodes takes tens of megabytes and is unreadable.

    Parameters
    ----------
    graph
    fold
        Whether one box stands for all nodes that only show something.
    """
    if len(graph.nodes) > MOST_ON_A_PAGE:
        return ""
    picture = picture_of(graph)
    return svg(folded(picture) if fold else picture, heading=False)


def picture_of(graph: Graph, *, whole: bool = False) -> Picture:
    """Return the picture of a graph: its whole nodes, or their wired ports and first methods.

    Nodes and alternatives have the settings that the graph gives them; an alternative of which
    nothing else is told has those that others of its method differ in. An axis stands with its
    labels at the first node whose settings name it, and at others that no wire brings it to; an
    axis with one label is not drawn.
    """
    wires: dict[_Ends, list[Reference]] = {}
    brought: dict[str, set[str]] = {name: set() for name in graph.nodes}
    for source, target, wire in graph.wires():
        ends = (source, wire.output, target, wire.port)
        wires.setdefault(ends, []).append(wire.reference)
        brought[target] |= {*graph.nodes[source].axes} - {*wire.reference.at}
    seen = _seen_in_the_end(graph, wires)
    arrows = {ends: _arrow(graph, ends, references) for ends, references in wires.items()}
    read = {(source, output) for source, output, _, _ in arrows}
    fed = {(target, port) for _, _, target, port in arrows}
    said: set[str] = set()
    boxes = []
    for node in graph.nodes.values():
        named = {axis for method in node.methods.values() for axis in method.settings.axes}
        own = [axis for axis in graph.axes if axis in named and len(graph.axes[axis].labels) > 1]
        if whole:
            read |= {(node.name, port.name) for port in node.first.node.outputs}
            fed |= {(node.name, port.name) for port in _inputs(node)}
        box = _box(graph, node, read, fed, whole=whole)
        tables = {axis.name: axis for axis in box.axes}
        axes = [
            _told_again(tables.get(axis, Axis(axis)))
            if axis in said
            else tables.get(axis, Axis(axis))._replace(labels=f"{labels} {unit}".rstrip())
            for axis in own
            for labels in [labels_text(graph.axes[axis].labels)]
            for unit in [axis_unit(graph, axis)]
            if axis in tables or axis not in said & brought[node.name]
        ]
        said.update(own)
        compares = node.has_alternatives and node.name in seen
        boxes.append(replace(box, axes=tuple(axes), compares=compares))
    places = {entry.node: at for at, entry in enumerate(reversed(graph.spec.report), 1)}
    boxes.sort(key=lambda box: -places.get(box.name, len(places) + 1))
    picture = Picture(graph.title, tuple(boxes), tuple(arrows.values()))
    picture = replace(picture, boxes=tuple(_with_sources(graph, picture)))
    return replace(picture, combinations=_combinations(graph, seen, picture))


def _seen_in_the_end(graph: Graph, wires: Mapping[_Ends, Sequence[Reference]]) -> set[str]:
    """Return the axes of what the report shows, or of what no other node reads."""
    last = {name for name, node in graph.nodes.items() if _kind(graph, node) == "report"}
    last |= {*graph.nodes} - {source for source, *_ in wires}
    return {axis for name in last for axis in graph.nodes[name].axes} | {
        axis
        for (source, _, target, _), references in wires.items()
        for reference in references
        for axis in graph.nodes[source].axes
        if target in last and axis not in reference.at
    }


def _combinations(graph: Graph, seen: Collection[str], picture: Picture) -> str:
    """Return which alternatives the answers compare, and for the labels of which axes."""
    main = answering(picture)
    boxes = {box.name: box for box in picture.boxes if box.name in main}
    several = [axis for axis in graph.axes if axis in seen and len(graph.axes[axis].labels) > 1]
    at_once = {name: frozenset(several) & {*graph.nodes[name].axes} for name in boxes}
    texts = []
    sets = dict.fromkeys(at_once.values())
    for axes in sets:
        if any(axes < other for other in sets):
            continue
        counts = {axis: len(graph.axes[axis].labels) for axis in several if axis in axes}
        own = [axis for axis in counts if axis in graph.nodes]
        compared = [f"{counts.pop(axis)} alternatives of {axis}" for axis in own]
        compared += (
            f"{len(box.alternatives)} stages in {name}"
            for name, box in boxes.items()
            if name not in own and box.compares and box.kind == "node" and at_once[name] == axes
        )
        ways = " and ".join(compared)
        each = ", ".join(f"{axis} ({count})" for axis, count in counts.items())
        texts.append(f"{ways}, for each {each}" if ways and each else ways or each)
    return "; ".join(filter(None, texts))


def _with_sources(graph: Graph, picture: Picture) -> Iterator[Box]:
    """Yield the boxes; alternatives that read another output than most by one port say which.

    What a port lays side by side stands in rows, too.
    """
    into: dict[str, dict[str, dict[tuple[str, str], str]]] = {}
    for arrow, origin in zip(picture.arrows, origins(picture), strict=True):
        ports = into.setdefault(arrow.target, {})
        ports.setdefault(arrow.target_port, {})[arrow.source, arrow.source_port] = origin

    def source(method: Method, name: str) -> str:
        texts = []
        for port, several in into[name].items():
            feed = method.inputs.get(port)
            if isinstance(feed, Reference) and len(several) > 1:
                texts.append(several[feed.node, graph.output_name(feed)])
        return ", ".join(texts)

    for box in picture.boxes:
        node = graph.nodes[box.name]
        stages = [
            Alternative(
                label, source=into[box.name][port][reference.node, graph.output_name(reference)]
            )
            for port, feed in node.first.inputs.items()
            if isinstance(feed, Gather) and feed.axis
            for label, reference in feed.sources.items()
        ]
        box = replace(box, compares=box.compares or bool(stages))
        if stages and not node.has_alternatives:
            yield replace(box, alternatives=tuple(stages))
            continue
        methods = node.methods if box.name in into else {}
        sources = {label: source(method, box.name) for label, method in methods.items()}
        usual = Counter(sources.values()).most_common(1)
        if usual and 2 * usual[0][1] > len(sources):
            sources = {label: text for label, text in sources.items() if text != usual[0][0]}
        alternatives = [
            each._replace(source=sources.get(each.label, "")) for each in box.alternatives
        ]
        yield replace(box, alternatives=tuple(alternatives))


def labels_text(labels: Sequence[Label], longest: int = 90, between: str = ", ") -> str:
    """Return the labels of an axis, or the first and the last and their number where that is long.

    Numbered labels need not be read one by one, so that a shorter text of them is long.

    Examples
    --------
    >>> labels_text(["face_1", "face_2", "face_3", "face_4"])
    'face_1 … face_4 (4)'
    """
    short = [shortened(str(label), _LONGEST_LABEL) for label in labels]
    numbered = [_NUMBERED.fullmatch(each) for each in short]
    is_series = all(numbered) and len({found[1] for found in numbered if found}) == 1
    text = between.join(short)
    if len(text) <= (min(longest, _LONGEST_SERIES) if is_series else longest) or len(short) < 3:
        return text
    return f"{short[0]} … {short[-1]} ({len(short)})"


def _arrow(graph: Graph, ends: _Ends, references: Sequence[Reference]) -> Arrow:
    source, output, target, target_port = ends
    feed = graph.nodes[target].first.inputs.get(target_port)
    port = graph.nodes[source].first.node.output(output)
    common = set.intersection(*(set(reference.at.items()) for reference in references))
    return Arrow(
        *ends,
        gathers=isinstance(feed, Gather),
        truth=port is not None and port.truth,
        fixed=labels_of(
            {axis: label for axis, label in references[0].at.items() if (axis, label) in common}
        ),
    )


def _received(graph: Graph, node: GraphNode, feed: Reference | Gather | None) -> str:
    """Return the number and the kind of the values of a gathering port; empty for other ports."""
    sources = feed.sources if isinstance(feed, Gather) else {}
    free = {
        axis
        for source in sources.values()
        for axis in graph.nodes[source.node].axes
        if axis not in source.at
    }
    sizes = {axis: len(graph.axes[axis].labels) for axis in node.gathered if axis in free}
    several = (f"{size} {axis}" for axis, size in sizes.items() if size > 1)
    return " \N{MULTIPLICATION SIGN} ".join(several)


def _box(
    graph: Graph,
    node: GraphNode,
    read: set[tuple[str, str]],
    fed: set[tuple[str, str]],
    *,
    whole: bool,
) -> Box:
    described = node.first.node
    inputs = [
        replace(socket_of(port), gathers=_received(graph, node, node.first.inputs.get(port.name)))
        for port in _inputs(node)
        if (node.name, port.name) in fed
    ]
    outputs = [socket_of(port) for port in described.outputs if (node.name, port.name) in read]
    if not whole:
        outputs = [_without_usual_name(socket, inputs) for socket in outputs]
    kept = {label: _kept(graph, node, label) for label in node.methods}
    settings = {label: _settings(method, kept[label]) for label, method in node.methods.items()}
    used = [settings[label] for label, method in node.methods.items() if method.node.name != PASS]
    common = {
        name: value
        for name, value in next(iter(used), {}).items()
        if all(each.get(name) == value for each in used)
    }
    uses = {label: method.node.name for label, method in node.methods.items()}
    methods = {*uses.values()} - {PASS}
    is_same = len(methods) == 1 and (len(used) > 1 or not node.has_alternatives)
    varied: dict[str, dict[str, _Setting]] = {}
    for label, method in node.methods.items():
        defaults = {name: method.node.settings[name].default for name in settings[label]}
        varied.setdefault(uses[label], {}).update(
            (name, _value_text(default))
            for name, default in defaults.items()
            if name not in common and default is not None
        )
    alternatives = []
    for label, each in settings.items():
        own = {name: each[name] for name in each if name not in common}
        texts = [*filter(None, (_told(label, uses[label], is_same=is_same), _text(own)))]
        texts = texts or [_text(varied[uses[label]])]
        for axis, labels in kept[label].items():
            ends = [*map(str, dict.fromkeys((labels[0], labels[-1])))]
            texts.append("only " * (len(ends) == 1) + f"at {axis} " + " \N{EN DASH} ".join(ends))
        alternatives += [Alternative(label, ", ".join(filter(None, texts)))] * node.has_alternatives
    axes = _with_values(common)
    told = {axis.name for axis in axes}
    others = {name: each for name, each in common.items() if getattr(each, "axis", "") not in told}
    lines = [*methods] if is_same else []
    lines += filter(None, [_text(others)])
    used_by = {method.node for method in node.methods.values() if method.node.name in methods}
    clauses = _CLAUSES.match(next(iter(used_by)).summary) if is_same else None
    does = clauses[1].strip() if clauses else ""
    is_graph = isinstance(described, PassThrough) and not node.has_alternatives
    if is_graph and described.name != PASS:
        does = described.doc
        lines = [] if does else [described.name]
    shown = [entry for entry in graph.spec.report if entry.node == node.name]
    return Box(
        node.name,
        lines=tuple(lines),
        inputs=tuple(inputs),
        outputs=tuple(outputs),
        alternatives=tuple(alternatives),
        axes=axes,
        kind=_kind(graph, node),
        passes=is_graph,
        names=tuple(
            (f"{each.node}.{graph.output_name(each)}", port)
            for port, feed in graph.spec.nodes[node.name].wiring.items()
            for each in ([feed] if isinstance(feed, Reference) else feed.sources.values())
            if is_graph
        ),
        title=next((entry.title for entry in shown), ""),
        answers=any(entry.answer for entry in shown),
        does=does,
    )


def _told(label: Label, use: str, *, is_same: bool) -> str:
    """Return the method of an alternative that neither its label nor the box tells."""
    if use == PASS:
        return UNCHANGED
    return "" if is_same or str(label).startswith(use.rpartition(".")[2]) else use


def _kept(graph: Graph, node: GraphNode, method: Label) -> dict[str, list[Label]]:
    """Return the labels at which an alternative is not skipped, of axes where it is at others."""
    kept: dict[str, list[Label]] = {}
    for item in graph.spec.skip:
        others = item.labels.keys() - {node.name}
        if len(others) == 1 and method in item.labels.get(node.name, ()):
            (axis,) = others
            labels = kept.get(axis, graph.axes[axis].labels)
            kept[axis] = [label for label in labels if label not in item.labels[axis]]
    sizes = {axis: len(graph.axes[axis].labels) for axis in kept}
    return {axis: labels for axis, labels in kept.items() if 0 < len(labels) < sizes[axis]}


class _Along(NamedTuple):
    """What a setting is at each label of one axis."""

    axis: str
    values: tuple[tuple[Label, str], ...]
    unit: str

    def __str__(self) -> str:
        text = " / ".join(dict.fromkeys(text for _, text in self.values))
        return f"{text} by {self.axis}" if len(text) <= _LONGEST else f"by {self.axis}"


_Setting = str | _Along


def _settings(method: Method, kept: Mapping[str, Collection[Label]]) -> dict[str, _Setting]:
    """Return the settings that a graph gives to a method, at the labels that this has.

    One that differs along an axis is left out if each value has its label in it, which the box of
    the axis shows.
    """
    found: dict[str, _Setting] = {}
    for name in method.places:
        shown = {
            labels: _value_text(settings[name])
            for labels, settings in method.settings.shown.items()
            if all(
                label in kept.get(axis, (label,))
                for axis, label in zip(method.settings.axes, labels, strict=True)
            )
        }
        unit = method.node.settings[name].unit
        unit = f" {unit}" * (unit in ("mm", "Hz", "s") or "/" in unit)  # others are words
        texts = tuple(dict.fromkeys(shown.values()))
        values = [each[name] for each in method.settings.values.values()]
        value = next((each for each in values if each is not None), None)
        if len(texts) == 1:
            found[name] = f"{texts[0]}{unit * isinstance(value, int | float)}"
        elif isinstance(value, (int, float, str, Path)):
            along = [*zip(*shown, strict=True)]  # for each axis, its label at each value
            if any(all(map(contains, shown.values(), map(str, each))) for each in along):
                continue
            found[name] = f"{labels_text(texts, _LONGEST, ' / ')}{unit}"
            for axis, labels in zip(method.settings.axes, along, strict=True):
                by_label = dict(zip(labels, shown.values(), strict=True))
                if all(map(eq, map(by_label.__getitem__, labels), shown.values())):
                    found[name] = _Along(axis, tuple(by_label.items()), unit and f" in{unit}")
    return found


def _with_values(settings: Mapping[str, _Setting]) -> tuple[Axis, ...]:
    """Return the axes whose labels stand for few different settings, with these."""
    named: dict[str, dict[str, _Along]] = {}
    for name, each in settings.items():
        if isinstance(each, _Along):
            named.setdefault(each.axis, {})[name] = each
    axes = []
    for axis, several in named.items():
        at_each = [*zip(*(each.values for each in several.values()), strict=True)]
        if len(at_each) <= _MOST_VALUES and not any(
            "…/" in text for each in at_each for _, text in each
        ):
            values = [(labels_text([at[0][0]]), *(text for _, text in at)) for at in at_each]
            names = (f"{name}{each.unit}" for name, each in several.items())
            axes.append(Axis(axis, settings=tuple(names), values=tuple(values)))
    return tuple(axes)


def _told_again(axis: Axis) -> Axis:
    """Return an axis whose labels stand elsewhere; those with the most common values are others."""
    for usual, count in Counter(row[1:] for row in axis.values).most_common(1):
        if count > 1:
            rows = [row for row in axis.values if row[1:] != usual]
            return axis._replace(values=(*rows, ("others", *usual)))
    return axis


def _value_text(value: object) -> str:
    """Return the value of a setting, of an address only its end."""
    text = "none" if value is None else value_text(value)
    address, *_ = text.split("#")
    return f"…/{address.rpartition('/')[2]}" if "://" in text else text


def _text(settings: Mapping[str, _Setting]) -> str:
    return ", ".join(f"{name}: {value}" for name, value in settings.items())


def _inputs(node: GraphNode) -> Collection[Port]:
    """Return the ports of a node's methods."""
    ports = {port.name: port for method in node.methods.values() for port in method.node.inputs}
    return ports.values()


def _kind(graph: Graph, node: GraphNode) -> Kind:
    if any(entry.node == node.name for entry in graph.spec.report):
        return "report"
    return "node" if any(method.inputs for method in node.methods.values()) else "input"


def _without_usual_name(output: Socket, inputs: Iterable[Socket]) -> Socket:
    """Return an output that shows its type, if it has no name of its own and no input has it."""
    if output.name != "output":
        return output
    is_known = any(socket.value == output.value for socket in inputs)
    return replace(output, shown="" if is_known else output.value)


def socket_of(port: Port) -> Socket:
    """Return a port as it is drawn."""
    return Socket(port.name, port.kind)

"""Contents of a drawing as plain data: boxes with sockets, and arrows between them."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

Kind = Literal["node", "input", "report"]

_MOST_SETTINGS = 26
"""Characters of the settings of what stands in a list."""
BETWEEN_PARTS = re.compile(r"(?<=[,…\N{MULTIPLICATION SIGN}\N{MIDDLE DOT}]) (?![^\[]*\])")
"""Between two parts of a text; a list is one."""
_AROUND = re.compile(r"(Truth|Across)\[|\]| \| None$")


@dataclass(frozen=True, slots=True)
class Socket:
    """A drawn port.

    Attributes
    ----------
    name : str
        Unique on its side of the box.
    type : str
    gathers : str
        The labels that a gathering port receives.
    shown : str, optional
        Shown in place of the name.
    items : tuple of str
        What in the report reads it, shown in place of the name.
    """

    name: str
    type: str = ""
    gathers: str = ""
    shown: str | None = None
    items: tuple[str, ...] = ()

    def __str__(self) -> str:
        return f"{self.name}: {self.type}" if self.type else self.name

    @property
    def text(self) -> str:
        """What is shown of the name."""
        own = "" if self.items else self.name
        return own if self.shown is None else self.shown

    @property
    def value(self) -> str:
        """The type of one value: of ``Truth[Across[Table]]``, ``Table``."""
        return _AROUND.sub("", self.type)

    @property
    def truth(self) -> bool:
        """Whether the value is the truth."""
        return self.type.startswith("Truth[")


class Alternative(NamedTuple):
    """One of the methods that are compared at a box.

    Attributes
    ----------
    label : str
    settings : str
        Those of its own that differ from the default: ``neighbours: 40``.
    source : str
        Where what it reads begins, if most others read something else: ``aligned``.
    """

    label: str
    settings: str = ""
    source: str = ""

    @property
    def details(self) -> str:
        """What follows the label: ``neighbours: 40 · from aligned``."""
        source = f"from {self.source}" if self.source else ""
        return " \N{MIDDLE DOT} ".join(filter(None, (self.settings, source)))

    def __str__(self) -> str:
        return f"{self.label} {self.details}".rstrip()


class Axis(NamedTuple):
    """An axis that settings of a box name.

    Attributes
    ----------
    name : str
    labels : str
        Where they are first drawn: ``5, 15, 45``.
    settings : tuple of str
        Those for which its labels stand: ``("sigma", "cutoff")``.
    values : tuple of (tuple of str)
        Each label, and after it the values of `settings`.
    """

    name: str
    labels: str = ""
    settings: tuple[str, ...] = ()
    values: tuple[tuple[str, ...], ...] = ()

    def __str__(self) -> str:
        rows = (
            f"{label} ({', '.join(map(': '.join, zip(self.settings, row, strict=True)))})"
            for label, *row in self.values
        )
        return ": ".join(filter(None, (self.name, ", ".join(rows) or self.labels)))


@dataclass(frozen=True, slots=True)
class Box:
    """A drawn node.

    Attributes
    ----------
    name : str
        Unique in the picture.
    lines : tuple of str
        Shown below the name, for instance the method that the node uses.
    inputs, outputs : tuple of Socket
    alternatives : tuple of Alternative
    axes : tuple of Axis
    kind : {"node", "input", "report"}
        An input reads data of the user; a report node is shown in the report.
    compares : bool
        What is computed from its alternatives is seen side by side in the end.
    passes : bool
        It stands for a graph used as a node, and passes on what a box of that graph returns.
    title : str
        Of what the report shows of it.
    """

    name: str
    lines: tuple[str, ...] = ()
    inputs: tuple[Socket, ...] = ()
    outputs: tuple[Socket, ...] = ()
    alternatives: tuple[Alternative, ...] = ()
    axes: tuple[Axis, ...] = ()
    kind: Kind = "node"
    compares: bool = False
    passes: bool = False
    title: str = ""

    @property
    def texts(self) -> tuple[str, ...]:
        """The lines, and what in the report reads its inputs."""
        return (*self.lines, *(item for socket in self.inputs for item in socket.items))


@dataclass(frozen=True, slots=True)
class Arrow:
    """A connection from an output of a box to an input of another.

    Attributes
    ----------
    source, source_port, target, target_port : str
    gathers : bool
        The target receives the values of several combinations at once.
    truth : bool
        The value is the truth, which methods must not see.
    fixed : str
        Axes that the arrow fixes: ``trial=0, length=45``.
    gathered : str
        The labels that a gathering port receives over the arrow: ``17 fill x 3 length``, or
        ``guenter, lin``.
    """

    source: str
    source_port: str
    target: str
    target_port: str
    gathers: bool = False
    truth: bool = False
    fixed: str = ""
    gathered: str = ""

    def __str__(self) -> str:
        notes = [f"at {self.fixed}"] if self.fixed else []
        notes += ["truth"] * self.truth
        notes += [f"gathers {self.gathered}".rstrip()] * self.gathers
        text = f"{self.source}.{self.source_port} to {self.target}.{self.target_port}"
        return text + (f" ({', '.join(notes)})" if notes else "")


@dataclass(frozen=True, slots=True)
class Picture:
    """A whole drawing, with the combinations in the report: ``8 actor x 3 data x 6 align``.

    Raises
    ------
    ValueError
        If two boxes share a name, or an arrow begins or ends at a port that is not drawn.
    """

    title: str
    boxes: tuple[Box, ...]
    arrows: tuple[Arrow, ...] = ()
    combinations: str = ""

    def __post_init__(self) -> None:
        twice = [
            name for name, count in Counter(box.name for box in self.boxes).items() if count > 1
        ]
        if twice:
            raise ValueError(f"several boxes are named {twice[0]!r}; each needs its own name")
        outputs = {box.name: _names(box.outputs) for box in self.boxes}
        inputs = {box.name: _names(box.inputs) for box in self.boxes}
        for arrow in self.arrows:
            _check_end(arrow, arrow.source, arrow.source_port, outputs)
            _check_end(arrow, arrow.target, arrow.target_port, inputs)


def origins(picture: Picture) -> list[str]:
    """Return where each arrow begins, in words: a box, with the output where several are drawn."""
    outputs = {box.name: len(box.outputs) for box in picture.boxes}

    def origin(arrow: Arrow) -> str:
        several = outputs[arrow.source] > 1
        return f"{arrow.source}{f'.{arrow.source_port}' * several}"

    return [origin(arrow) for arrow in picture.arrows]


def _names(sockets: Iterable[Socket]) -> tuple[str, ...]:
    return tuple(socket.name for socket in sockets)


def _check_end(arrow: Arrow, box: str, port: str, ports: dict[str, tuple[str, ...]]) -> None:
    if box not in ports:
        raise ValueError(f"arrow {arrow}: no box is named {box!r}; there is {', '.join(ports)}")
    if port not in ports[box]:
        there = ", ".join(ports[box]) or "none"
        raise ValueError(f"arrow {arrow}: {box!r} has no such port {port!r}; there is {there}")


def folded(picture: Picture) -> Picture:
    """Return a picture in which one box lists all those that only show something.

    These are boxes of the report that no other box reads. Those that read the same outputs share
    a port. With fewer than two such boxes, they stay. A graph that is used as a node is one box.
    Alternatives that several boxes have are listed at the first.
    """
    picture = _with_alternatives_once(_graphs_as_boxes(picture))
    shown = {box.name: box for box in picture.boxes if box.kind == "report"}
    while read := {
        arrow.source
        for arrow in picture.arrows
        if arrow.source in shown and arrow.target not in shown
    }:
        shown = {name: box for name, box in shown.items() if name not in read}
    if len(shown) < 2:
        return picture
    name = "report"
    while any(box.name == name for box in picture.boxes if box.name not in shown):
        name += " "
    kept = list[Arrow]()
    sources_of = {item: dict[tuple[str, str], Arrow]() for item in shown}
    for arrow in picture.arrows:
        if arrow.target not in shown:
            kept.append(arrow)
        elif arrow.source not in shown:
            ends = arrow.source, arrow.source_port
            known = sources_of[arrow.target].get(ends, arrow)
            gathers = known.gathers or arrow.gathers
            sources_of[arrow.target][ends] = replace(arrow, gathers=gathers)
    boxes = [box for box in picture.boxes if box.name not in shown]
    outputs = [(box.name, socket.name) for box in boxes for socket in box.outputs]
    order = {ends: at for at, ends in enumerate(outputs)}
    items_of: dict[frozenset[tuple[str, str]], list[str]] = {}
    for item, sources in sources_of.items():
        items_of.setdefault(frozenset(sources), []).append(item)
    items_of.pop(frozenset(), None)
    sockets = [
        Socket(item, items=tuple(_item(shown[each]) for each in (item, *others)))
        for item, *others in items_of.values()
    ]
    wires = [
        Arrow(
            *ends,
            name,
            items[0],
            gathers=any(sources_of[item][ends].gathers for item in items),
            truth=arrow.truth,
        )
        for items in items_of.values()
        for ends, arrow in sorted(sources_of[items[0]].items(), key=lambda each: order[each[0]])
    ]
    lines = tuple(_item(box) for item, box in shown.items() if not sources_of[item])
    card = Box(name, lines, tuple(sockets), kind="report")
    return replace(picture, boxes=(*boxes, card), arrows=(*kept, *wires))


def _item(box: Box) -> str:
    """Return what is told of a box in the report: its title, or name and method, first settings.

    A method that the name tells is left out.
    """
    told = [box.title or box.name]
    for line in box.lines[:2]:
        first, *more = BETWEEN_PARTS.split(line)
        both = " ".join([first, *more[:1]])
        text = (both if len(both) <= _MOST_SETTINGS else first).rstrip(",")
        is_method = ": " not in line
        told += [text] * (
            not is_method or (not box.title and line.rpartition(".")[2] not in box.name)
        )
    return " \N{MIDDLE DOT} ".join(told)


def _with_alternatives_once(picture: Picture) -> Picture:
    first: dict[tuple[Alternative, ...], str] = {}
    boxes = []
    for box in picture.boxes:
        known = first.setdefault(box.alternatives, box.name)
        if len(box.alternatives) > 1 and known != box.name:
            row = Alternative(f"the same {len(box.alternatives)} as {known}")
            box = replace(box, alternatives=(row,))
        boxes.append(box)
    return replace(picture, boxes=tuple(boxes))


def _graphs_as_boxes(picture: Picture) -> Picture:
    graph_of = _graphs_of(picture)
    if not graph_of:
        return picture
    arrows: dict[tuple[str, str, str, str], Arrow] = {}
    origins_before: list[tuple[str, Arrow]] = []
    inputs: dict[str, dict[str, tuple[str, Socket]]] = {}
    outputs: dict[str, dict[str, Socket]] = {}
    fed = {(box.name, each.name): each for box in picture.boxes for each in box.inputs}
    read = {(box.name, each.name): each for box in picture.boxes for each in box.outputs}
    for arrow, origin in zip(picture.arrows, origins(picture), strict=True):
        source, target = graph_of.get(arrow.source), graph_of.get(arrow.target)
        if source is not None and source == target:
            continue
        if source is not None:
            port = _output(source, arrow.source, arrow.source_port)
            socket = replace(read[arrow.source, arrow.source_port], name=port, shown=None)
            outputs.setdefault(source, {})[port] = socket
            arrow = replace(arrow, source=source, source_port=port)
        if target is not None:
            socket = fed[arrow.target, arrow.target_port]
            end = f"{arrow.source}.{arrow.source_port}"
            reader = arrow.target.removeprefix(f"{target}.")
            inputs.setdefault(target, {}).setdefault(end, (reader, socket))
            arrow = replace(arrow, target=target, target_port=end)
        ends = arrow.source, arrow.source_port, arrow.target, arrow.target_port
        origins_before.append((origin, arrows.setdefault(ends, arrow)))
    inside: dict[str, list[Box]] = {}
    for box in picture.boxes:
        inside.setdefault(graph_of.get(box.name, box.name), []).append(box)
    boxes = [
        _graph_as_box(name, parts, inputs.get(name, {}), outputs.get(name, {}))
        if parts[-1].name in graph_of
        else parts[-1]
        for name, parts in inside.items()
    ]
    direct = replace(picture, boxes=tuple(boxes), arrows=tuple(arrows.values()))
    origin_of = dict(zip(arrows.values(), origins(direct), strict=True))
    renamed = {origin: origin_of[arrow] for origin, arrow in origins_before}

    def with_sources(box: Box) -> Box:
        alternatives = [
            each._replace(source=renamed.get(each.source, each.source)) for each in box.alternatives
        ]
        return replace(box, alternatives=tuple(alternatives))

    return replace(direct, boxes=tuple(map(with_sources, direct.boxes)))


def _graph_as_box(
    name: str,
    parts: Sequence[Box],
    inputs: Mapping[str, tuple[str, Socket]],
    outputs: Mapping[str, Socket],
) -> Box:
    """Return one box for those of a graph, with what it is fed and what it returns."""
    counts = Counter(socket.name for _, socket in inputs.values())
    sockets = (
        replace(socket, name=end, shown=f"{f'{inner}.' * (counts[socket.name] > 1)}{socket.name}")
        for end, (inner, socket) in inputs.items()
    )
    axes: dict[str, Axis] = {}
    for axis in (axis for part in parts for axis in part.axes):
        axes.setdefault(axis.name, Axis(axis.name, axis.labels))
    return Box(
        name,
        lines=next(part.lines for part in parts if part.name == name),
        inputs=tuple(sockets),
        outputs=tuple(outputs.values()),
        axes=tuple(axes.values()),
        kind="node" if inputs else "input",
    )


def _output(graph: str, box: str, port: str) -> str:
    """Return the output of a graph: truth of its box `damage.truth`, a port of `damage`."""
    return box.removeprefix(graph).removeprefix(".") or port


def _graphs_of(picture: Picture) -> dict[str, str]:
    """Return the node that uses a graph for each box of this graph that is not shown itself."""
    graphs: list[str] = []
    for name in sorted(box.name for box in picture.boxes if box.passes):
        if not graphs or not name.startswith(f"{graphs[-1]}."):
            graphs.append(name)
    graph_of = {
        box.name: graph
        for box in picture.boxes
        for graph in graphs
        if f"{box.name}.".startswith(f"{graph}.")
    }
    shown = {graph_of.get(box.name) for box in picture.boxes if box.kind == "report"}
    return {name: graph for name, graph in graph_of.items() if graph not in shown}

"""Contents of a drawing as plain data: boxes with sockets, and arrows between them."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import networkx as nx

Kind = Literal["node", "input", "report"]

UNCHANGED = "unchanged"
"""In place of settings, of an alternative that passes on what it reads."""
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
        return self.name if self.shown is None else self.shown

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
        Those of its own: ``neighbours: 40``.
    source : str
        Where what it reads begins, if most others read something else: ``aligned``.
    """

    label: str
    settings: str = ""
    source: str = ""

    @property
    def details(self) -> tuple[str, str]:
        """What follows the label: ``neighbours: 40`` and ``from aligned``."""
        source = f"from {self.source}" if self.source else ""
        return "" if source and self.settings == UNCHANGED else self.settings, source

    def __str__(self) -> str:
        details = " \N{MIDDLE DOT} ".join(filter(None, self.details))
        return f"{self.label} {details}".rstrip()


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
        The method that the node uses, and its settings.
    inputs, outputs : tuple of Socket
    alternatives : tuple of Alternative
    axes : tuple of Axis
    kind : {"node", "input", "report"}
        An input reads data of the user; a report node is shown in the report.
    compares : bool
        What is computed from its alternatives is seen side by side in the end.
    passes : bool
        It stands for a graph used as a node, and passes on what a box of that graph returns.
    names : tuple of (str, str)
        The graph's inputs, each after the output that feeds it: ``("align.aligned", "recording")``.
    title : str
        Of what the report shows of it.
    answers : bool
        The report tells its answer by it.
    does : str
        What it does, in words.
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
    names: tuple[tuple[str, str], ...] = ()
    title: str = ""
    answers: bool = False
    does: str = ""

    @property
    def method(self) -> str:
        """The method that it uses, if it is one."""
        return next((line for line in self.lines[:1] if " " not in line), "")

    @property
    def settings(self) -> tuple[str, ...]:
        """The lines after the method."""
        return self.lines[bool(self.method) :]

    @property
    def is_list(self) -> bool:
        """Whether it lists what the report shows, and does nothing."""
        return any(socket.items for socket in self.inputs)

    @property
    def texts(self) -> tuple[str, ...]:
        """All that it tells of itself, and what in the report reads its inputs."""
        does = (self.does,) * bool(self.does)
        return (*self.lines, *does, *(item for socket in self.inputs for item in socket.items))


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
    """

    source: str
    source_port: str
    target: str
    target_port: str
    gathers: bool = False
    truth: bool = False
    fixed: str = ""

    def __str__(self) -> str:
        notes = [f"at {self.fixed}"] if self.fixed else []
        notes += ["truth"] * self.truth
        notes += ["gathers"] * self.gathers
        text = f"{self.source}.{self.source_port} to {self.target}.{self.target_port}"
        return text + (f" ({', '.join(notes)})" if notes else "")


@dataclass(frozen=True, slots=True)
class Picture:
    """A whole drawing, with what is compared: ``6 alternatives of align, for each actor (8)``."""

    title: str
    boxes: tuple[Box, ...]
    arrows: tuple[Arrow, ...] = ()
    combinations: str = ""


def origins(picture: Picture) -> list[str]:
    """Return where each arrow begins, in words: a box, with the output where several are drawn.

    Of what the report lists it is the box.
    """
    several = {box.name for box in picture.boxes if len(box.outputs) > 1}
    lists = {box.name for box in picture.boxes if box.is_list}
    return [
        f"{arrow.source}.{arrow.source_port}"
        if arrow.source in several and arrow.target not in lists
        else arrow.source
        for arrow in picture.arrows
    ]


def folded(picture: Picture) -> Picture:
    """Return a picture of few boxes, as it takes to follow a study.

    One box lists all those that only show something: boxes of the report that no other box reads;
    those made from the same last box share a port, and outputs that no other box reads stand last.
    Boxes that an answer is made from stand first.
    A graph that is used as a node is one box, and so are linked boxes that none of the report's
    answers reads; a box that makes one alternative is its row. Alternatives that several boxes
    have, and what they do, stand at the first.
    """
    picture = _together(picture, _graphs_of(picture))
    picture = _together(picture, _rows_of(picture))
    picture = _said_once(_together(picture, _asides_of(picture)))
    main = answering(picture)
    first = sorted(picture.boxes, key=lambda box: box.name not in main)
    picture = replace(picture, boxes=tuple(first))
    shown = {box.name: box for box in picture.boxes if box.kind == "report" and not box.is_list}
    while read := {
        arrow.source
        for arrow in picture.arrows
        if arrow.source in shown and arrow.target not in shown
    }:
        shown = {name: box for name, box in shown.items() if name not in read}
    if not shown:
        return picture
    name = "report"
    while any(box.name == name for box in picture.boxes if box.name not in shown):
        name += " "
    network = network_of(picture)

    def rank(arrow: Arrow) -> tuple[bool, int]:
        return not arrow.truth, len(nx.ancestors(network, arrow.source))

    into: dict[str, list[Arrow]] = {item: [] for item in shown}
    for arrow in picture.arrows:
        if arrow.target in shown and arrow.source not in shown:
            into[arrow.target].append(arrow)
    last = {item: max(arrows, key=rank) for item, arrows in into.items() if arrows}
    items_of: dict[str, list[str]] = {}
    for item, arrow in last.items():
        items_of.setdefault(arrow.source, []).append(item)
    sockets, wires = list[Socket](), list[Arrow]()
    for items in items_of.values():
        port = items[0]
        sockets.append(Socket(port, items=tuple(_item(shown[item]) for item in items)))
        own: dict[tuple[str, str], Arrow] = {}
        for arrow in (last[port], *(each for item in items for each in into[item])):
            ends = arrow.source, arrow.source_port
            gathers = arrow.gathers or (ends in own and own[ends].gathers)
            own[ends] = Arrow(*ends, name, port, gathers=gathers, truth=arrow.truth)
        wires += own.values()
    lines = tuple(_item(box) for item, box in shown.items() if not into[item])
    kept = [arrow for arrow in picture.arrows if arrow.target not in shown]
    going_on = {(arrow.source, arrow.source_port) for arrow in kept}
    boxes = (_sorted(box, going_on) for box in picture.boxes if box.name not in shown)
    card = Box(name, lines, tuple(sockets), kind="report")
    return replace(picture, boxes=(*boxes, card), arrows=(*kept, *wires))


def _sorted(box: Box, first: Collection[tuple[str, str]]) -> Box:
    outputs = sorted(box.outputs, key=lambda each: (box.name, each.name) not in first)
    return replace(box, outputs=tuple(outputs))


def _item(box: Box) -> str:
    """Return the title of a box in the report, or its name, and the method that this hides."""
    return box.title or " \N{MIDDLE DOT} ".join([box.name, *box.lines[:1]])


def network_of(picture: Picture) -> nx.DiGraph[str]:
    """Return the boxes with an edge along each arrow."""
    network: nx.DiGraph[str] = nx.DiGraph()
    network.add_nodes_from(box.name for box in picture.boxes)
    network.add_edges_from((arrow.source, arrow.target) for arrow in picture.arrows)
    return network


def answering(picture: Picture) -> set[str]:
    """Return the boxes that an answer of the report is made from; all if it has none."""
    network = network_of(picture)
    answers = {box.name for box in picture.boxes if box.answers}
    before = (nx.ancestors(network, name) for name in answers)
    return answers.union(*before) if answers else {*network}


def _rows_of(picture: Picture) -> dict[str, str]:
    """Return, for a box that nothing but one alternative reads, the box of that.

    The box reads data, or the alternative passes it on.
    """
    readers = network_of(picture).succ
    count = Counter(row.source for box in picture.boxes for row in box.alternatives)
    inputs = {box.name for box in picture.boxes if box.kind == "input"}
    rows = {
        row.source: box.name
        for box in picture.boxes
        for row in box.alternatives
        if count[row.source] == 1 and [*readers.get(row.source, ())] == [box.name]
        if row.settings == UNCHANGED or row.source in inputs
    }
    return rows | {name: name for name in rows.values()}


def _asides_of(picture: Picture) -> dict[str, str]:
    """Return the last of the linked boxes that no answer is made from, for each of several."""
    network = network_of(picture)
    main = answering(picture)
    aside = [box.name for box in picture.boxes if box.kind != "report" and box.name not in main]
    rows = map(network.subgraph, nx.weakly_connected_components(network.subgraph(aside)))
    several = ([*nx.topological_sort(row)] for row in rows if len(row) > 1)
    return {name: names[-1] for names in several for name in names}


def _said_once(picture: Picture) -> Picture:
    first: dict[tuple[Alternative, ...], str] = {}
    does = set[str]()
    boxes = []
    for box in picture.boxes:
        box = replace(box, does=box.does if box.does not in does else "")
        does.add(box.does)
        known = first.setdefault(box.alternatives, box.name)
        if len(box.alternatives) > 1 and known != box.name:
            row = Alternative(f"the same {len(box.alternatives)} as {known}")
            box = replace(box, alternatives=(row,))
        boxes.append(box)
    return replace(picture, boxes=tuple(boxes))


def _together(picture: Picture, graph_of: Mapping[str, str]) -> Picture:
    """Return a picture in which one box stands for those of each name in a mapping."""
    if not graph_of:
        return picture
    arrows: dict[tuple[str, str, str, str], Arrow] = {}
    origins_before: list[tuple[str, Arrow]] = []
    inputs: dict[str, dict[str, Socket]] = {}
    outputs: dict[str, dict[str, Socket]] = {}
    names = {(box.name, source): name for box in picture.boxes for source, name in box.names}
    fed = {(box.name, each.name): each for box in picture.boxes for each in box.inputs}
    read = {(box.name, each.name): each for box in picture.boxes for each in box.outputs}
    for arrow, origin in zip(picture.arrows, origins(picture), strict=True):
        source, target = graph_of.get(arrow.source), graph_of.get(arrow.target)
        if source is not None and source == target:
            continue
        name = names.get((target or "", f"{arrow.source}.{arrow.source_port}"))
        if source is not None:
            port = _output(source, arrow.source, arrow.source_port)
            socket = replace(read[arrow.source, arrow.source_port], name=port)
            if arrow.source != source:
                socket = replace(socket, shown=None)
            outputs.setdefault(source, {})[port] = socket
            arrow = replace(arrow, source=source, source_port=port)
        if target is not None:
            socket = fed[arrow.target, arrow.target_port]
            end = f"{arrow.source}.{arrow.source_port}"
            socket = replace(socket, name=end, shown=name or socket.text)
            inputs.setdefault(target, {}).setdefault(end, socket)
            arrow = replace(arrow, target=target, target_port=end)
        ends = arrow.source, arrow.source_port, arrow.target, arrow.target_port
        origins_before.append((origin, arrows.setdefault(ends, arrow)))
    inside: dict[str, list[Box]] = {}
    for box in picture.boxes:
        inside.setdefault(graph_of.get(box.name, box.name), []).append(box)
    boxes = [
        _as_box(name, parts, inputs.get(name, {}), outputs.get(name, {}))
        if parts[-1].name in graph_of
        else parts[-1]
        for name, parts in inside.items()
    ]
    direct = replace(picture, boxes=tuple(boxes), arrows=tuple(arrows.values()))
    origin_of = dict(zip(arrows.values(), origins(direct), strict=True))
    renamed = {origin: origin_of[arrow] for origin, arrow in origins_before}

    def renamed_in(row: Alternative) -> Alternative:
        return row._replace(source=renamed.get(row.source, row.source))

    boxes = [replace(box, alternatives=tuple(map(renamed_in, box.alternatives))) for box in boxes]
    return replace(direct, boxes=tuple(boxes))


def _as_box(
    name: str,
    parts: Sequence[Box],
    inputs: Mapping[str, Socket],
    outputs: Mapping[str, Socket],
) -> Box:
    """Return one box for a graph, for steps, or for what makes alternatives of its last part."""
    box = next(part for part in parts if part.name == name)
    made = {
        part.name: ", ".join(part.lines if part.method else (part.does, *part.lines))
        for part in parts
        if part is not box
    }
    rows = []
    for row in box.alternatives:
        if row.source in made:
            told = f"{made[row.source]}, {row.settings}".removesuffix(f", {UNCHANGED}")
            row = row._replace(settings=told.removesuffix(", "), source="")
        rows.append(row)
    reading = {row.source for row in box.alternatives} - made.keys()
    if rows != [*box.alternatives] and len(reading) == 1:  # from where the only arrow comes
        rows = [row._replace(source="") for row in rows]
    lines, does = box.lines, box.does
    if not box.passes and rows == [*box.alternatives]:
        before = ", ".join(part.name for part in parts if part is not box)
        does = f"The last of {len(parts)} steps, after {before}"
        lines = tuple(line for part in parts[: not inputs] for line in part.settings)
    order = {each: at for at, (_, each) in enumerate(box.names)}
    sockets = sorted(inputs.values(), key=lambda each: order.get(each.text, len(order)))
    axes = {axis.name: axis for part in parts for axis in part.axes if axis.labels}
    return Box(
        name,
        lines,
        tuple(sockets),
        tuple(outputs.values()),
        tuple(rows),
        tuple(axes.values()),
        kind="node" if inputs else "input",
        compares=box.compares and does == box.does,
        does=does,
    )


def _output(graph: str, box: str, port: str) -> str:
    """Return the output of a graph: truth of its box `damage.truth`, a port of `damage`."""
    if box.startswith(f"{graph}."):
        return box.removeprefix(f"{graph}.")
    return port if box == graph else f"{box}.{port}".removesuffix(".output")


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

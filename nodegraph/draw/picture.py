"""Contents of a drawing as plain data: boxes with sockets, and arrows between them."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

Kind = Literal["node", "input", "report"]

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
    shown : str
        Shown in place of the name.
    """

    name: str
    type: str = ""
    gathers: str = ""
    shown: str = ""

    def __str__(self) -> str:
        return f"{self.name}: {self.type}" if self.type else self.name

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
        Where what it reads begins, if others read something else: ``aligned``.
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
    axes : tuple of str
        Axes that its settings name, with their labels where they are first drawn:
        ``length: 5, 15, 45``.
    kind : {"node", "input", "report"}
        An input reads data of the user; a report node is shown in the report.
    passes : bool
        It stands for a graph, and passes on what boxes of this graph return: each input is the
        output of the same name.
    """

    name: str
    lines: tuple[str, ...] = ()
    inputs: tuple[Socket, ...] = ()
    outputs: tuple[Socket, ...] = ()
    alternatives: tuple[Alternative, ...] = ()
    axes: tuple[str, ...] = ()
    kind: Kind = "node"
    passes: bool = False


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
    """A whole drawing.

    Raises
    ------
    ValueError
        If two boxes share a name, or an arrow begins or ends at a port that is not drawn.
    """

    title: str
    boxes: tuple[Box, ...]
    arrows: tuple[Arrow, ...] = ()

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

    These are boxes of the report that no other box reads. An arrow into the list stands for all
    arrows of its output. With fewer than two such boxes, they stay. Boxes that pass on what a graph
    returns go: arrows begin where they would.
    """
    picture = _without_passing(picture)
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
    kept, wires, names = [], dict[tuple[str, str], Arrow](), dict[tuple[str, str], str]()
    for arrow, origin in zip(picture.arrows, origins(picture), strict=True):
        if arrow.target not in shown:
            kept.append(arrow)
        elif arrow.source not in shown:
            ends = arrow.source, arrow.source_port
            names[ends] = origin
            known = wires.get(ends, arrow)
            wires[ends] = Arrow(
                *ends,
                name,
                ".".join(ends),
                gathers=known.gathers or arrow.gathers,
                truth=arrow.truth,
            )
    boxes = [box for box in picture.boxes if box.name not in shown]
    sockets = [Socket(arrow.target_port, shown=names[ends]) for ends, arrow in wires.items()]
    lines = tuple(" ".join((box.name, *box.lines)) for box in shown.values())
    card = Box(name, lines, tuple(sockets), kind="report")
    return Picture(picture.title, (*boxes, card), (*kept, *wires.values()))


def _without_passing(picture: Picture) -> Picture:
    passing = {box.name for box in picture.boxes if box.passes and box.kind == "node"}
    if not passing:
        return picture
    into = {
        (arrow.target, arrow.target_port): arrow
        for arrow in picture.arrows
        if arrow.target in passing
    }
    kept, arrows = [], []
    for arrow in picture.arrows:
        if arrow.target in passing:
            continue
        kept.append(arrow)
        while before := into.get((arrow.source, arrow.source_port)):
            fixed = ", ".join(filter(None, (before.fixed, arrow.fixed)))
            arrow = replace(
                arrow, source=before.source, source_port=before.source_port, fixed=fixed
            )
        arrows.append(arrow)
    whole = Picture(picture.title, picture.boxes, tuple(kept))
    boxes = tuple(box for box in picture.boxes if box.name not in passing)
    direct = Picture(picture.title, boxes, tuple(arrows))
    renamed = dict(zip(origins(whole), origins(direct), strict=True))
    boxes = tuple(
        replace(
            box,
            alternatives=tuple(
                each._replace(source=renamed.get(each.source, each.source))
                for each in box.alternatives
            ),
        )
        for box in boxes
    )
    return replace(direct, boxes=boxes)

"""What stands directly within one frame, laid out: boxes, frames as cells, pins on the edge."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from nodegraph.draw.arrange import Arranged, arranged
from nodegraph.draw.cells import PIN, Cell, Point, Wire
from nodegraph.draw.clusters import Frame, Member, last_part
from nodegraph.draw.picture import Arrow
from nodegraph.draw.text import shortened, width

LABEL_SIZE = 13.0
LABEL_HEIGHT = 26.0
PADDING = 16.0

_Slot = tuple[str, Hashable]
_End = tuple[_Slot, Hashable]


@dataclass(frozen=True, slots=True)
class Passing:
    """An arrow as it is seen within one frame; an end that lies outside is None."""

    number: int
    arrow: Arrow
    source: Member | None
    target: Member | None

    @property
    def key(self) -> tuple[str, str, bool]:
        """Equal for arrows that may share a line: they leave one port."""
        return self.arrow.source, self.arrow.source_port, self.arrow.truth

    @property
    def begin(self) -> _End:
        """Where within the frame the arrow begins, and at which port there."""
        if self.source is None:
            return ("entry", self.key), ""
        return self.source, self.key if self.source[0] == "frame" else self.arrow.source_port

    @property
    def end(self) -> _End:
        """Where within the frame the arrow ends, and at which port there."""
        if self.target is None:
            return ("exit", self.key), ""
        return self.target, self.key if self.target[0] == "frame" else self.arrow.target_port


@dataclass(slots=True)
class Level:
    """A frame's members, and the arrows that are seen within it."""

    frame: Frame
    members: dict[Member, None] = field(default_factory=dict)
    arrows: list[Passing] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class LaidOut:
    """A frame laid out, measured from its upper left corner.

    Attributes
    ----------
    cell : Cell
        The frame as it is seen outside.
    corners : mapping of member to point
    routes : mapping of arrow number to points
    """

    cell: Cell
    corners: Mapping[Member, Point]
    routes: Mapping[int, Sequence[Point]]


def laid_out(level: Level, cells: Mapping[Member, Cell]) -> LaidOut:
    """Return a frame laid out, given the cells of its members."""
    label: list[_Slot] = [("label", level.frame)] if level.frame else []
    entries = _pins(one.begin for one in level.arrows if not one.source)
    exits = _pins(one.end for one in level.arrows if not one.target)
    slots: list[_Slot] = [*label, *entries, *level.members, *exits]
    place = {slot: number for number, slot in enumerate(slots)}
    shapes = [
        *(_label_cell(level.frame) for _ in label),
        *(PIN for _ in entries),
        *(cells[one] for one in level.members),
        *(PIN for _ in exits),
    ]
    wires: dict[Wire, int] = {}
    wire_of = {one.number: wires.setdefault(_wire(one, place), len(wires)) for one in level.arrows}
    found = arranged(shapes, list(wires), len(label) + len(entries), len(exits))
    padding = PADDING if level.frame else 0.0
    return LaidOut(
        _seen_outside(found, place, padding),
        {one: _moved(found.corners[place[one]], padding) for one in level.members},
        {
            number: [_moved(point, padding) for point in found.routes[wire]]
            for number, wire in wire_of.items()
        },
    )


def _pins(ends: Iterable[_End]) -> list[_Slot]:
    return list(dict.fromkeys(slot for slot, _ in ends))


def _label_cell(frame: Frame) -> Cell:
    wide = width(shortened(last_part(frame)), LABEL_SIZE, bold=True)
    return Cell(wide, LABEL_HEIGHT, {}, {})


def _wire(one: Passing, place: Mapping[_Slot, int]) -> Wire:
    (source, source_port), (target, target_port) = one.begin, one.end
    return Wire(place[source], source_port, place[target], target_port, one.arrow.truth)


def _seen_outside(found: Arranged, place: Mapping[_Slot, int], padding: float) -> Cell:
    pins: dict[str, dict[Hashable, float]] = {"entry": {}, "exit": {}}
    for (kind, key), number in place.items():
        if kind in pins:
            pins[kind][key] = found.corners[number][0] + PIN.width / 2 + padding
    below = 0.0 if pins["exit"] else padding
    return Cell(found.width + 2 * padding, found.height + below, pins["entry"], pins["exit"])


def _moved(point: Point, right: float) -> Point:
    return point[0] + right, point[1]

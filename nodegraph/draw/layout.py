"""Layout of a picture: positions of boxes and frames, and the points of every arrow.

The contents of a frame are laid out separately; outside, the frame is a single cell, and arrows
cross its edge at the same places as inside.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import networkx as nx

from nodegraph.draw.box_frames import (
    Frame,
    Member,
    Path,
    frames_of,
    last_part,
    member,
    short_name,
    without_cycles,
)
from nodegraph.draw.box_shape import Shape, shape, shortened, width
from nodegraph.draw.layered import PIN, Cell, Point, Wire, arrange
from nodegraph.draw.picture import Arrow, Box, Picture

LABEL_SIZE = 13.0
LABEL_HEIGHT = 26.0
PADDING = 16.0

_Slot = tuple[str, Hashable]
_End = tuple[_Slot, Hashable]


@dataclass(frozen=True, slots=True)
class Passing:
    """The part of an arrow within one frame; an end that lies outside is None."""

    number: int
    arrow: Arrow
    source: Member | None
    target: Member | None

    @property
    def key(self) -> tuple[str, str]:
        """Equal for arrows that share a line: they leave one port."""
        return self.arrow.source, self.arrow.source_port

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
    """A frame's members, and the parts of arrows between them."""

    frame: Frame
    members: dict[Member, None] = field(default_factory=dict)
    arrows: list[Passing] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class FrameLayout:
    """The layout of one frame, measured from its upper left corner.

    Attributes
    ----------
    cell : Cell
        The frame as a cell of the frame around it.
    corners : mapping of member to point
    routes : mapping of arrow number to points
    """

    cell: Cell
    corners: Mapping[Member, Point]
    routes: Mapping[int, Sequence[Point]]


def lay_out(level: Level, cells: Mapping[Member, Cell]) -> FrameLayout:
    """Return the layout of a frame, given the cells of its members."""
    entries = _pins(passing.begin for passing in level.arrows if not passing.source)
    exits = _pins(passing.end for passing in level.arrows if not passing.target)
    slots: list[_Slot] = [*entries, *level.members, *exits]
    place = {slot: number for number, slot in enumerate(slots)}
    shapes = [cells[slot] if slot in level.members else PIN for slot in slots]
    wires: dict[Wire, int] = {}
    wire_of = {
        passing.number: wires.setdefault(_wire(passing, place), len(wires))
        for passing in level.arrows
    }
    arrangement = arrange(shapes, list(wires), len(entries), len(exits))
    padding = PADDING if level.frame else 0.0
    right, down = padding, LABEL_HEIGHT + padding / 2 if level.frame else 0.0
    label = width(shortened(last_part(level.frame)), LABEL_SIZE, bold=True)
    wide = max(arrangement.width, label) + 2 * padding
    levels = {slot: arrangement.corners[place[slot]][1] + PIN.height / 2 + down for slot in slots}
    routes: dict[int, list[Point]] = {}
    for passing in level.arrows:
        points = arrangement.routes[wire_of[passing.number]]
        routes[passing.number] = [(x + right, y + down) for x, y in points]
        if not passing.source:
            routes[passing.number].insert(0, (0.0, levels[passing.begin[0]]))
        if not passing.target:
            routes[passing.number].append((wide, levels[passing.end[0]]))
    return FrameLayout(
        Cell(
            wide,
            arrangement.height + down + padding,
            {key: levels["entry", key] for _, key in entries},
            {key: levels["exit", key] for _, key in exits},
        ),
        {
            member: (x + right, y + down)
            for member in level.members
            for x, y in [arrangement.corners[place[member]]]
        },
        routes,
    )


def _pins(ends: Iterable[_End]) -> list[_Slot]:
    return list(dict.fromkeys(slot for slot, _ in ends))


def _wire(passing: Passing, place: Mapping[_Slot, int]) -> Wire:
    (source, source_port), (target, target_port) = passing.begin, passing.end
    return Wire(place[source], source_port, place[target], target_port)


@dataclass(frozen=True, slots=True)
class FrameBox:
    """A frame with its label, position and size."""

    name: Frame
    label: str
    x: float
    y: float
    width: float
    height: float


@dataclass(frozen=True, slots=True)
class Layout:
    """Positions of boxes and frames, and the routes of arrows.

    Attributes
    ----------
    boxes : tuple of (Shape, point)
        Each box and its upper left corner, in the picture's order.
    frames : tuple of FrameBox
        Outer frames first.
    routes : tuple of (tuple of point)
        For each arrow the points between which it runs; see `nodegraph.draw.svg.line`.
    """

    boxes: tuple[tuple[Shape, Point], ...]
    frames: tuple[FrameBox, ...]
    routes: tuple[tuple[Point, ...], ...]
    width: float
    height: float


def layout(picture: Picture) -> Layout:
    """Return the layout of a picture.

    Raises
    ------
    ValueError
        If arrows form a cycle.
    """
    _check_acyclic(picture)
    links = [(arrow.source, arrow.target) for arrow in picture.arrows]
    paths = without_cycles(frames_of(box.name for box in picture.boxes), links)
    shapes = _shapes(picture, paths)
    cells: dict[Member, Cell] = {
        ("box", shape.box.name): Cell(shape.width, shape.height, shape.inputs, shape.outputs)
        for shape in shapes
    }
    levels = _levels(picture, paths)
    frames: dict[Frame, FrameLayout] = {}
    for frame in reversed(levels):  # inner frames first
        frames[frame] = lay_out(levels[frame], cells)
        cells["frame", frame] = frames[frame].cell
    return _put_together(shapes, levels, frames, len(picture.arrows))


def _put_together(
    shapes: Sequence[Shape],
    levels: Mapping[Frame, Level],
    frames: Mapping[Frame, FrameLayout],
    arrows: int,
) -> Layout:
    corners: dict[Member, Point] = {("frame", ""): (0.0, 0.0)}
    for frame in levels:
        x, y = corners["frame", frame]
        corners |= {member: (x + a, y + b) for member, (a, b) in frames[frame].corners.items()}
    routes: list[list[Point]] = [[] for _ in range(arrows)]
    for frame, passing in _along(levels):
        x, y = corners["frame", frame]
        points = [(x + a, y + b) for a, b in frames[frame].routes[passing.number]]
        routes[passing.number] += points[1:] if routes[passing.number] else points
    root = frames[""].cell
    return Layout(
        tuple((shape, corners["box", shape.box.name]) for shape in shapes),
        tuple(_frame_box(frame, corners, frames[frame].cell) for frame in levels if frame),
        tuple(tuple(points) for points in routes),
        root.width,
        root.height,
    )


def _along(levels: Mapping[Frame, Level]) -> list[tuple[Frame, Passing]]:
    """Return the parts of all arrows, those of each from its source to its target."""
    passing = [(frame, arrow) for frame, level in levels.items() for arrow in level.arrows]
    leaving = [pair for pair in reversed(passing) if pair[1].target is None]
    return [*leaving, *(pair for pair in passing if pair[1].target is not None)]


def _frame_box(frame: Frame, corners: Mapping[Member, Point], cell: Cell) -> FrameBox:
    x, y = corners["frame", frame]
    return FrameBox(frame, last_part(frame), x, y, cell.width, cell.height)


def _levels(picture: Picture, paths: Mapping[str, Path]) -> dict[Frame, Level]:
    """Return every frame with its direct contents, outer frames first."""
    frames = {frame: place for path in paths.values() for place, frame in enumerate(path)}
    ordered = ["", *sorted(frames, key=frames.__getitem__)]
    levels = {frame: Level(frame) for frame in ordered}
    for name, path in paths.items():
        for frame in ("", *path):
            if inner := member(frame, name, path):
                levels[frame].members[inner] = None
    for number, arrow in enumerate(picture.arrows):
        source, target = paths[arrow.source], paths[arrow.target]
        for frame in dict.fromkeys(("", *source, *target)):
            begin, end = member(frame, arrow.source, source), member(frame, arrow.target, target)
            if begin != end:
                levels[frame].arrows.append(Passing(number, arrow, begin, end))
    return levels


def _shapes(picture: Picture, paths: Mapping[str, Path]) -> list[Shape]:
    wired: dict[str, dict[str, list[str]]] = {box.name: {} for box in picture.boxes}
    for arrow in picture.arrows:
        wired[arrow.source].setdefault(arrow.source_port, [])
        notes = wired[arrow.target].setdefault(arrow.target_port, [])
        notes += [f"at {arrow.fixed}"] if arrow.fixed else []
    return [_shape(box, wired[box.name], paths[box.name]) for box in picture.boxes]


def _shape(box: Box, ports: Mapping[str, Sequence[str]], path: Path) -> Shape:
    return shape(box, frozenset(ports), ports, short_name(box.name, path))


def _check_acyclic(picture: Picture) -> None:
    network = nx.DiGraph([(arrow.source, arrow.target) for arrow in picture.arrows])
    if not nx.is_directed_acyclic_graph(network):
        cycle = [source for source, _ in nx.find_cycle(network)]
        raise ValueError(f"arrows form a cycle: {' -> '.join([*cycle, cycle[0]])}")

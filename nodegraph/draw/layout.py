"""A picture laid out: boxes, frames around boxes, and the points of every arrow.

What stands in a frame is laid out on its own; outside, the frame is one cell, and an arrow
passes its edge where it does so inside.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import takewhile

from nodegraph.draw.arrange import Arranged, arranged
from nodegraph.draw.layers import PIN, Cell, Point, Wire, in_order
from nodegraph.draw.picture import Arrow, Box, Picture
from nodegraph.draw.shape import Shape, shape, shortened, width

Frame = str
"""What the names in a frame have in common: ``clean``, or ``clean.fine`` within it."""

Path = tuple[Frame, ...]
"""The frames around a box, from the outermost."""

Member = tuple[str, str]
"""``box`` or ``frame``, and its name."""


def frames_of(names: Iterable[str]) -> dict[str, Path]:
    """Return the frames around each box.

    The boxes ``clean.despike`` and ``clean.smooth`` stand in the frame ``clean``, and so does
    the box ``clean`` itself, which hands on what they make.
    """
    names = tuple(names)
    around = {name: _prefixes(name) for name in names}
    frames = {frame for path in around.values() for frame in path}
    return {name: (*around[name], name) if name in frames else around[name] for name in names}


def called(name: str, path: Path) -> str:
    """Return what a box is called within its frames."""
    shown = [name.removeprefix(f"{frame}.") for frame in path if frame != name]
    return min(shown, key=len, default=name)


def last_part(frame: Frame) -> str:
    """Return what a frame is called within those around it."""
    return frame.rpartition(".")[2]


def outline(paths: Mapping[str, Path]) -> Iterator[tuple[str, str, int]]:
    """Yield what a text that nests frames says, each with its depth.

    That is ``("open", frame)`` and ``("close", frame)`` around ``("box", name)``; boxes come in
    their order, those of one frame together.
    """
    first: dict[str, int] = {}
    for number, (name, path) in enumerate(paths.items()):
        for one in (*path, f" {name}"):
            first.setdefault(one, number)
    opened: Path = ()
    for name in sorted(paths, key=lambda one: [first[it] for it in (*paths[one], f" {one}")]):
        shared = shared_frames(opened, paths[name])
        yield from _closed(opened, shared)
        opened = paths[name]
        for depth in range(shared, len(opened)):
            yield "open", opened[depth], depth
        yield "box", name, len(opened)
    yield from _closed(opened, 0)


def shared_frames(one: Path, other: Path) -> int:
    """Return how many frames, from the outermost, two paths have in common."""
    same = (a == b for a, b in zip(one, other, strict=False))
    return sum(takewhile(bool, same))


def _closed(opened: Path, least: int) -> Iterator[tuple[str, str, int]]:
    for depth in range(len(opened) - 1, least - 1, -1):
        yield "close", opened[depth], depth


def without_circles(
    paths: Mapping[str, Path], arrows: Iterable[tuple[str, str]]
) -> Mapping[str, Path]:
    """Return the paths without the frames that arrows leave and enter again by way of others.

    Such a frame cannot stand below what feeds it and above what it feeds.
    """
    arrows = tuple(dict.fromkeys(arrows))
    pending: list[Frame] = [""]
    while pending:
        frame = pending.pop()
        while circling := _circling(frame, paths, arrows):
            paths = {
                name: tuple(one for one in path if one not in circling)
                for name, path in paths.items()
            }
        pending += dict.fromkeys(
            inside[0] for path in paths.values() if (inside := _inside(frame, path))
        )
    return paths


def member(frame: Frame, name: str, path: Path) -> Member | None:
    """Return what holds a box directly within a frame: a frame, or the box itself."""
    if frame and frame not in path:
        return None
    inside = _inside(frame, path)
    return ("frame", inside[0]) if inside else ("box", name)


def _prefixes(name: str) -> Path:
    parts = name.split(".")
    if not all(parts):
        return ()
    return tuple(".".join(parts[:count]) for count in range(1, len(parts)))


def _inside(frame: Frame, path: Path) -> Path:
    if not frame:
        return path
    return path[path.index(frame) + 1 :] if frame in path else ()


def _circling(
    frame: Frame, paths: Mapping[str, Path], arrows: Sequence[tuple[str, str]]
) -> set[Frame]:
    """Return the frames directly within a frame that lie on a circle, or between two."""
    found = {name: member(frame, name, path) for name, path in paths.items()}
    members = {name: one for name, one in found.items() if one}
    numbers = {one: number for number, one in enumerate(dict.fromkeys(members.values()))}
    links = [
        (numbers[members[source]], numbers[members[target]])
        for source, target in arrows
        if source in members and target in members and members[source] != members[target]
    ]
    forwards = set(in_order(len(numbers), links))
    backwards = set(in_order(len(numbers), [(target, source) for source, target in links]))
    return {
        name
        for (kind, name), number in numbers.items()
        if kind == "frame" and number not in forwards and number not in backwards
    }


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


@dataclass(frozen=True, slots=True)
class Framed:
    """A frame, what it is called within those around it, and where it stands."""

    name: Frame
    label: str
    x: float
    y: float
    width: float
    height: float


@dataclass(frozen=True, slots=True)
class Layout:
    """Where everything stands.

    Attributes
    ----------
    boxes : tuple of (Shape, point)
        Each box and its upper left corner, in the picture's order.
    frames : tuple of Framed
        Each before those within it.
    routes : tuple of (tuple of point)
        For each arrow the points between which it runs; see `nodegraph.draw.svg.line`.
    """

    boxes: tuple[tuple[Shape, Point], ...]
    frames: tuple[Framed, ...]
    routes: tuple[tuple[Point, ...], ...]
    width: float
    height: float


def layout(picture: Picture) -> Layout:
    """Return a picture laid out.

    Raises
    ------
    ValueError
        If arrows run in a circle.
    """
    _refuse_circles(picture)
    links = [(arrow.source, arrow.target) for arrow in picture.arrows]
    paths = without_circles(frames_of(box.name for box in picture.boxes), links)
    shapes = _shapes(picture, paths)
    cells: dict[Member, Cell] = {
        ("box", one.box.name): Cell(one.width, one.height, one.inputs, one.outputs)
        for one in shapes
    }
    levels = _levels(picture, paths)
    found: dict[Frame, LaidOut] = {}
    for frame in reversed(levels):  # what lies within comes first
        found[frame] = laid_out(levels[frame], cells)
        cells["frame", frame] = found[frame].cell
    return _put_together(shapes, levels, found, len(picture.arrows))


def _put_together(
    shapes: Sequence[Shape],
    levels: Mapping[Frame, Level],
    found: Mapping[Frame, LaidOut],
    arrows: int,
) -> Layout:
    corners: dict[Member, Point] = {("frame", ""): (0.0, 0.0)}
    for frame in levels:
        x, y = corners["frame", frame]
        corners |= {one: (x + a, y + b) for one, (a, b) in found[frame].corners.items()}
    routes: list[list[Point]] = [[] for _ in range(arrows)]
    for frame, passing in _along(levels):
        x, y = corners["frame", frame]
        points = [(x + a, y + b) for a, b in found[frame].routes[passing.number]]
        routes[passing.number] += points[1:] if routes[passing.number] else points
    root = found[""].cell
    return Layout(
        tuple((one, corners["box", one.box.name]) for one in shapes),
        tuple(_framed(frame, corners, found[frame].cell) for frame in levels if frame),
        tuple(tuple(points) for points in routes),
        root.width,
        root.height,
    )


def _along(levels: Mapping[Frame, Level]) -> list[tuple[Frame, Passing]]:
    """Return the pieces of all arrows, those of each from its source on."""
    passing = [(frame, one) for frame, level in levels.items() for one in level.arrows]
    leaving = [pair for pair in reversed(passing) if pair[1].target is None]
    return [*leaving, *(pair for pair in passing if pair[1].target is not None)]


def _framed(frame: Frame, corners: Mapping[Member, Point], cell: Cell) -> Framed:
    x, y = corners["frame", frame]
    return Framed(frame, last_part(frame), x, y, cell.width, cell.height)


def _levels(picture: Picture, paths: Mapping[str, Path]) -> dict[Frame, Level]:
    """Return every frame, each before those within it, with what is seen directly within it."""
    frames = {frame: place for path in paths.values() for place, frame in enumerate(path)}
    ordered = ["", *sorted(frames, key=frames.__getitem__)]
    levels = {frame: Level(frame) for frame in ordered}
    for name, path in paths.items():
        for frame in ("", *path):
            one = member(frame, name, path)
            levels[frame].members |= {one: None} if one else {}
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
        fixed = wired[arrow.target].setdefault(arrow.target_port, [])
        fixed += [arrow.fixed] if arrow.fixed else []
    return [_shape(box, wired[box.name], paths[box.name]) for box in picture.boxes]


def _shape(box: Box, ports: Mapping[str, Sequence[str]], path: Path) -> Shape:
    return shape(box, frozenset(ports), ports, called(box.name, path))


def _refuse_circles(picture: Picture) -> None:
    numbers = {box.name: number for number, box in enumerate(picture.boxes)}
    links = [(numbers[arrow.source], numbers[arrow.target]) for arrow in picture.arrows]
    well = set(in_order(len(numbers), links))
    if len(well) < len(numbers):
        circle = ", ".join(name for name, number in numbers.items() if number not in well)
        raise ValueError(f"arrows run in a circle among or into: {circle}")

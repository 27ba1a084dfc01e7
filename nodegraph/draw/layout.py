"""A picture laid out: boxes, frames around boxes, and the points of every arrow.

What stands in a frame is laid out on its own; outside, the frame is one cell, and an arrow
passes its edge where it does so inside.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from nodegraph.draw.cells import Cell, Point
from nodegraph.draw.clusters import (
    Frame,
    Member,
    Path,
    called,
    frames_of,
    last_part,
    member,
    without_circles,
)
from nodegraph.draw.depths import in_order
from nodegraph.draw.level import LaidOut, Level, Passing, laid_out
from nodegraph.draw.picture import Box, Picture
from nodegraph.draw.shape import Shape, shape


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
        For each arrow the points between which it runs; see `nodegraph.draw.marks.line`.
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

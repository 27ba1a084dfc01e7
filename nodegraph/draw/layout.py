"""Layered layout from left to right: boxes in columns, frames around boxes, points of arrows.

After K. Sugiyama et al. (1981), IEEE Trans. Systems, Man, and Cybernetics 11(2), 109-125: a cell
stands in a column after its sources, the barycentres of its neighbours order each column, and a
wire over several columns takes a place in each of them. The contents of a frame are laid out by
themselves; outside, the frame is one cell, whose edge wires cross at the same heights. Columns
that are wider than a page together stand in bands, like lines of text; wires turn at their ends.
"""

from __future__ import annotations

from bisect import bisect_right, insort
from collections import Counter
from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import accumulate, pairwise, takewhile
from math import inf
from typing import NamedTuple

import networkx as nx

from nodegraph.draw.boxes import Shape, shape, shortened, width
from nodegraph.draw.frames import Frame, frames_of, label_of
from nodegraph.draw.picture import Picture

Point = tuple[float, float]
Cell = tuple[str, Hashable]
"""A cell of a frame: ``("box", name)``, ``("frame", its names)``, or the bend of a wire."""
End = tuple[Cell, Hashable]
"""A cell, and one of its ports."""
Wire = tuple[End, End]

LABEL_SIZE = 13.0
LABEL_HEIGHT = 26.0
PADDING = 16.0
_HEAD = LABEL_HEIGHT + PADDING / 2
_BETWEEN_CELLS = 22.0
_BETWEEN_COLUMNS = 44.0
_BETWEEN_TURNS = 8.0
_BEFORE_HEAD = 20.0
"""Between the head of an arrow and the turn of a wire that comes from the band above."""
_TURN = 0.05
"""Cost of a wire between two bands; that of a band of full width is 1."""
_WIDEST = 1000.0
"""Width of a drawing that can still be read on a page of 720 pixels."""
_SWEEPS = 16
_STILL = 0.02
_STRAIGHTENINGS = 3
_NEARLY_LEVEL = 36.0
_DIRECT = 4.0
"""Weight of a wire between neighbouring boxes: chains of boxes become straight first."""


@dataclass(frozen=True, slots=True)
class Size:
    """Size of a cell, and how far from its top the wires of each port end or begin."""

    width: float
    height: float
    inputs: Mapping[Hashable, float]
    outputs: Mapping[Hashable, float]


_BEND = Size(0.0, 12.0, {"": 6.0}, {"": 6.0})


@dataclass(slots=True)
class Area:
    """The inside of a frame, or the whole drawing.

    Attributes
    ----------
    sizes : dict of cell to Size
        Cells called ``entry`` and ``exit`` stand left and right of all others.
    wires : dict of wire to (list of point)
        They form no cycle. `arrange` fills in the points between which a wire runs.
    named : set of wire
        Those that end at a port which says where they begin: from another band, only their end is
        drawn.
    corners : dict of cell to point
        Upper left corners, from `arrange`.
    """

    sizes: dict[Cell, Size] = field(default_factory=dict)
    wires: dict[Wire, list[Point]] = field(default_factory=dict)
    named: set[Wire] = field(default_factory=set)
    corners: dict[Cell, Point] = field(default_factory=dict)
    width: float = 0.0
    height: float = 0.0

    def arrange(self, widest: float = inf) -> None:
        """Find a place for every cell and a way for every wire.

        Parameters
        ----------
        widest
            Columns that are wider together stand in several bands, one below the other.
        """
        depths = _depths(self.sizes, self.wires)
        columns: list[list[Cell]] = [[] for _ in range(max(depths.values(), default=-1) + 1)]
        for cell, depth in depths.items():
            columns[depth].append(cell)
        sizes = dict(self.sizes)
        ways: dict[Wire, list[End]] = {}
        for wire in self.wires:
            (source, port), (target, _) = wire
            ways[wire] = [wire[0]]
            for depth in range(depths[source] + 1, depths[target]):
                bend = ("bend", (source, port, depth))  # shared by all wires of the port
                if bend not in sizes:
                    columns[depth].insert(len(columns[depth]) // 2, bend)
                    sizes[bend] = _BEND
                ways[wire].append((bend, ""))
            ways[wire].append(wire[1])
        pieces = _pieces(ways.values(), sizes)
        bands = _bands(_ordered(columns, sizes, pieces), sizes, pieces, widest)
        band_of = _bands_of(bands)
        for wire, way in ways.items():  # past the bands in which it neither begins nor ends
            ends = {band_of[way[0][0]], band_of[way[-1][0]]}
            is_cut = wire in self.named and len(ends) > 1
            ways[wire] = way[-1:] if is_cut else [each for each in way if band_of[each[0]] in ends]
        used = {*self.sizes, *(cell for way in ways.values() for cell, _ in way)}
        kept = [[[cell for cell in column if cell in used] for column in band] for band in bands]
        self._place([columns for band in kept if (columns := [*filter(None, band)])], sizes, ways)

    def _place(
        self,
        bands: Sequence[list[list[Cell]]],
        sizes: Mapping[Cell, Size],
        ways: Mapping[Wire, Sequence[End]],
    ) -> None:
        """Give bands their places one below the other, and wires their points."""
        band_of = _bands_of(bands)
        inside: list[list[_Piece]] = [[] for _ in bands]
        leaving: list[dict[_Start, int]] = [{} for _ in bands]  # with the last band that it reaches
        for piece in _pieces(ways.values(), sizes):
            at, last = band_of[piece.left], band_of[piece.right]
            if last == at:
                inside[at].append(piece)
            else:
                start = piece.left, piece.left_offset
                leaving[at][start] = max(last, leaving[at].get(start, 0))
        settled = [
            _settled(band, sizes, within) for band, within in zip(bands, inside, strict=True)
        ]
        leaving = _ranked(leaving, settled)
        tracks = _tracks(leaving)
        indent = max(tracks.values(), default=_BEFORE_HEAD if len(bands) > 1 else 0.0)
        edges: dict[Cell, tuple[float, float]] = {}
        turns: dict[_Start, _Turn] = {}
        tops: dict[Cell, float] = {}
        top = 0.0
        for band, offsets, starts in zip(bands, settled, leaving, strict=True):
            x = indent
            for column in band:
                edge = x + max(sizes[cell].width for cell in column)
                edges |= dict.fromkeys(column, (x, edge))
                x = edge + _BETWEEN_COLUMNS
            tops |= {cell: top + offset for cell, offset in offsets.items()}
            self.height = top + max(offsets[cell] + sizes[cell].height for cell in offsets)
            # in this order they do not cross: the uppermost runs outside, then below all others
            for out, start in zip(range(len(starts), 0, -1), starts, strict=True):
                out_by = out * _BETWEEN_TURNS
                low = self.height + _BETWEEN_CELLS + out_by
                turns[start] = _Turn(edge + out_by, low, indent - tracks[start])
            self.width = max(self.width, edge + len(starts) * _BETWEEN_TURNS)
            top = self.height + 2 * _BETWEEN_CELLS + len(starts) * _BETWEEN_TURNS
        self.corners = {cell: (edges[cell][0], tops[cell]) for cell in self.sizes}
        for wire, way in ways.items():
            points = self.wires[wire] = []
            if wire[0] != way[0]:
                cell, port = way[0]
                x, y = edges[cell][0], tops[cell] + sizes[cell].inputs[port]
                points += [(x - _BEFORE_HEAD, y), (x, y)]
            for (left, port), (right, right_port) in pairwise(way):
                start = left, sizes[left].outputs[port]
                y, end = tops[left] + start[1], tops[right] + sizes[right].inputs[right_port]
                points += [(edges[left][0] + sizes[left].width, y), (edges[left][1], y)]
                if band_of[left] != band_of[right]:
                    points += turns[start].corners(y, end)
                points.append((edges[right][0], end))


_Start = tuple[Cell, float]
"""The last cell of a wire in a band, and how far from its top the wire leaves it."""


def _bands_of(bands: Sequence[list[list[Cell]]]) -> dict[Cell, int]:
    return {cell: at for at, band in enumerate(bands) for column in band for cell in column}


def _ranked(
    leaving: Sequence[Mapping[_Start, int]], settled: Iterable[Mapping[Cell, float]]
) -> list[dict[_Start, int]]:
    """Sort the wires that leave each band: those into the next one first, then from above."""
    ranked = []
    for at, (starts, tops) in enumerate(zip(leaving, settled, strict=True)):
        keys = {start: (last > at + 1, tops[start[0]] + start[1]) for start, last in starts.items()}
        ranked.append({start: starts[start] for start in sorted(starts, key=keys.__getitem__)})
    return ranked


def _tracks(leaving: Sequence[Mapping[_Start, int]]) -> dict[_Start, float]:
    """Return how far left of the boxes each wire runs down to the last band that it reaches.

    It runs outside those that begin below it.
    """
    tracks: dict[_Start, float] = {}
    outermost = [_BEFORE_HEAD] * len(leaving)
    for at in reversed(range(len(leaving))):
        for start, last in leaving[at].items():
            outermost[at] = tracks[start] = max(outermost[at:last]) + _BETWEEN_TURNS
    return tracks


class _Turn(NamedTuple):
    """How a wire runs from the end of a band to the begin of one below."""

    right: float
    low: float
    left: float

    def corners(self, start: float, end: float) -> list[Point]:
        """Return the points at which it turns, if it begins and ends at these heights."""
        right, low, left = self
        return [(right, start), (right, low), (left, low), (left, end)]


def _bands(
    ordered: Iterable[list[Cell]],
    sizes: Mapping[Cell, Size],
    pieces: Iterable[_Piece],
    widest: float,
) -> list[list[list[Cell]]]:
    """Return columns in as few bands as fit, of like widths, cut where few wires cross."""
    columns = [*filter(None, ordered)]
    depths = {cell: depth for depth, column in enumerate(columns) for cell in column}
    begins = {(piece.left, piece.left_offset) for piece in pieces}
    crossing = Counter(depths[cell] + 1 for cell, _ in begins)
    widths = [max(sizes[cell].width for cell in column) for column in columns]
    best: list[tuple[int, float, int]] = [(0, 0.0, 0)]
    for end in range(1, len(columns) + 1):
        options = []
        wide = -_BETWEEN_COLUMNS
        for start in reversed(range(end)):
            wide += widths[start] + _BETWEEN_COLUMNS
            if wide > widest and start < end - 1:
                break
            bands, cost, _ = best[start]
            cost += (wide / widest) ** 2 + _TURN * crossing[start]
            options.append((bands + 1, cost, start))
        best.append(min(options))
    found: list[list[list[Cell]]] = []
    end = len(columns)
    while end:
        start = best[end][2]
        found.insert(0, columns[start:end])
        end = start
    return found


def _depths(cells: Iterable[Cell], wires: Iterable[Wire]) -> dict[Cell, int]:
    """Return the column of each cell: after its sources, and no earlier than its readers need."""
    network: nx.DiGraph[Cell] = nx.DiGraph()
    cells = tuple(cells)
    inner = [cell for cell in cells if cell[0] not in ("entry", "exit")]
    network.add_nodes_from(inner)
    links = ((source, target) for (source, _), (target, _) in wires)
    network.add_edges_from(link for link in links if link[0] in network and link[1] in network)
    depths = {
        cell: depth
        for depth, generation in enumerate(nx.topological_generations(network), 1)
        for cell in generation
    }
    last = max(depths.values(), default=0) + 1
    for cell in reversed(depths):
        # with fewer readers than sources, a later cell would make more wires longer than shorter
        if network.out_degree(cell) >= max(1, network.in_degree(cell)):
            depths[cell] = min(depths[reader] for reader in network.succ[cell]) - 1
    return {cell: {"entry": 0, "exit": last}.get(cell[0], depths.get(cell, 0)) for cell in cells}


class _Piece(NamedTuple):
    """A piece of a wire between neighbouring columns, with the heights of its ends in the cells."""

    left: Cell
    left_offset: float
    right: Cell
    right_offset: float

    def drop(self, tops: Mapping[Cell, float]) -> float:
        """Return how far the right end is below the left one."""
        return tops[self.right] + self.right_offset - tops[self.left] - self.left_offset


def _pieces(ways: Iterable[Sequence[End]], sizes: Mapping[Cell, Size]) -> list[_Piece]:
    return [
        _Piece(left, sizes[left].outputs[port], right, sizes[right].inputs[right_port])
        for (left, port), (right, right_port) in dict.fromkeys(
            piece for way in ways for piece in pairwise(way)
        )
    ]


def _stack(column: Sequence[Cell], sizes: Mapping[Cell, Size], tops: dict[Cell, float]) -> None:
    y = 0.0
    for cell in column:
        tops[cell] = y
        y += sizes[cell].height + _BETWEEN_CELLS


def _ordered(
    columns: list[list[Cell]], sizes: Mapping[Cell, Size], pieces: Iterable[_Piece]
) -> list[list[Cell]]:
    """Sort each column by the barycentres of its neighbours, and keep the order that crosses least.

    Sweeps go to the right and to the left in turn.
    """
    depths = {cell: depth for depth, column in enumerate(columns) for cell in column}
    gaps: list[list[_Piece]] = [[] for _ in columns]
    sides: tuple[dict[Cell, list[tuple[Cell, float]]], ...] = ({}, {})
    for piece in pieces:
        gaps[depths[piece.left]].append(piece)
        sides[0].setdefault(piece.right, []).append((piece.left, piece.left_offset))
        sides[1].setdefault(piece.left, []).append((piece.right, piece.right_offset))
    tops: dict[Cell, float] = {}
    for column in columns:
        _stack(column, sizes, tops)
    best, fewest = [list(column) for column in columns], _crossings(gaps, tops)
    still = 0
    for sweep in range(_SWEEPS):
        near = sides[sweep % 2]
        before = [list(column) for column in columns]
        for column in reversed(columns) if sweep % 2 else columns:
            means = {
                cell: sum(tops[other] + offset for other, offset in near[cell]) / len(near[cell])
                for cell in column
                if cell in near
            }
            ranked = iter(sorted(means, key=means.__getitem__))
            column[:] = [next(ranked) if cell in means else cell for cell in column]
            _stack(column, sizes, tops)
        still = still + 1 if columns == before else 0
        if still == 2:  # neither direction moves anything
            break
        count = _crossings(gaps, tops)
        if count < fewest:
            best, fewest = [list(column) for column in columns], count
    return best


def _crossings(gaps: Iterable[Iterable[_Piece]], tops: Mapping[Cell, float]) -> int:
    count = 0
    for gap in gaps:
        seen: list[float] = []
        for _, right in sorted(
            (tops[piece.left] + piece.left_offset, tops[piece.right] + piece.right_offset)
            for piece in gap
        ):
            count += len(seen) - bisect_right(seen, right)
            insort(seen, right)
    return count


def _settled(
    columns: list[list[Cell]], sizes: Mapping[Cell, Size], pieces: Iterable[_Piece]
) -> dict[Cell, float]:
    """Return the tops of all cells, so that wires are as level as they can be."""
    tops: dict[Cell, float] = {}
    for column in columns:
        _stack(column, sizes, tops)
    # numbers in place of cells, whose names are hashed anew at each look
    numbers = {cell: at for at, cell in enumerate(tops)}
    heights = list(tops.values())
    near: list[list[tuple[float, float, int]]] = [[] for _ in heights]
    for piece in pieces:
        weight = 1.0 if "bend" in (piece.left[0], piece.right[0]) else _DIRECT
        level = piece.left_offset - piece.right_offset
        left, right = numbers[piece.left], numbers[piece.right]
        near[right].append((weight, level, left))
        near[left].append((weight, -level, right))
    weights = [sum([weight for weight, _, _ in each]) for each in near]
    stacks = []
    for column in columns:
        steps = accumulate((_step(*pair, sizes) for pair in pairwise(column)), initial=0.0)
        stacks.append(([numbers[cell] for cell in column], [*steps][: len(column)]))
    for sweep in range(4 * _SWEEPS):
        moved = 0.0
        for cells, offsets in reversed(stacks) if sweep % 2 else stacks:
            wanted = []
            for cell in cells:
                weight = weights[cell]
                mean = 0.0
                for part, level, other in near[cell]:
                    mean += part * (heights[other] + level)
                wanted.append((weight, mean / weight) if weight else (0.01, heights[cell]))
            for cell, top in zip(cells, _apart(offsets, wanted), strict=True):
                moved = max(moved, abs(top - heights[cell]))
                heights[cell] = top
        if moved < _STILL:
            break
    tops = dict(zip(tops, heights, strict=True))
    _straighten(columns, sizes, pieces, tops)
    least = min(tops.values(), default=0.0)
    return {cell: top - least for cell, top in tops.items()}


_Row = list[tuple[Cell, float]]
"""Cells that would stand level, each with how far its top is below that of the first."""


def _straighten(
    columns: Sequence[Sequence[Cell]],
    sizes: Mapping[Cell, Size],
    pieces: Iterable[_Piece],
    tops: dict[Cell, float],
) -> None:
    """Make wires level where the cells above and below leave room for it."""
    room: dict[Cell, tuple[Cell | None, Cell | None]] = {}
    for column in columns:
        room |= zip(column, zip([None, *column], [*column[1:], None], strict=False), strict=False)

    def settle(run: _Row, least: float, most: float) -> None:
        mean = sum(tops[cell] - offset for cell, offset in run) / len(run)
        level = min(max(mean, least), most)
        tops.update({cell: level + offset for cell, offset in run})

    rows = _rows(columns, pieces, tops)
    for _ in range(_STRAIGHTENINGS):  # a row that moved may leave room for another
        for row in rows:
            run: _Row = []
            least, most = -inf, inf
            for cell, offset in row:
                above, below = room[cell]
                low = tops[above] + _step(above, cell, sizes) - offset if above else -inf
                high = tops[below] - _step(cell, below, sizes) - offset if below else inf
                if run and max(least, low) > min(most, high):
                    settle(run, least, most)
                    run, least, most = [], -inf, inf
                run.append((cell, offset))
                least, most = max(least, low), min(most, high)
            settle(run, least, most)


def _rows(
    columns: Iterable[Sequence[Cell]], pieces: Iterable[_Piece], tops: Mapping[Cell, float]
) -> list[_Row]:
    """Return all cells in rows: bends of one wire, and what is nearly level with a neighbour."""
    into: dict[Cell, list[_Piece]] = {}
    for piece in pieces:
        into.setdefault(piece.right, []).append(piece)
    rows: list[_Row] = []
    by_end: dict[Cell, _Row] = {}
    for column in columns:
        # a wire goes on in its own row rather than to the box of another
        for cell in sorted(column, key=lambda cell: cell[0] != "bend"):
            near = [
                piece
                for piece in into.get(cell, ())
                if piece.left in by_end
                and (abs(piece.drop(tops)) < _NEARLY_LEVEL or piece.left[0] == cell[0] == "bend")
            ]
            if near:
                piece = min(near, key=lambda piece: abs(piece.drop(tops)))
                row = by_end.pop(piece.left)
                offset = row[-1][1] + piece.left_offset - piece.right_offset
            else:
                row, offset = [], 0.0
                rows.append(row)
            row.append((cell, offset))
            by_end[cell] = row
    return rows


def _step(upper: Cell, lower: Cell, sizes: Mapping[Cell, Size]) -> float:
    return sizes[upper].height + (0.0 if upper[0] == lower[0] == "bend" else _BETWEEN_CELLS)


def _apart(offsets: Sequence[float], wanted: Iterable[tuple[float, float]]) -> list[float]:
    """Return the tops closest to those wanted, in least squares, of cells that stand apart.

    Cells that would overlap form a block at their common mean (pool adjacent violators).

    Parameters
    ----------
    offsets
        How far each cell is below the first when nothing is between them but the least distance.
    wanted
        For each cell a weight and a top.
    """
    blocks: list[tuple[float, float, int]] = []
    for offset, (weight, top) in zip(offsets, wanted, strict=False):
        mean, count = top - offset, 1
        while blocks and blocks[-1][1] >= mean:
            other, before, members = blocks.pop()
            mean = (other * before + weight * mean) / (other + weight)
            weight, count = other + weight, count + members
        blocks.append((weight, mean, count))
    means = [mean for _, mean, count in blocks for _ in range(count)]
    return [mean + offset for mean, offset in zip(means, offsets, strict=False)]


@dataclass(frozen=True, slots=True)
class Layout:
    """Positions of boxes and frames, and the routes of arrows.

    Attributes
    ----------
    boxes : tuple of (Shape, point)
        Each box and its upper left corner, in the picture's order.
    frames : tuple of (Frame, point, (width, height))
        Outer frames first.
    routes : tuple of (sequence of point)
        For each arrow the points between which it runs: straight between points of one height,
        else in a curve that begins and ends level.
    """

    boxes: tuple[tuple[Shape, Point], ...]
    frames: tuple[tuple[Frame, Point, Point], ...]
    routes: tuple[Sequence[Point], ...]
    width: float
    height: float


def layout(picture: Picture) -> Layout:
    """Return the layout of a picture.

    Raises
    ------
    ValueError
        If arrows form a cycle.
    """
    links = tuple(
        [
            _Link(each.source, each.source_port, each.target, each.target_port)
            for each in picture.arrows
        ]
    )
    shapes = _shapes(picture, _drawable_frames(tuple(box.name for box in picture.boxes), links))
    outlines = tuple(
        [
            (
                each.box.name,
                each.width,
                each.height,
                tuple(each.inputs.items()),
                tuple(each.outputs.items()),
            )
            for each in shapes
        ]
    )
    corners, frames, routes, wide, high = _placed(outlines, links)
    return Layout(tuple(zip(shapes, corners, strict=True)), frames, routes, wide, high)


class _Link(NamedTuple):
    source: str
    source_port: str
    target: str
    target_port: str

    @property
    def is_named(self) -> bool:
        """Whether the port at which it ends is named after the output at which it begins."""
        return self.target_port == f"{self.source}.{self.source_port}"


_Heights = tuple[tuple[str, float], ...]
_Outline = tuple[str, float, float, _Heights, _Heights]
"""The name of a box, its width and height, and the heights of its inputs and of its outputs."""

_KEPT = 4
"""Layouts that are kept: a graph is drawn after each of its edits, most of which move nothing."""


@lru_cache(_KEPT)
def _placed(
    outlines: tuple[_Outline, ...], links: tuple[_Link, ...]
) -> tuple[
    tuple[Point, ...],
    tuple[tuple[Frame, Point, Point], ...],
    tuple[Sequence[Point], ...],
    float,
    float,
]:
    """Return the corners of boxes, and the other attributes of `Layout`."""
    frames = _drawable_frames(tuple(name for name, *_ in outlines), links)
    around = {frame[:depth] for frame in frames.values() for depth in range(1, len(frame) + 1)}
    areas = {
        frame: Area() for frame in [(), *sorted(around, key=lambda frame: (len(frame), frame))]
    }
    for name, wide, high, inputs, outputs in outlines:
        areas[frames[name]].sizes["box", name] = Size(wide, high, dict(inputs), dict(outputs))
    ways = [_way(link, frames) for link in links]
    for link, way in zip(links, ways, strict=True):
        if link.is_named and len(way) == 1:
            areas[way[0][0]].named.add(way[0][1])
    for frame, wire in (part for way in ways for part in way):
        areas[frame].wires[wire] = []
        pins = {cell: _BEND for cell, _ in wire if cell[0] in ("entry", "exit")}
        areas[frame].sizes.update(pins)
    for frame in reversed(areas):  # inner frames first
        areas[frame].arrange(inf if frame else _WIDEST)
        if frame:
            areas[frame[:-1]].sizes["frame", frame] = _size_of_frame(frame, areas[frame])
    origins: dict[Frame, Point] = {(): (0.0, 0.0)}
    drawn: list[tuple[Frame, Point, Point]] = []
    for frame in list(areas)[1:]:
        outer = areas[frame[:-1]]
        x, y = _moved(outer.corners["frame", frame], origins[frame[:-1]])
        size = outer.sizes["frame", frame]
        drawn.append((frame, (x, y), (size.width, size.height)))
        origins[frame] = x + PADDING, y + _HEAD
    corners = []
    for name, *_ in outlines:
        frame = frames[name]
        corners.append(_moved(areas[frame].corners["box", name], origins[frame]))
    routes = tuple(
        [_moved(point, origins[frame]) for frame, wire in way for point in areas[frame].wires[wire]]
        for way in ways
    )
    return tuple(corners), tuple(drawn), routes, areas[()].width, areas[()].height


def _shapes(picture: Picture, frames: Mapping[str, Frame]) -> list[Shape]:
    fixed: dict[tuple[str, str], list[str]] = {}
    for arrow in picture.arrows:
        if arrow.fixed:
            fixed.setdefault((arrow.target, arrow.target_port), []).append(arrow.fixed)
    return [
        shape(
            box,
            label_of(box.name, frames[box.name]),
            {socket.name: fixed.get((box.name, socket.name), ()) for socket in box.inputs},
        )
        for box in picture.boxes
    ]


def _way(link: _Link, frames: Mapping[str, Frame]) -> list[tuple[Frame, Wire]]:
    """Return the wires of an arrow: out of the source's frames, and into those of the target."""
    source, target = frames[link.source], frames[link.target]
    same = (a == b for a, b in zip(source, target, strict=False))
    common = sum(takewhile(bool, same))
    line = (link.source, link.source_port)  # which all arrows that leave this port share

    def begin(depth: int) -> End:
        if depth == len(source):
            return ("box", link.source), link.source_port
        return ("frame", source[: depth + 1]), line

    def end(depth: int) -> End:
        if depth == len(target):
            return ("box", link.target), link.target_port
        return ("frame", target[: depth + 1]), line

    outwards = range(len(source), common, -1)
    inwards = range(common + 1, len(target) + 1)
    return [
        *((source[:depth], (begin(depth), (("exit", line), ""))) for depth in outwards),
        (source[:common], (begin(common), end(common))),
        *((target[:depth], ((("entry", line), ""), end(depth))) for depth in inwards),
    ]


def _size_of_frame(frame: Frame, area: Area) -> Size:
    crossed: dict[str, dict[Hashable, float]] = {"entry": {}, "exit": {}}
    for (kind, line), (_, top) in area.corners.items():
        if kind in crossed:
            crossed[kind][line] = top + _HEAD + _BEND.height / 2
    label = width(shortened(frame[-1]), LABEL_SIZE, bold=True)
    wide = max(area.width, label) + 2 * PADDING
    return Size(wide, area.height + _HEAD + PADDING, crossed["entry"], crossed["exit"])


def _moved(point: Point, by: Point) -> Point:
    return point[0] + by[0], point[1] + by[1]


@lru_cache(_KEPT)
def _drawable_frames(names: tuple[str, ...], links: tuple[_Link, ...]) -> dict[str, Frame]:
    """Return the frames around boxes, without those that arrows leave and enter again.

    Such a frame could stand neither left nor right of what the arrows pass on the way.
    """
    whole = nx.DiGraph([(link.source, link.target) for link in links])
    if not nx.is_directed_acyclic_graph(whole):
        cycle = [source for source, _ in nx.find_cycle(whole)]
        raise ValueError(f"arrows form a cycle: {' -> '.join([*cycle, cycle[0]])}")
    frames = frames_of(names)
    while True:
        cells: dict[Frame, nx.DiGraph[Cell]] = {}
        for link in links:
            for frame, ((source, _), (target, _)) in _way(link, frames):
                cells.setdefault(frame, nx.DiGraph()).add_edge(source, target)
        cyclic: set[Cell] = {
            cell
            for network in cells.values()
            for component in nx.strongly_connected_components(network)
            if len(component) > 1
            for cell in component
        }
        if not cyclic:
            return frames
        for name, path in frames.items():
            around = (path[:depth] for depth in range(1, len(path) + 1))
            left = next((frame for frame in around if ("frame", frame) in cyclic), None)
            frames[name] = left[:-1] if left else path

"""Layered layout from left to right: boxes in columns, frames around boxes, points of arrows.

After K. Sugiyama et al. (1981), IEEE Trans. Systems, Man, and Cybernetics 11(2), 109-125: a cell
stands in a column after its sources, the barycentres of its neighbours order each column, and a
wire over several columns takes a place in each of them. The contents of a frame are laid out by
themselves; outside, the frame is one cell, whose edge wires cross at the same heights. Columns
that are wider than a page together stand in bands, like lines of text. Arrows of one output run
to the next band; of any other, and of what passes boxes to a side input or a row, the end says
where it begins: long lines around the boxes cannot be followed. What the report lists stands below
all bands.
"""

from __future__ import annotations

from bisect import bisect_right, insort
from collections import Counter, defaultdict
from collections.abc import Collection, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache, partial
from itertools import islice, pairwise, starmap, takewhile
from typing import NamedTuple

import networkx as nx

from nodegraph.draw.boxes import Notes, Shape, panel, row_port, shape, shortened, width
from nodegraph.draw.frames import Frame, frames_of, label_of
from nodegraph.draw.picture import Arrow, Picture, network_of, origins

Point = tuple[float, float]
Cell = tuple[str, Hashable]
"""A cell of a frame: ``("box", name)``, ``("frame", its names)``, or the bend of a wire."""
End = tuple[Cell, Hashable]
"""A cell, and one of its ports."""
Wire = tuple[End, End]
_Heights = tuple[tuple[Hashable, float], ...]

LABEL_SIZE = 13.0
LEAST_WIDTH = 500.0
"""Of the panel and the legend, though the drawing is narrower."""
LABEL_HEIGHT = 26.0
PADDING = 16.0
_HEAD = LABEL_HEIGHT + PADDING / 2
_BETWEEN_CELLS = 22.0
_BETWEEN_COLUMNS = 30.0
_LANE = 7.0
_TIP = 7.0
"""Length of the level end of a wire under its arrow head."""
_STEEP = 12.0
_MOST_IN_LANES = 24
"""Pieces of wires between two columns that can be told apart."""
_BEFORE = 13.0
_AFTER = 14.0
"""Room before and after a box, for arrows from one band to the next."""
_BAND = 0.9
_CUT = 0.06
"""Cost of a reader in another band, and half of that of an output; a full band costs 1 besides."""
_WIDEST = 890.0
"""Width of a drawing whose smallest text has more than 8 pixels on a page of 720."""
_CHOICES = 3
"""Choices of bands: ports that say where cut arrows begin and end make boxes wider."""
_SWEEPS = 16


class Size(NamedTuple):
    """Size of a cell, and how far from its top the wires of each port end or begin.

    Before and after it is room for arrows between bands.
    """

    width: float
    height: float
    inputs: _Heights
    outputs: _Heights
    before: float = 0.0
    after: float = 0.0


_BEND = Size(0.0, 12.0, (("", 6.0),), (("", 6.0),))


@dataclass(slots=True)
class Area:
    """The inside of a frame, or the whole drawing.

    Attributes
    ----------
    sizes : dict of cell to Size
        Cells called ``entry`` and ``exit`` stand left and right of all others.
    wires : dict of wire to (list of point)
        They form no cycle. `arrange` fills in the points between which a wire runs.
    corners : dict of cell to point
        Upper left corners, from `arrange`.
    """

    sizes: dict[Cell, Size] = field(default_factory=dict)
    wires: dict[Wire, list[Point]] = field(default_factory=dict)
    corners: dict[Cell, Point] = field(default_factory=dict)
    width: float = 0.0
    height: float = 0.0

    def arrange(self) -> None:
        """Find a place for every cell and a way for every wire."""
        depths = _depths(self.sizes, self.wires)
        columns: list[list[Cell]] = [[] for _ in range(max(depths.values(), default=-1) + 1)]
        for cell in self.sizes:
            columns[depths[cell]].append(cell)
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
        ends = dict.fromkeys(piece for way in ways.values() for piece in pairwise(way))
        pieces = [_piece(sizes, *each) for each in ends]
        ordered = _ordered([*filter(None, columns)], sizes, pieces)
        tops = _settled(ordered, sizes, pieces)
        lanes = [_lanes(gap, tops) for gap in _gaps(ordered, pieces)]
        lane_of = {piece: lane for gap in lanes for piece, lane in gap.items()}
        edges: dict[Cell, tuple[float, float]] = {}
        spare: dict[Cell, float] = {}
        before: dict[Cell, float] = {}
        x = 0.0
        for column, gap in zip(ordered, lanes, strict=True):
            room = max(sizes[cell].before for cell in column)
            reach = x + room + max(sizes[cell].width for cell in column)
            edges |= dict.fromkeys(column, (x + room, reach))
            before |= dict.fromkeys(column, room)
            spare |= dict.fromkeys(column, _LANE * max(gap.values(), default=0))
            self.width = reach + max(sizes[cell].after for cell in column)
            x = self.width + _BETWEEN_COLUMNS + spare[column[0]]
        self.height = max((tops[cell] + sizes[cell].height for cell in tops), default=0.0)
        self.corners = {cell: (edges[cell][0], tops[cell]) for cell in self.sizes}
        for wire, way in ways.items():
            points = self.wires[wire] = []
            for piece in starmap(partial(_piece, sizes), pairwise(way)):
                left, right = piece.left, piece.right
                y, end = tops[left] + piece.left_offset, tops[right] + piece.right_offset
                shift = _LANE * lane_of.get(piece, 0)
                points += [(edges[left][0] + sizes[left].width, y), (edges[left][1] + shift, y)]
                x = edges[right][0]
                turned = x - before[right] - spare[left] + shift - _TIP
                points += [(turned, end), (x, end)]


def _parts(area: Area) -> list[list[Cell]]:
    """Return the parts of several cells that share only what they begin and end with.

    A beginning stands with the first part that reads it, an end with the last that it reads.
    """
    net: nx.DiGraph[Cell] = nx.DiGraph()
    net.add_nodes_from(area.sizes)
    net.add_edges_from((source, target) for (source, _), (target, _) in area.wires)
    between = {cell: at for at, cell in enumerate(net) if net.pred[cell] and net.succ[cell]}
    linked = nx.weakly_connected_components(net.subgraph(between))
    several = [part for part in linked if len({*part}.union(*map(net.succ.__getitem__, part))) > 1]
    several.sort(key=lambda part: min(map(between.__getitem__, part)))
    part_of = {cell: at for at, part in enumerate(several) for cell in part}

    def part(cell: Cell) -> int:
        after = [part_of[reader] for reader in net.succ[cell] if reader in part_of]
        before = {part_of[source] for source in net.pred[cell] if source in part_of}
        return min(after, default=max(before, default=0))

    parts: list[list[Cell]] = [[] for _ in range(max(len(several), 1))]
    for cell in area.sizes:
        parts[part_of[cell] if cell in part_of else part(cell)].append(cell)
    return parts


def _bands_of(area: Area, part: Iterable[Cell]) -> _Bands:
    """Return the bands of one part."""
    sizes = {cell: area.sizes[cell] for cell in part}
    wires = [wire for wire in area.wires if wire[0][0] in sizes and wire[1][0] in sizes]
    depths = _depths(sizes, wires)
    ranks = {depth: rank for rank, depth in enumerate(sorted({*depths.values()}))}
    depths = {cell: ranks[depth] for cell, depth in depths.items()}
    columns = ([cell for cell in depths if depths[cell] == rank] for rank in ranks.values())
    widths = [max(sizes[cell].width for cell in column) for column in columns]
    by_output: dict[End, list[int]] = {}
    for begin, (target, port) in wires:
        if not _is_side((target, port), sizes) or depths[target] == depths[begin[0]] + 1:
            by_output.setdefault(begin, []).append(depths[target])
    outputs: list[list[list[int]]] = [[] for _ in widths]
    for (cell, _), readers in by_output.items():
        outputs[depths[cell]].append(readers)
    best: list[tuple[float, int]] = [(0.0, 0)]
    for end in range(1, len(widths) + 1):
        options = []
        wide, cut = -_BETWEEN_COLUMNS, 0
        for start in reversed(range(end)):
            wide += widths[start] + _BETWEEN_COLUMNS
            beyond = (sum(at >= end for at in readers) for readers in outputs[start])
            cut += sum(2 + count for count in beyond if count)
            if wide > _WIDEST and start < end - 1:
                break
            cost = best[start][0] + _BAND + (wide / _WIDEST) ** 3 + _CUT * cut
            options.append((cost, start))
        best.append(min(options))
    starts: list[int] = []
    end = len(widths)
    while end:
        end = best[end][1]
        starts.insert(0, end)
    return {cell: bisect_right(starts, depth) - 1 for cell, depth in depths.items()}


def _depths(cells: Iterable[Cell], wires: Collection[Wire]) -> dict[Cell, int]:
    """Return the column of each cell: after its sources, and no earlier than its readers need.

    Those without a wire stand after all others, each in a column.
    """
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
        if not network.degree(cell):
            depths[cell] = last
        # with fewer readers than sources, a later cell would make more wires longer than shorter
        elif network.out_degree(cell) >= max(1, network.in_degree(cell)):
            depths[cell] = min(depths[reader] for reader in network.succ[cell]) - 1
    wired = {cell for wire in wires for cell, _ in wire}
    depths |= {cell: at for at, cell in enumerate((c for c in inner if c not in wired), last)}
    ends = {"entry": 0, "exit": max(depths.values(), default=last) + 1}
    return {cell: ends.get(cell[0], depths.get(cell, 0)) for cell in cells}


class _Piece(NamedTuple):
    """A piece of a wire between neighbouring columns, with the heights of its ends in the cells."""

    left: Cell
    left_offset: float
    right: Cell
    right_offset: float


def _piece(sizes: Mapping[Cell, Size], begin: End, end: End) -> _Piece:
    (left, port), (right, right_port) = begin, end
    begins, ends = dict(sizes[left].outputs), dict(sizes[right].inputs)
    return _Piece(left, begins[port], right, ends[right_port])


def _gaps(columns: Iterable[Iterable[Cell]], pieces: Iterable[_Piece]) -> list[list[_Piece]]:
    """Return the pieces that begin at each column."""
    depths = {cell: depth for depth, column in enumerate(columns) for cell in column}
    gaps: list[list[_Piece]] = [[] for _ in range(max(depths.values(), default=-1) + 1)]
    for piece in pieces:
        gaps[depths[piece.left]].append(piece)
    return gaps


def _lanes(gap: Sequence[_Piece], tops: Mapping[Cell, float]) -> dict[_Piece, int]:
    """Return the lane in which each piece goes up or down, so that none lies over another.

    Pieces that begin or end together may share one.
    """
    lanes: dict[_Piece, int] = {}
    if len(gap) > _MOST_IN_LANES:
        return lanes
    begins = {piece: tops[piece.left] + piece.left_offset for piece in gap}
    ends = {piece: tops[piece.right] + piece.right_offset for piece in gap}
    falls = {piece: fall for piece in gap if abs(fall := ends[piece] - begins[piece]) > _STEEP}

    def turn(piece: _Piece) -> tuple[bool, float]:
        """Of wires that go down the upper one turns last, of those that go up the lower one."""
        is_down = falls[piece] > 0.0
        return is_down, -begins[piece] if is_down else begins[piece]

    for piece in sorted(falls, key=turn):
        beside: dict[bool, set[int]] = {True: set(), False: set()}
        for other, lane in lanes.items():
            far = abs(2.0 * (begins[piece] - begins[other]) + falls[piece] - falls[other])
            is_apart = far >= abs(falls[piece]) + abs(falls[other])
            if not is_apart and piece[:2] != other[:2] and piece[2:] != other[2:]:
                beside[(falls[piece] > 0.0) == (falls[other] > 0.0)].add(lane)
        lane = max(beside[True], default=-1) + 1
        while lane in beside[False]:
            lane += 1
        lanes[piece] = lane
    return lanes


def _stack(column: Sequence[Cell], sizes: Mapping[Cell, Size], tops: dict[Cell, float]) -> None:
    y = 0.0
    for cell in column:
        tops[cell] = y
        y += sizes[cell].height + _BETWEEN_CELLS


def _ordered(
    columns: list[list[Cell]], sizes: Mapping[Cell, Size], pieces: Sequence[_Piece]
) -> list[list[Cell]]:
    """Sort each column by the barycentres of its neighbours, and keep the order that crosses least.

    Sweeps go to the right and to the left in turn.
    """
    sides: tuple[dict[Cell, list[tuple[Cell, float]]], ...] = ({}, {})
    for piece in pieces:
        sides[0].setdefault(piece.right, []).append((piece.left, piece.left_offset))
        sides[1].setdefault(piece.left, []).append((piece.right, piece.right_offset))
    gaps = _gaps(columns, pieces)
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
    columns: Sequence[Sequence[Cell]], sizes: Mapping[Cell, Size], pieces: Sequence[_Piece]
) -> dict[Cell, float]:
    """Return the tops of all cells, level with those of their upper neighbours where they can be.

    Bends of one wire are level with each other.
    """
    tops: dict[Cell, float] = {}
    for column in columns:
        _stack(column, sizes, tops)
    direct = [piece for piece in pieces if piece.left[0] != "bend" != piece.right[0]]
    after = {
        piece.left: piece.right for piece in sorted(direct, key=lambda each: -tops[each.right])
    }
    before = {
        piece.right: piece.left for piece in sorted(direct, key=lambda each: -tops[each.left])
    }
    level: dict[Cell, list[Cell]] = {cell: [] for cell in tops}
    for left, _, right, _ in pieces:
        if left[0] == right[0] == "bend" or (after.get(left), before.get(right)) == (right, left):
            level[left].append(right)
            level[right].append(left)
    tops = dict.fromkeys(tops, 0.0)
    for sweep in range(_SWEEPS):
        settled = dict(tops)
        for column in reversed(columns) if sweep % 2 else columns:
            above: list[Cell] = []
            for cell in column:
                least = [tops[each] + _step(each, cell, sizes) for each in above]
                tops[cell] = max([tops[cell], *least, *map(tops.__getitem__, level[cell])])
                above = [cell]
        if tops == settled:
            break
    return tops


def _step(upper: Cell, lower: Cell, sizes: Mapping[Cell, Size]) -> float:
    return sizes[upper].height + (0.0 if upper[0] == lower[0] == "bend" else _BETWEEN_CELLS)


def layout(
    picture: Picture, *, states: bool = False
) -> tuple[Sequence[Shape], Placed, Sequence[Sequence[Sequence[Point]]]]:
    """Return the shapes of the boxes of a picture, where they stand, and the lines of each arrow.

    Of a line these are the points between which it runs: straight between points of one height,
    else in a curve that begins and ends level. An arrow whose target names its source has none.

    Parameters
    ----------
    picture
    states
        Whether rows of alternatives have room for their states in a run.

    Raises
    ------
    ValueError
        If arrows form a cycle.
    """
    links_of = _links_of(picture)
    links = tuple([link for each in links_of for link in each])
    frames = _drawable_frames(tuple([box.name for box in picture.boxes if not box.is_list]), links)
    cut = {arrow for arrow, own in zip(picture.arrows, links_of, strict=True) if not own}
    led: frozenset[_Link] = frozenset()
    shapes = _shapes(picture, frames, cut, states=states)
    for _ in range(_CHOICES):
        first = _sizes(shapes, led)
        (bands, passing), before = _bands(first, links), cut
        led = _led(picture, links_of, frames, bands)
        cut = {
            arrow
            for arrow, own in zip(picture.arrows, links_of, strict=True)
            if not own or own[0] in passing or (_steps(own[0], frames, bands) and own[0] not in led)
        }
        shapes = _shapes(picture, frames, cut, states=states)
        if cut == before:
            break
    placed = _placed(first, _sizes(shapes, led), links, led)
    for box in picture.boxes:
        if box.is_list:
            wide, top = max(placed.width, LEAST_WIDTH), placed.height + _BETWEEN_CELLS
            shapes.append(panel(box, "In the report", _notes(picture, cut)[box.name][1], wide))
            corners = (*placed.corners, (0.0, top))
            high = top + shapes[-1].height
            placed = placed._replace(corners=corners, width=wide, height=high)
    each_line = iter(placed.lines)
    return shapes, placed, [[*filter(None, islice(each_line, len(own)))] for own in links_of]


def _sizes(shapes: Iterable[Shape], led: Collection[_Link]) -> _Sizes:
    before = {link.target for link in led}
    after = {link.source for link in led}
    return tuple(
        [
            (
                each.box.name,
                Size(
                    each.width,
                    each.height,
                    tuple(each.inputs.items()),
                    tuple(each.outputs.items()),
                    (_BEFORE + 2.0 * _LANE) * (each.box.name in before),
                    (_AFTER + _LANE) * (each.box.name in after),
                ),
            )
            for each in shapes
        ]
    )


class _Link(NamedTuple):
    source: str
    source_port: str
    target: str
    target_port: str


def _links_of(picture: Picture) -> list[list[_Link]]:
    """Return the links of each arrow: to the rows that name its source, else to its port.

    What is listed below the boxes names its sources.
    """
    into = Counter((arrow.target, arrow.target_port) for arrow in picture.arrows)
    rows = {box.name: box.alternatives for box in picture.boxes}
    lists = {box.name for box in picture.boxes if box.is_list}

    def ends(arrow: Arrow, origin: str) -> list[str]:
        end = arrow.target, arrow.target_port
        if arrow.target in lists:
            return []
        named = [row_port(row) for row in rows[arrow.target] if origin in row.source.split(", ")]
        return named if into[end] > 1 and named else [arrow.target_port]

    return [
        [_Link(arrow.source, arrow.source_port, arrow.target, port) for port in ends(arrow, origin)]
        for arrow, origin in zip(picture.arrows, origins(picture), strict=True)
    ]


_Bands = dict[Cell, int]
"""The band of each cell outside all frames."""

_Sizes = tuple[tuple[str, Size], ...]
"""The size of each box."""

_KEPT = 8
"""Layouts that are kept: a graph is drawn after each of its edits, most of which move nothing."""


@lru_cache(_KEPT)
def _bands(sizes: _Sizes, links: tuple[_Link, ...]) -> tuple[_Bands, frozenset[_Link]]:
    """Return the band of each cell, and the links in a band that pass boxes to a side input.

    There are as few bands as fit, of like widths, cut where few arrows go on. Parts of the graph
    that share only what they begin or end with stand one below the other.
    """
    frames = _drawable_frames(tuple([name for name, _ in sizes]), links)
    ways = {link: _way(link, frames) for link in links}
    area = _framed(sizes, frames, ways.values())[()]
    wired = {cell for wire in area.wires for cell, _ in wire}
    linked = Area({cell: area.sizes[cell] for cell in area.sizes if cell in wired}, area.wires)
    bands = _bands_of(linked, linked.sizes)
    if max(bands.values(), default=0) and len(parts := _parts(linked)) > 1:
        first = 0
        for part in parts:
            bands |= {cell: first + band for cell, band in _bands_of(area, part).items()}
            first = max(bands[cell] for cell in part) + 1
    _fill(bands, area)
    inside = [wire for wire in area.wires if bands[wire[0][0]] == bands[wire[1][0]]]
    depths = _depths(area.sizes, inside)
    passing = {
        (begin, end)
        for begin, end in inside
        if _is_side(end, area.sizes) and depths[end[0]] > depths[begin[0]] + 1
    }
    return bands, frozenset(link for link, way in ways.items() if passing & {w for _, w in way})


def _fill(bands: _Bands, area: Area) -> None:
    """Give each cell that is in no band the first one with room."""
    depths = _depths(area.sizes, area.wires)
    columns: defaultdict[tuple[int, int], float] = defaultdict(float)
    for cell, band in bands.items():
        columns[band, depths[cell]] = max(columns[band, depths[cell]], area.sizes[cell].width)
    reach: defaultdict[int, float] = defaultdict(float)
    for (band, _), wide in columns.items():
        reach[band] += wide + _BETWEEN_COLUMNS
    for cell, size in area.sizes.items():
        if cell not in bands:
            room = _WIDEST - size.width
            band = next(
                band for band in range(len(area.sizes)) if band not in reach or reach[band] <= room
            )
            bands[cell] = band
            reach[band] += size.width + _BETWEEN_COLUMNS


class Placed(NamedTuple):
    """Corners of boxes, frames with corner and size, outer ones first, and lines of all links."""

    corners: tuple[Point, ...]
    frames: tuple[tuple[Frame, Point, Point], ...]
    lines: tuple[Sequence[Point], ...]
    width: float
    height: float


@lru_cache(_KEPT)
def _placed(
    first: _Sizes, sizes: _Sizes, links: tuple[_Link, ...], led: frozenset[_Link]
) -> Placed:
    """Place boxes in the bands that first sizes give, and arrows, some led to the next band.

    What passes boxes is not drawn.
    """
    frames = _drawable_frames(tuple([name for name, _ in sizes]), links)
    bands, passing = _bands(first, links)
    ways = {
        link: _way(link, frames)
        for link in links
        if link not in passing and not _steps(link, frames, bands)
    }
    areas = _framed(sizes, frames, ways.values())
    outputs_led = dict.fromkeys((bands["box", link.target], *link[:2]) for link in led)
    count = Counter(band for band, *_ in outputs_led)
    gaps = _stack_bands(areas[()], bands, count)
    origins: dict[Frame, Point] = {(): (0.0, 0.0)}
    drawn: list[tuple[Frame, Point, Point]] = []
    for frame in list(areas)[1:]:
        outer = areas[frame[:-1]]
        x, y = _moved(outer.corners["frame", frame], origins[frame[:-1]])
        size = outer.sizes["frame", frame]
        drawn.append((frame, (x, y), (size.width, size.height)))
        origins[frame] = x + PADDING, y + _HEAD
    corners = {
        name: _moved(areas[frame].corners["box", name], origins[frame])
        for name, frame in frames.items()
    }
    size_of = dict(sizes)

    # how far to the right an output's line goes down, and from how far up
    rooms = {
        (band, name, port): (
            _free(areas[()], bands, ("box", name)),
            -corners[name][1] - dict(size_of[name].outputs)[port],
        )
        for band, name, port in outputs_led
    }
    lanes: dict[tuple[int, str, str], tuple[int, float]] = {}
    reach: dict[int, float] = {}
    for output in sorted(rooms, key=rooms.__getitem__):
        band, *_ = output
        reach[band] = max(reach.get(band, 0.0) + _LANE, rooms[output][0] + _AFTER)
        lanes[output] = count[band], reach[band]
        count[band] -= 1

    def line(link: _Link) -> list[Point]:
        if link in ways:
            return [
                _moved(point, origins[frame])
                for frame, wire in ways[link]
                for point in areas[frame].wires[wire]
            ]
        if link not in led:
            return []
        end = dict(size_of[link.target].inputs)[link.target_port]
        x, y = _moved(corners[link.target], (0.0, end))
        band = bands["box", link.target]
        lane, right = lanes[band, *link[:2]]
        between = gaps[band] - _BETWEEN_CELLS - _LANE * (lane - 1)
        left = x - _BEFORE - _LANE * lane
        source = size_of[link.source]
        height = dict(source.outputs)[link.source_port]
        begin = _moved(corners[link.source], (source.width, height))
        turns = [(right, begin[1]), (right, between), (left, between), (left, y)]
        return [begin, *turns, (x, y)]

    lines = tuple([line(link) for link in links])
    wide = max([areas[()].width, *(x for points in lines for x, _ in points)])
    high = areas[()].height
    return Placed(tuple(corners.values()), tuple(drawn), lines, wide, high)


def _framed(
    sizes: _Sizes, frames: Mapping[str, Frame], ways: Iterable[Sequence[tuple[Frame, Wire]]]
) -> dict[Frame, Area]:
    """Return the areas of all frames, outer ones first; those inside a frame are arranged."""
    around = {frame[:depth] for frame in frames.values() for depth in range(1, len(frame) + 1)}
    areas = {
        frame: Area() for frame in [(), *sorted(around, key=lambda frame: (len(frame), frame))]
    }
    for name, size in sizes:
        areas[frames[name]].sizes["box", name] = size
    for frame, wire in (part for way in ways for part in way):
        areas[frame].wires[wire] = []
        pins = {cell: _BEND for cell, _ in wire if cell[0] in ("entry", "exit")}
        areas[frame].sizes.update(pins)
    for frame in [*areas][:0:-1]:  # inner frames first
        areas[frame].arrange()
        areas[frame[:-1]].sizes["frame", frame] = _size_of_frame(frame, areas[frame])
    return areas


def _stack_bands(area: Area, band_of: _Bands, led: Mapping[int, int]) -> list[float]:
    """Arrange each band by itself, one below the other, and return where each begins.

    Above it are lanes for arrows that are led to it.
    """
    bands = [Area() for _ in range(max(band_of.values(), default=-1) + 1)]
    for cell, size in area.sizes.items():
        bands[band_of[cell]].sizes[cell] = size
    for wire in area.wires:
        bands[band_of[wire[0][0]]].wires[wire] = []
    for band in bands:
        band.arrange()
    lefts = [min([x for x, _ in band.corners.values()], default=0.0) for band in bands]
    top, tops = 0.0, []
    for number, (band, left) in enumerate(zip(bands, lefts, strict=True)):
        top += _LANE * led[number]
        tops.append(top)
        by = max(lefts) - left, top
        area.corners |= {cell: _moved(corner, by) for cell, corner in band.corners.items()}
        for wire, points in band.wires.items():
            area.wires[wire] = [_moved(point, by) for point in points]
        area.width = max(area.width, by[0] + band.width)
        area.height = top + band.height
        top = area.height + 2 * _BETWEEN_CELLS
    return tops


def _free(area: Area, bands: _Bands, source: Cell) -> float:
    """Return where nothing is right of a cell and below it, up to the next band."""
    (x, y), size = area.corners[source], area.sizes[source]
    reach = x + size.width
    beside = {
        cell: corner for cell, corner in area.corners.items() if bands.get(cell) == bands[source]
    }
    for cell, (left, top) in sorted(beside.items(), key=lambda item: item[1]):
        if left < reach + _BETWEEN_COLUMNS and top > y:
            reach = max(reach, left + area.sizes[cell].width)
    return reach


def _steps(link: _Link, frames: Mapping[str, Frame], bands: _Bands) -> int:
    """Return how many bands an arrow goes down."""
    source, target = (
        bands[("frame", frames[name][:1]) if frames[name] else ("box", name)]
        for name in (link.source, link.target)
    )
    return target - source


def _is_side(end: End, sizes: Mapping[Cell, Size]) -> bool:
    """Return whether a wire ends not at the first input of a box, but at another or at a row."""
    cell, port = end
    return isinstance(port, str) and port not in [first for first, _ in sizes[cell].inputs[:1]]


def _led(
    picture: Picture,
    links_of: Iterable[Sequence[_Link]],
    frames: Mapping[str, Frame],
    bands: _Bands,
) -> frozenset[_Link]:
    """Return the links that run from one band to the next: of one output to other boxes.

    It leads to boxes, or to first inputs, to which nothing in their own band does, rather to the
    first input of as many as it can, and from the box that most lead to. No truth is led.
    """
    first = {(box.name, box.inputs[0].name) for box in picture.boxes if box.inputs}
    links = [link for each in links_of for link in each]
    inside = [link for link in links if not _steps(link, frames, bands)]
    reached, ends = {link.target for link in inside}, {link[2:] for link in inside}

    def is_main(link: _Link) -> bool:
        if frames[link.source] or frames[link.target] or _steps(link, frames, bands) != 1:
            return False
        is_first = link[2:] in first and link[2:] not in ends
        return is_first or link.target not in reached

    main: dict[int, dict[tuple[str, str], dict[str, _Link]]] = {}
    for arrow, own in zip(picture.arrows, links_of, strict=True):
        if len(own) == 1 and not arrow.truth and is_main(own[0]):
            (link,) = own
            outputs = main.setdefault(bands["box", link.target], {})
            outputs.setdefault(link[:2], {}).setdefault(link.target, link)

    network = network_of(picture)

    def rank(led: Mapping[str, _Link]) -> tuple[int, int, int]:
        depth = max(len(nx.ancestors(network, link.source)) for link in led.values())
        return sum(link[2:] in first for link in led.values()), len(led), depth

    return frozenset(
        link for outputs in main.values() for link in max(outputs.values(), key=rank).values()
    )


def _shapes(
    picture: Picture, frames: Mapping[str, Frame], cut: Collection[Arrow], *, states: bool
) -> list[Shape]:
    """Return the shapes of the boxes between which arrows run."""
    notes = _notes(picture, cut)
    return [
        shape(box, label_of(box.name, frames[box.name]), *notes[box.name], states=states)
        for box in picture.boxes
        if not box.is_list
    ]


def _notes(picture: Picture, cut: Collection[Arrow]) -> dict[str, tuple[Notes, Notes, Notes]]:
    """Return, for each box, the labels that arrows fix, their sources, and their readers.

    An input says where arrows begin that are not drawn, an output where its arrows end if none of
    them is drawn.
    """
    fixed: dict[str, list[tuple[str, str]]] = {box.name: [] for box in picture.boxes}
    sources: dict[str, list[tuple[str, str]]] = {box.name: [] for box in picture.boxes}
    readers: dict[str, list[tuple[str, str]]] = {box.name: [] for box in picture.boxes}
    into = Counter((arrow.target, arrow.target_port) for arrow in picture.arrows)
    begins = {(arrow.source, arrow.source_port) for arrow in picture.arrows if arrow not in cut}
    said = {
        (box.name, socket.name, each.source)
        for box in picture.boxes
        for socket in box.inputs
        if into[box.name, socket.name] > 1
        for each in box.alternatives
    }
    known = _fixed_before(picture) if any(arrow.fixed for arrow in picture.arrows) else {}
    lists = {box.name for box in picture.boxes if box.is_list}
    order = {box.name: at for at, box in enumerate(picture.boxes)}
    shown = {(box.name, each.name): each.text for box in picture.boxes for each in box.inputs}
    by_source = sorted(
        zip(picture.arrows, origins(picture), strict=True), key=lambda pair: order[pair[0].source]
    )
    for arrow, origin in by_source:
        labels = [
            each for each in arrow.fixed.split(", ") if each not in known.get(arrow.target, "")
        ]
        if any(labels):
            fixed[arrow.target].append((arrow.target_port, ", ".join(labels)))
        if (arrow.source, arrow.source_port) not in begins and arrow.target not in lists:
            readers[arrow.source].append((arrow.source_port, arrow.target))
        end = arrow.target, arrow.target_port
        if arrow in cut and (*end, origin) not in said:
            origin = arrow.source if arrow.source_port == shown[end] else origin
            sources[arrow.target].append((arrow.target_port, origin))
    return {
        name: (tuple(fixed[name]), tuple(sources[name]), tuple(readers[name])) for name in fixed
    }


def _fixed_before(picture: Picture) -> dict[str, set[str]]:
    """Return, for each box, the labels that arrows fix on the way to what it reads."""
    network = network_of(picture)
    own: dict[str, set[str]] = {box.name: set() for box in picture.boxes}
    for arrow in picture.arrows:
        own[arrow.target] |= {*arrow.fixed.split(", ")}
    before: dict[str, set[str]] = {box.name: set() for box in picture.boxes}
    for name in nx.topological_sort(network):
        for source in network.pred[name]:
            before[name] |= before[source] | own[source]
    return before


def _way(link: _Link, frames: Mapping[str, Frame]) -> list[tuple[Frame, Wire]]:
    """Return the wires of an arrow: out of the source's frames, and into those of the target."""
    source, target = frames[link.source], frames[link.target]
    same = (a == b for a, b in zip(source, target, strict=False))
    common = sum(takewhile(bool, same))
    line = (link.source, link.source_port)  # which all arrows that leave this port share

    def end(name: str, port: str, frame: Frame, depth: int) -> End:
        """Return the end of a wire in the box, or at the frame around it, of this depth."""
        if depth == len(frame):
            return ("box", name), port
        return ("frame", frame[: depth + 1]), line

    begin = partial(end, link.source, link.source_port, source)
    end_at = partial(end, link.target, link.target_port, target)
    outwards = range(len(source), common, -1)
    inwards = range(common + 1, len(target) + 1)
    return [
        *((source[:depth], (begin(depth), (("exit", line), ""))) for depth in outwards),
        (source[:common], (begin(common), end_at(common))),
        *((target[:depth], ((("entry", line), ""), end_at(depth))) for depth in inwards),
    ]


def _size_of_frame(frame: Frame, area: Area) -> Size:
    crossed: dict[str, dict[Hashable, float]] = {"entry": {}, "exit": {}}
    for (kind, line), (_, top) in area.corners.items():
        if kind in crossed:
            crossed[kind][line] = top + _HEAD + _BEND.height / 2
    label = width(shortened(frame[-1]), LABEL_SIZE, bold=True)
    wide = max(area.width, label) + 2 * PADDING
    entry, leave = (tuple(heights.items()) for heights in crossed.values())
    return Size(wide, area.height + _HEAD + PADDING, entry, leave)


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

"""Layered layout from left to right: cells in columns, wires between ports on their sides.

After K. Sugiyama et al. (1981), IEEE Trans. Systems, Man, and Cybernetics 11(2), 109-125: a cell
stands in the column after its sources, the order within a column has few crossings, and a wire
over several columns takes a place in each of them. What would be too wide is broken into bands,
as a text is into lines: the columns of all bands stand below each other, and a wire to another
band runs between columns and between bands.
"""

from __future__ import annotations

from bisect import bisect_right, insort
from collections import Counter
from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import ceil, sqrt
from typing import Any

import networkx as nx

Point = tuple[float, float]

_BETWEEN_CELLS = 22.0
_BETWEEN_COLUMNS = 52.0
_BETWEEN_BANDS = 34.0
_LANE = 9.0
# Height of a place that a wire takes in a column.
_BEND = 12.0
# A drawing may be as wide as a page, and wider only in proportion to its height.
_PAGE = 1180.0
_TALLEST_COLUMN = 1000.0
_ASPECT = 1.4
# Number of wires into one port from which they share a way.
_MEET = 4
_SWEEPS = 16
_ROUNDS = 10
# Weight of a segment by the number of its ends that are bends: long wires become straight.
_WEIGHTS = (1.0, 2.0, 8.0)


@dataclass(frozen=True, slots=True)
class Cell:
    """A rectangle that wires enter on the left and leave on the right.

    Attributes
    ----------
    inputs, outputs : mapping of port to float
        How far from the top the port's wires end or begin.
    """

    width: float
    height: float
    inputs: Mapping[Any, float]
    outputs: Mapping[Any, float]


PIN = Cell(0.0, _BEND, {"": _BEND / 2}, {"": _BEND / 2})
"""The place of a wire in a column without its source and its target."""


@dataclass(frozen=True, slots=True)
class Wire:
    """A connection between ports of two cells, which are given by their numbers."""

    source: int
    source_port: Hashable
    target: int
    target_port: Hashable


@dataclass(frozen=True, slots=True)
class Arrangement:
    """Upper left corners of cells, points of wires, and the size of the whole.

    A wire runs straight between points at the same height or below each other, else in a curve.
    """

    corners: Sequence[Point]
    routes: Sequence[Sequence[Point]]
    width: float
    height: float


def arrange(
    cells: Sequence[Cell], wires: Sequence[Wire], entries: int = 0, exits: int = 0
) -> Arrangement:
    """Return where cells stand and wires run.

    Parameters
    ----------
    cells, wires
        The wires form no cycle.
    entries, exits
        How many cells, the first and the last, stand left and right of all others.
    """
    depths = _depths(cells, wires, entries, exits)
    layers: list[list[int]] = [[] for _ in range(max(depths, default=-1) + 1)]
    for cell, depth in enumerate(depths):
        layers[depth].append(cell)
    shared = Counter[Hashable](("into", wire.target, wire.target_port) for wire in wires)
    shared.update(("out of", wire.source, wire.source_port) for wire in wires)
    net = _Net(list(cells), layers, _columns(cells, layers), shared)
    routes = [net.route(wire) for wire in wires]
    _order(net)
    tops = _settle(net)
    return _Drawing(net, tops, wires, routes).arrangement(len(cells))


def _depths(
    cells: Sequence[Cell], wires: Sequence[Wire], entries: int, exits: int
) -> Sequence[int]:
    inner = range(entries, len(cells) - exits)
    network: nx.DiGraph[int] = nx.DiGraph()
    network.add_nodes_from(inner)
    network.add_edges_from(
        (wire.source, wire.target)
        for wire in wires
        if wire.source in inner and wire.target in inner
    )
    depths = _near_their_readers(network)
    heights = {cell: cells[cell].height + _BETWEEN_CELLS for cell in inner}
    area = sum((cells[cell].width + _BETWEEN_COLUMNS) * heights[cell] for cell in inner)
    most = max(_TALLEST_COLUMN, sqrt(area))
    filled = [0.0] * (max(depths.values(), default=-1) + 1)
    for cell, depth in depths.items():
        filled[depth] += heights[cell]
    if max(filled, default=0.0) > most:
        depths = _first_with_room(network, heights, most)
    first = 1 if entries else 0
    last = max(depths.values(), default=-1) + 1 + first
    return [0] * entries + [first + depths[cell] for cell in inner] + [last] * exits


def _near_their_readers(network: nx.DiGraph[int]) -> dict[int, int]:
    """Return the depth of each cell: after its sources, and no earlier than its readers need.

    A cell with fewer readers than sources stays next to its sources: later, it would make more
    wires longer than shorter.
    """
    depths = {
        cell: depth
        for depth, generation in enumerate(nx.topological_generations(network))
        for cell in generation
    }
    for cell in reversed(depths):
        if network.out_degree(cell) >= max(1, network.in_degree(cell)):
            depths[cell] = min(depths[reader] for reader in network.succ[cell]) - 1
    return depths


def _first_with_room(
    network: nx.DiGraph[int], heights: Mapping[int, float], most: float
) -> dict[int, int]:
    """Put each cell into the first column after its sources that has room for it."""
    depths: dict[int, int] = {}
    filled: list[float] = []
    for cell in nx.dfs_postorder_nodes(network.reverse(copy=False)):
        depth = max((depths[source] + 1 for source in network.pred[cell]), default=0)
        while depth < len(filled) and filled[depth] and filled[depth] + heights[cell] > most:
            depth += 1
        filled += [0.0] * (depth + 1 - len(filled))
        filled[depth] += heights[cell]
        depths[cell] = depth
    return depths


def _columns(cells: Sequence[Cell], layers: Sequence[Sequence[int]]) -> int:
    """Return the number of columns of a band: the largest that makes the whole not too wide."""
    widths = [max(cells[cell].width for cell in layer) for layer in layers]
    heights = [sum(cells[cell].height + _BETWEEN_CELLS for cell in layer) for layer in layers]

    def fits(count: int) -> bool:
        wide = sum(max(widths[column::count]) + _BETWEEN_COLUMNS for column in range(count))
        bands = range(0, len(layers), count)
        high = sum(max(heights[band : band + count]) + _BETWEEN_BANDS for band in bands)
        return wide - _BETWEEN_COLUMNS <= max(_PAGE, _ASPECT * high)

    if len(layers) < 2 or fits(len(layers)):
        return max(1, len(layers))
    low, high = 1, len(layers)
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if fits(middle) else (low, middle)
    return ceil(len(layers) / ceil(len(layers) / low))


@dataclass(frozen=True, slots=True)
class _Segment:
    """A piece of a wire between neighbouring columns, from a port to a port."""

    left: int
    right: int
    left_offset: float
    right_offset: float
    weight: float


@dataclass
class _Net:
    """Cells, then bends of wires, in layers.

    Attributes
    ----------
    columns : int
        The number of columns of a band.
    gaps : list of list of _Segment
        The segments after each layer.
    shared : Counter
        The number of wires into, and out of, each port.
    far : list of (int, int)
        Source and target of wires between bands.
    """

    cells: list[Cell]
    layers: list[list[int]]
    columns: int
    shared: Counter[Hashable]
    gaps: list[list[_Segment]] = field(init=False)
    far: list[tuple[int, int]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.gaps = [[] for _ in self.layers]
        self.depth = {cell: depth for depth, layer in enumerate(self.layers) for cell in layer}
        self._bends: dict[Hashable, dict[int, int]] = {}
        self._linked: set[tuple[tuple[int, Hashable], tuple[int, Hashable]]] = set()

    def band(self, cell: int) -> int:
        return self.depth[cell] // self.columns

    def route(self, wire: Wire) -> Sequence[int] | None:
        """Return the bends of a wire, which those of its owner share; None between bands."""
        source, target = wire.source, wire.target
        if self.band(source) != self.band(target):
            self.far.append((source, target))
            return None
        owner = self.owner(wire)
        bends = self._bends.setdefault(owner, {})
        depths = range(self.depth[source] + 1, self.depth[target])
        for depth in depths:
            if depth not in bends:
                bends[depth] = self._bend(depth)
        route = [bends[depth] for depth in depths]
        ends = (source, wire.source_port), *((bend, "") for bend in route)
        for begin, end in pairwise([*ends, (target, wire.target_port)]):
            self._link(begin, end, self.shared[owner])
        return route

    def owner(self, wire: Wire) -> Hashable:
        """Return the port whose wires share a way: that of the source, or of many wires' target."""
        into = ("into", wire.target, wire.target_port)
        out = ("out of", wire.source, wire.source_port)
        return into if self.shared[into] >= max(_MEET, self.shared[out] + 1) else out

    def _bend(self, depth: int) -> int:
        bend = len(self.cells)
        self.cells.append(PIN)
        self.layers[depth].insert(len(self.layers[depth]) // 2, bend)
        self.depth[bend] = depth
        return bend

    def _link(self, begin: tuple[int, Hashable], end: tuple[int, Hashable], sharing: int) -> None:
        if (begin, end) in self._linked:
            return
        self._linked.add((begin, end))
        left, right = self.cells[begin[0]], self.cells[end[0]]
        bends = (left is PIN) + (right is PIN)
        # one of many wires must not bend the way that they share
        weight = _WEIGHTS[bends] * (1.0 if bends == 2 else min(1.0, _MEET / sharing) ** 2)
        self.gaps[self.depth[begin[0]]].append(
            _Segment(begin[0], end[0], left.outputs[begin[1]], right.inputs[end[1]], weight)
        )


def _stacked(net: _Net, layer: Iterable[int], tops: dict[int, float]) -> None:
    y = 0.0
    for cell in layer:
        tops[cell] = y
        y += net.cells[cell].height + _BETWEEN_CELLS


def _order(net: _Net) -> None:
    """Sort each layer by the barycentres of its neighbours, keeping the order that crosses least.

    Sweeps go to the right and to the left in turn; after each, adjacent cells are exchanged
    where that saves crossings.
    """
    tops: dict[int, float] = {}
    for layer in net.layers:
        _stacked(net, layer, tops)
    best, fewest = [list(layer) for layer in net.layers], _crossings(net, tops)
    for sweep in range(_SWEEPS):
        if not fewest and sweep > 1:
            break
        depths = range(len(net.layers))
        for depth in depths if sweep % 2 == 0 else reversed(depths):
            _sort_layer(net, depth, tops, to_the_right=sweep % 2 == 0)
        _exchange(net, tops)
        count = _crossings(net, tops)
        if count < fewest or sweep == 0 == count:
            best, fewest = [list(layer) for layer in net.layers], count
    net.layers[:] = best


def _sort_layer(net: _Net, depth: int, tops: dict[int, float], *, to_the_right: bool) -> None:
    pulls: dict[int, list[float]] = {}
    if to_the_right:
        for segment in net.gaps[depth - 1] if depth else ():
            pulls.setdefault(segment.right, []).append(tops[segment.left] + segment.left_offset)
        for source, target in net.far:
            if net.depth[target] == depth and target not in pulls:
                pulls[target] = [tops[source]]
    else:
        for segment in net.gaps[depth]:
            pulls.setdefault(segment.left, []).append(tops[segment.right] + segment.right_offset)
    layer = net.layers[depth]
    means = {cell: sum(pulls[cell]) / len(pulls[cell]) for cell in layer if cell in pulls}
    sorted_cells = iter(sorted(means, key=means.__getitem__))
    layer[:] = [next(sorted_cells) if cell in means else cell for cell in layer]
    _stacked(net, layer, tops)


def _exchange(net: _Net, tops: dict[int, float]) -> None:
    for depth, layer in enumerate(net.layers):
        links: dict[int, list[tuple[int, float]]] = {cell: [] for cell in layer}
        for segment in net.gaps[depth - 1] if depth else ():
            links[segment.right].append((0, tops[segment.left] + segment.left_offset))
        for segment in net.gaps[depth]:
            links[segment.left].append((1, tops[segment.right] + segment.right_offset))
        for place in range(len(layer) - 1):
            upper, lower = layer[place : place + 2]
            gain = sum(
                (a > b) - (a < b)
                for side, a in links[upper]
                for other, b in links[lower]
                if side == other
            )
            if gain > 0:
                layer[place : place + 2] = [lower, upper]
        _stacked(net, layer, tops)


def _crossings(net: _Net, tops: Mapping[int, float]) -> int:
    count = 0
    for gap in net.gaps:
        seen: list[float] = []
        for _, right in sorted(
            (tops[segment.left] + segment.left_offset, tops[segment.right] + segment.right_offset)
            for segment in gap
        ):
            count += len(seen) - bisect_right(seen, right)
            insort(seen, right)
    return count


def _settle(net: _Net) -> dict[int, float]:
    """Return the tops of all cells within their bands: ports are drawn level with each other."""
    tops: dict[int, float] = {}
    for layer in net.layers:
        _stacked(net, layer, tops)
    pulls: dict[int, dict[bool, list[tuple[float, float, int]]]] = {
        cell: {True: [], False: []} for cell in tops
    }
    for segment in (segment for gap in net.gaps for segment in gap):
        level = segment.left_offset - segment.right_offset
        pulls[segment.right][True].append((segment.weight, level, segment.left))
        pulls[segment.left][False].append((segment.weight, -level, segment.right))
    for number in range(2 * _ROUNDS):
        to_the_right = number % 2 == 0
        both = number >= 2 * _ROUNDS - 2
        for layer in net.layers if to_the_right else reversed(net.layers):
            wanted = []
            for cell in layer:
                sides = pulls[cell]
                near = sides[True] + sides[False] if both else sides[to_the_right]
                near = near or sides[not to_the_right]
                weight = sum(weight for weight, _, _ in near)
                mean = sum(weight * (tops[other] + level) for weight, level, other in near)
                wanted.append((weight, mean / weight) if near else (0.01, tops[cell]))
            tops.update(zip(layer, _apart(net, layer, wanted), strict=True))
    for band in range(0, len(net.layers), net.columns):
        _close_up(net, range(band, min(band + net.columns, len(net.layers))), tops)
    return tops


def _close_up(net: _Net, band: Iterable[int], tops: dict[int, float]) -> None:
    """Move each connected part of a band up as far as the parts above it allow."""
    above: dict[int, int | None] = {}
    network: nx.Graph[int] = nx.Graph()
    for depth in band:
        layer = net.layers[depth]
        network.add_nodes_from(layer)
        network.add_edges_from((segment.left, segment.right) for segment in net.gaps[depth])
        above.update(zip(layer, [None, *layer], strict=False))
    top = min((tops[cell] for cell in network), default=0.0)
    tops.update({cell: tops[cell] - top for cell in network})
    parts = sorted(nx.connected_components(network), key=lambda part: min(tops[c] for c in part))
    for part in parts:
        room = []
        for cell in part:
            upper = above[cell]
            if upper is None:
                room.append(tops[cell])
            elif upper not in part:
                room.append(tops[cell] - tops[upper] - _distance(net, upper, cell))
        for cell in part:
            tops[cell] -= min(room)


def _distance(net: _Net, upper: int, lower: int) -> float:
    """Return the least distance between the tops of adjacent cells: bends may touch."""
    cells = net.cells[upper], net.cells[lower]
    return cells[0].height + (0.0 if cells == (PIN, PIN) else _BETWEEN_CELLS)


def _apart(net: _Net, layer: Sequence[int], wanted: Sequence[tuple[float, float]]) -> list[float]:
    """Return the tops closest to those wanted, in least squares, of cells that stand apart.

    Cells that would overlap form a block at their common mean (pool adjacent violators).
    """
    offsets = [0.0]
    for upper, lower in pairwise(layer):
        offsets.append(offsets[-1] + _distance(net, upper, lower))
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


class _Drawing:
    """Columns, bands and the lanes between them, in the units of the drawing."""

    def __init__(
        self,
        net: _Net,
        tops: Mapping[int, float],
        wires: Sequence[Wire],
        routes: Sequence[Sequence[int] | None],
    ) -> None:
        self._net = net
        self._tops = tops
        self._wires = wires
        self._routes = routes
        # which lane each wire between bands takes in a channel between columns, or between bands
        self._upright: list[dict[Hashable, int]] = [{} for _ in range(net.columns + 1)]
        self._level: dict[int, dict[Hashable, int]] = {}
        for wire, route in zip(wires, routes, strict=True):
            if route is None:
                self._take_lanes(wire)
        self._columns = self._place_columns()
        self._bands = self._place_bands()

    def _ends(self, wire: Wire) -> tuple[Hashable, int, int, int]:
        """Return who owns the lanes, the channels that they leave and enter, the target's band."""
        net = self._net
        leaves = net.depth[wire.source] % net.columns + 1
        enters = net.depth[wire.target] % net.columns
        return net.owner(wire), leaves, enters, net.band(wire.target)

    def _take_lanes(self, wire: Wire) -> None:
        owner, leaves, enters, band = self._ends(wire)
        for channel in {leaves, enters}:
            self._upright[channel].setdefault(owner, len(self._upright[channel]))
        if leaves != enters:
            lanes = self._level.setdefault(band, {})
            lanes.setdefault(owner, len(lanes))

    def _place_columns(self) -> list[tuple[float, float]]:
        """Return the left and right edges of the columns."""
        net = self._net
        edges: list[tuple[float, float]] = []
        x = len(self._upright[0]) * _LANE + (_BETWEEN_COLUMNS / 2 if self._upright[0] else 0.0)
        for column in range(net.columns):
            wide = max(
                (
                    net.cells[cell].width
                    for layer in net.layers[column :: net.columns]
                    for cell in layer
                ),
                default=0.0,
            )
            edges.append((x, x + wide))
            x += wide + _BETWEEN_COLUMNS + len(self._upright[column + 1]) * _LANE
        return edges

    def _place_bands(self) -> list[tuple[float, float]]:
        """Return the tops and bottoms of the bands."""
        net, bands = self._net, list[tuple[float, float]]()
        y = 0.0
        for number, first in enumerate(range(0, len(net.layers), net.columns)):
            if number:
                y += _BETWEEN_BANDS + len(self._level.get(number, {})) * _LANE
            members = [cell for layer in net.layers[first : first + net.columns] for cell in layer]
            high = max((self._tops[cell] + net.cells[cell].height for cell in members), default=0.0)
            bands.append((y, y + high))
            y += high
        return bands

    def arrangement(self, count: int) -> Arrangement:
        """Return the arrangement, of which the first cells are no bends."""
        corners = [self._corner(cell) for cell in range(count)]
        routes = [
            self._between_bands(wire) if route is None else self._within(wire, route)
            for wire, route in zip(self._wires, self._routes, strict=True)
        ]
        reach = [x for route in routes for x, _ in route]
        right = max([0.0, *reach, *(right for _, right in self._columns)])
        return Arrangement(corners, routes, right, self._bands[-1][1] if self._bands else 0.0)

    def _corner(self, cell: int) -> Point:
        left, _ = self._edges(cell)
        return left, self._bands[self._net.band(cell)][0] + self._tops[cell]

    def _edges(self, cell: int) -> tuple[float, float]:
        return self._columns[self._net.depth[cell] % self._net.columns]

    def _begin(self, wire: Wire) -> Point:
        x, y = self._corner(wire.source)
        cell = self._net.cells[wire.source]
        return x + cell.width, y + cell.outputs[wire.source_port]

    def _end(self, wire: Wire) -> Point:
        x, y = self._corner(wire.target)
        return x, y + self._net.cells[wire.target].inputs[wire.target_port]

    def _within(self, wire: Wire, bends: Sequence[int]) -> list[Point]:
        begin, end = self._begin(wire), self._end(wire)
        points = [begin, (self._edges(wire.source)[1], begin[1])]
        for bend in bends:
            (left, right), y = self._edges(bend), self._corner(bend)[1] + _BEND / 2
            points += [(left, y), (right, y)]
        return [*points, end]

    def _between_bands(self, wire: Wire) -> list[Point]:
        owner, leaves, enters, band = self._ends(wire)
        begin, end = self._begin(wire), self._end(wire)
        down, into = self._lane(leaves, owner), self._lane(enters, owner)
        if leaves == enters:
            return [begin, (down, begin[1]), (down, end[1]), end]
        lanes = self._level[band]
        y = self._bands[band][0] - _BETWEEN_BANDS / 2 - (len(lanes) - 1 - lanes[owner]) * _LANE
        return [begin, (down, begin[1]), (down, y), (into, y), (into, end[1]), end]

    def _lane(self, channel: int, owner: Hashable) -> float:
        left = self._columns[channel - 1][1] if channel else -_BETWEEN_COLUMNS / 2
        return left + _BETWEEN_COLUMNS / 2 + self._upright[channel][owner] * _LANE

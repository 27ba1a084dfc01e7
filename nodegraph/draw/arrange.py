"""Arrangement of cells in layers and columns, with the points of every wire."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise
from math import sqrt

from nodegraph.draw.lanes import LANE, bundle, is_crowded, lane_count, lanes
from nodegraph.draw.layers import Cell, Point, Wire, layers_of
from nodegraph.draw.net import Net, Segment, ends_of, net
from nodegraph.draw.place import order_layers, place_cells

# Least height of a stack of layers that is folded into columns, absolute and by its width.
_TALL = 2000.0
_TOO_TALL = 2.2
# Aspect ratio of the folded drawing, and space between columns.
_ASPECT = 1.4
_GUTTER = 70.0
# Limits of a fold: distance from even columns, wires across it; cost of the distance in wires.
_REACH = 0.45
_MOST_WIRES = 24
_DETOUR = 6.0
# Heights between layers, and around lanes.
_GAP = 46.0
_WIDEST_GAP = 120.0
_ENTRY_GAP = 28.0
_EXIT_GAP = 16.0
_BEFORE_LANES = 10.0
_AFTER_LANES = 26.0
_BESIDE_LANES = 22.0


def columns_of(
    heights: Sequence[float], gaps: Sequence[float], wires: Sequence[int], width: float
) -> list[range]:
    """Return the layers of each column.

    Parameters
    ----------
    heights
        Of the layers.
    gaps
        The heights below each layer.
    wires
        How many wires pass below each layer.
    width
        Of the stack.
    """
    bottoms = list(accumulate(high + gap for high, gap in zip(heights, gaps, strict=True)))
    total = bottoms[-1] if bottoms else 0.0
    if total < _TALL or total < _TOO_TALL * width:
        return [range(len(heights))]
    count = max(2, round(sqrt(_ASPECT * total / (width + _GUTTER))))
    cuts = [0]
    for number in range(1, count):
        cut = _cut(bottoms, wires, number * total / count, total / count)
        if cut is not None and cuts[-1] < cut < len(heights):
            cuts.append(cut)
    return [range(first, last) for first, last in pairwise([*cuts, len(heights)])]


def _cut(bottoms: Sequence[float], wires: Sequence[int], wished: float, high: float) -> int | None:
    """Return the layer before which to cut: near the height wished, where few wires pass."""
    costs = [
        (count + _DETOUR * abs(bottom - wished) / high, layer)
        for layer, (bottom, count) in enumerate(zip(bottoms, wires, strict=True), 1)
        if abs(bottom - wished) < _REACH * high and count <= _MOST_WIRES
    ]
    return min(costs)[1] if costs else None


@dataclass(frozen=True, slots=True)
class Arrangement:
    """A layout, measured from its upper left corner.

    Attributes
    ----------
    corners : list of point
        The upper left corner of each cell.
    routes : list of list of point
        For each wire the points between which it runs: straight down or sideways, else in a
        curve that begins and ends downwards.
    """

    corners: list[Point]
    routes: list[list[Point]]
    width: float
    height: float


@dataclass(frozen=True, slots=True)
class _Gap:
    """What lies between a layer and the next."""

    segments: Sequence[Segment]
    lanes: Mapping[Segment, int]
    height: float


@dataclass(frozen=True, slots=True)
class _Column:
    """Layers that stand below each other."""

    layers: range
    left: float
    right: float
    bottom: float


def arrange(
    cells: Sequence[Cell], wires: Sequence[Wire], entries: int = 0, exits: int = 0
) -> Arrangement:
    """Return a layout in layers, folded into columns where it would be far too tall.

    Parameters
    ----------
    cells, wires
    entries, exits
        How many cells, the first and the last, stand above and below all others; the very
        first of them stands at the left.
    """
    network = net(cells, wires, layers_of(cells, wires, entries, exits))
    layers = order_layers(network)
    middles = place_cells(network, layers)
    if entries:
        middles[0] = cells[0].width / 2
    return _Stack(cells, network, layers, middles, bool(entries), bool(exits)).arrangement()


class _Stack:
    def __init__(
        self,
        cells: Sequence[Cell],
        network: Net,
        layers: Sequence[Sequence[int]],
        middles: list[float],
        entered: bool,
        left: bool,
    ) -> None:
        self._cells = cells
        self._net = network
        self._layers = layers
        self._middles = middles
        self._depths = {cell: depth for depth, layer in enumerate(layers) for cell in layer}
        self._heights = [self._height(layer) for layer in layers]
        self._gaps = self._measure(entered, left)
        self._tops = [0.0] * len(layers)
        self._columns: list[_Column] = []
        self._cuts: dict[int, Mapping[Segment, int]] = {}
        self._stack(entered)
        if left and self._columns:
            self._tops[-1] = self._bottom()

    def arrangement(self) -> Arrangement:
        corners = [
            (self._middles[cell] - shape.width / 2, self._tops[self._depths[cell]])
            for cell, shape in enumerate(self._cells)
        ]
        routes = [self._route(route) for route in self._net.routes]
        right = max((column.right for column in self._columns), default=0.0)
        return Arrangement(corners, routes, right, self._bottom())

    def _height(self, layer: Sequence[int]) -> float:
        return max(
            (self._cells[cell].height for cell in layer if cell < len(self._cells)), default=0
        )

    def _bottom(self) -> float:
        bottoms = [column.bottom for column in self._columns]
        lowest = max(bottoms, default=0.0)
        cut = [
            column.bottom + _BEFORE_LANES + LANE * lane_count(taken)
            for column, taken in zip(self._columns, self._cuts.values(), strict=False)
        ]
        return max([lowest, *cut])

    def _measure(self, entered: bool, left: bool) -> list[_Gap]:
        crowded = is_crowded(self._net.gaps, self._middles)
        gaps = []
        for depth, segments in enumerate(self._net.gaps):
            base = _ENTRY_GAP if entered and not depth else _GAP
            base = _EXIT_GAP if left and depth == len(self._net.gaps) - 2 else base
            taken = lanes(segments, self._middles) if crowded else {}
            gaps.append(_Gap(segments, taken, self._gap_height(segments, taken, base)))
        gaps[-1:] = [_Gap((), {}, 0.0)] if gaps else []
        return gaps

    def _gap_height(
        self, segments: Sequence[Segment], taken: Mapping[Segment, int], base: float
    ) -> float:
        if taken:
            return _BEFORE_LANES + LANE * lane_count(taken) + _AFTER_LANES
        places = [ends_of(segment, self._middles) for segment in segments]
        sideways = max((abs(begin - end) for begin, end in places), default=0.0)
        return min(base + 0.12 * sideways, _WIDEST_GAP)

    def _stack(self, entered: bool) -> None:
        """Set the layers below each other, column by column."""
        counts = [len(bundle(gap.segments)) for gap in self._gaps]
        left, right = self._extent(range(len(self._layers)))
        folded = columns_of(self._heights, [gap.height for gap in self._gaps], counts, right - left)
        for column in folded[:-1]:
            self._cuts[column.stop - 1] = self._folding(self._gaps[column.stop - 1].segments)
        deepest = max((lane_count(taken) for taken in self._cuts.values()), default=0)
        x, top = 0.0, _AFTER_LANES + LANE * deepest if self._cuts else 0.0
        for column in folded:
            y = 0.0 if entered and not column.start else top
            self._columns.append(self._set_column(column, x, y))
            taken = self._cuts.get(column.stop - 1, {})
            x = self._columns[-1].right + 2 * _BESIDE_LANES + LANE * lane_count(taken)

    def _folding(self, segments: Sequence[Segment]) -> dict[Segment, int]:
        """Return the lane, from the inside, of what runs from a column to the next."""
        bundles = bundle(segments)
        bundles.sort(key=lambda many: -max(ends_of(segment, self._middles)[0] for segment in many))
        return {segment: lane for lane, many in enumerate(bundles) for segment in many}

    def _set_column(self, layers: range, x: float, y: float) -> _Column:
        left, right = self._extent(layers)
        for depth in layers:
            for cell in self._layers[depth]:
                self._middles[cell] += x - left
            self._tops[depth] = y
            y += self._heights[depth] + (
                self._gaps[depth].height if depth + 1 < layers.stop else 0.0
            )
        return _Column(layers, x, x + right - left, y)

    def _extent(self, layers: range) -> tuple[float, float]:
        cells = [cell for depth in layers for cell in self._layers[depth]]
        widths = self._net.widths
        left = min((self._middles[cell] - widths[cell] / 2 for cell in cells), default=0.0)
        right = max((self._middles[cell] + widths[cell] / 2 for cell in cells), default=0.0)
        return left, right

    def _route(self, segments: Sequence[Segment]) -> list[Point]:
        points: list[Point] = []
        for segment in segments:
            depth = self._depths[segment.upper]
            begin, end = ends_of(segment, self._middles)
            high = self._cells[segment.upper].height if segment.upper < len(self._cells) else 0.0
            bottom = self._tops[depth] + self._heights[depth]
            points += [(begin, self._tops[depth] + high), (begin, bottom)]
            points += self._between(segment, depth, begin, end, bottom)
            points.append((end, self._tops[depth + 1]))
        return [points[0], *(point for before, point in pairwise(points) if point != before)]

    def _between(
        self, segment: Segment, depth: int, begin: float, end: float, bottom: float
    ) -> list[Point]:
        if depth in self._cuts:
            return self._around(segment, depth, begin, end)
        lane = self._gaps[depth].lanes.get(segment)
        if lane is None:
            return []
        y = bottom + _BEFORE_LANES + LANE * lane
        return [(begin, y), (end, y)]

    def _around(self, segment: Segment, depth: int, begin: float, end: float) -> list[Point]:
        """Return the way from the foot of a column to the head of the next."""
        column = next(column for column in self._columns if column.layers.stop == depth + 1)
        lane = LANE * self._cuts[depth][segment]
        low, high = column.bottom + _BEFORE_LANES + lane, self._tops[depth + 1]
        x, top = column.right + _BESIDE_LANES + lane, high - _AFTER_LANES - lane
        return [(begin, low), (x, low), (x, top), (end, top)]

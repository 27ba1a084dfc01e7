"""Layout of cells in layers, with the points of every wire (Sugiyama et al. 1981)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from nodegraph.draw.lanes import LANE, lane_count, lanes
from nodegraph.draw.layering import Cell, Net, Point, Segment, Wire, ends_of, layers_of, net
from nodegraph.draw.positions import order_layers, place_cells

# Heights between layers, and around lanes.
_GAP = 46.0
_WIDEST_GAP = 120.0
_ENTRY_GAP = 28.0
_EXIT_GAP = 16.0
_BEFORE_LANES = 10.0
_AFTER_LANES = 26.0


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

    lanes: Mapping[Segment, int]
    height: float


def arrange(
    cells: Sequence[Cell], wires: Sequence[Wire], entries: int = 0, exits: int = 0
) -> Arrangement:
    """Return a layout in layers.

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
    """Layers below each other, with the heights between them."""

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
        self._tops: list[float] = []
        self._bottom = 0.0
        for height, gap in zip(self._heights, self._gaps, strict=True):
            self._tops.append(self._bottom)
            self._bottom += height + gap.height

    def arrangement(self) -> Arrangement:
        widths = self._net.widths
        cells = [cell for layer in self._layers for cell in layer]
        left = min((self._middles[cell] - widths[cell] / 2 for cell in cells), default=0.0)
        right = max((self._middles[cell] + widths[cell] / 2 for cell in cells), default=0.0)
        for cell in cells:
            self._middles[cell] -= left
        corners = [
            (self._middles[cell] - shape.width / 2, self._tops[self._depths[cell]])
            for cell, shape in enumerate(self._cells)
        ]
        routes = [self._route(route) for route in self._net.routes]
        return Arrangement(corners, routes, right - left, self._bottom)

    def _height(self, layer: Sequence[int]) -> float:
        return max(
            (self._cells[cell].height for cell in layer if cell < len(self._cells)), default=0
        )

    def _measure(self, entered: bool, left: bool) -> list[_Gap]:
        gaps = []
        for depth, segments in enumerate(self._net.gaps):
            base = _ENTRY_GAP if entered and not depth else _GAP
            base = _EXIT_GAP if left and depth == len(self._net.gaps) - 2 else base
            taken = lanes(segments, self._middles)
            gaps.append(_Gap(taken, self._gap_height(segments, taken, base)))
        gaps[-1:] = [_Gap({}, 0.0)] if gaps else []
        return gaps

    def _gap_height(
        self, segments: Sequence[Segment], taken: Mapping[Segment, int], base: float
    ) -> float:
        if taken:
            return _BEFORE_LANES + LANE * lane_count(taken) + _AFTER_LANES
        places = [ends_of(segment, self._middles) for segment in segments]
        sideways = max((abs(begin - end) for begin, end in places), default=0.0)
        return min(base + 0.12 * sideways, _WIDEST_GAP)

    def _route(self, segments: Sequence[Segment]) -> list[Point]:
        points: list[Point] = []
        for segment in segments:
            depth = self._depths[segment.upper]
            begin, end = ends_of(segment, self._middles)
            high = self._cells[segment.upper].height if segment.upper < len(self._cells) else 0.0
            bottom = self._tops[depth] + self._heights[depth]
            points += [(begin, self._tops[depth] + high), (begin, bottom)]
            lane = self._gaps[depth].lanes.get(segment)
            if lane is not None:
                y = bottom + _BEFORE_LANES + LANE * lane
                points += [(begin, y), (end, y)]
            points.append((end, self._tops[depth + 1]))
        return [points[0], *(point for before, point in pairwise(points) if point != before)]

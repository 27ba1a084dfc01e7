"""Layout of cells in layers, with the points of every wire (Sugiyama et al. 1981)."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from heapq import heappop, heappush
from itertools import pairwise

from nodegraph.draw.layers import Cell, Net, Point, Segment, Wire, ends_of, layers_of, net
from nodegraph.draw.ordering import order_layers, place_cells

LANE = 10.0
"""The distance between lanes."""

# The least width of a segment that runs sideways, and the distance of two in one lane.
_SIDEWAYS = 16.0
_APART = 8.0

_End = tuple[int, float, bool]

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
    """The space between a layer and the next."""

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


@dataclass(frozen=True)
class _Bundle:
    """Segments that begin, or end, in one place and so may run in one lane."""

    segments: tuple[Segment, ...]
    begins: frozenset[float]
    ends: frozenset[float]

    @cached_property
    def left(self) -> float:
        """The leftmost place."""
        return min(self.begins | self.ends)

    @cached_property
    def right(self) -> float:
        """The rightmost place."""
        return max(self.begins | self.ends)


def lanes(gap: Sequence[Segment], middles: Sequence[float]) -> dict[Segment, int]:
    """Return the lane, from the top, of each segment that runs far enough sideways.

    Segments to the right are ordered from the rightmost start, segments to the left from the
    leftmost, so that a wire crosses none that turned before it. If a segment starts where
    another ends, it turns first: otherwise the two would look like a single line.
    """
    bundles = sorted(_bundles(gap, middles), key=_turn)
    above = _above(bundles)
    lane_of: dict[int, int] = {}
    reach: list[list[_Bundle]] = []
    for number in _ordered(above):
        least = max((lane_of[other] + 1 for other in above[number] if other in lane_of), default=0)
        free = (n for n in range(least, len(reach)) if _is_free(bundles[number], reach[n]))
        lane_of[number] = next(free, max(least, len(reach)))
        reach += [[] for _ in range(lane_of[number] + 1 - len(reach))]
        reach[lane_of[number]].append(bundles[number])
    return {
        segment: lane for number, lane in lane_of.items() for segment in bundles[number].segments
    }


def lane_count(taken: Mapping[Segment, int]) -> int:
    """Return the number of lanes used."""
    return max(taken.values(), default=-1) + 1


def _above(bundles: Sequence[_Bundle]) -> list[set[int]]:
    """Return for each bundle those that start where it ends, which must turn first."""
    begins = sorted((x, number) for number, bundle in enumerate(bundles) for x in bundle.begins)
    above: list[set[int]] = [set() for _ in bundles]
    for number, bundle in enumerate(bundles):
        for x in bundle.ends:
            first = bisect_left(begins, (x - _APART, 0))
            last = bisect_left(begins, (x + _APART, 0))
            above[number] |= {other for _, other in begins[first:last]} - {number}
    return above


def _ordered(above: Sequence[set[int]]) -> Iterator[int]:
    """Yield the bundles in order, each after those above it; cycles are broken at the first."""
    below: list[list[int]] = [[] for _ in above]
    for number, blockers in enumerate(above):
        for other in blockers:
            below[other].append(number)
    waiting = [len(above_it) for above_it in above]
    ready = [number for number, count in enumerate(waiting) if not count]
    seen = set()
    for first in range(len(above)):
        if not ready and first not in seen:
            ready = [first]
        while ready:
            number = heappop(ready)
            if number not in seen:
                seen.add(number)
                yield number
                for other in below[number]:
                    waiting[other] -= 1
                    if not waiting[other]:
                        heappush(ready, other)


def _grouped(gap: Sequence[Segment]) -> list[tuple[Segment, ...]]:
    """Return the segments grouped by start, or by end where more of them meet there."""
    leaving: dict[_End, list[Segment]] = {}
    meeting: dict[_End, list[Segment]] = {}
    for segment in gap:
        leaving.setdefault((segment.upper, segment.upper_offset, segment.truth), []).append(segment)
        meeting.setdefault((segment.lower, segment.lower_offset, segment.truth), []).append(segment)
    bundles: dict[tuple[bool, _End], list[Segment]] = {}
    for segment in gap:
        begin = (segment.upper, segment.upper_offset, segment.truth)
        end = (segment.lower, segment.lower_offset, segment.truth)
        joins = len(meeting[end]) > len(leaving[begin])
        bundles.setdefault((joins, end if joins else begin), []).append(segment)
    return [tuple(dict.fromkeys(members)) for members in bundles.values()]


def _bundles(gap: Sequence[Segment], middles: Sequence[float]) -> list[_Bundle]:
    bundles = []
    for segments in _grouped([segment for segment in gap if _is_sideways(segment, middles)]):
        begins, ends = zip(*(ends_of(segment, middles) for segment in segments), strict=True)
        bundles.append(_Bundle(segments, frozenset(begins), frozenset(ends)))
    return bundles


def _turn(bundle: _Bundle) -> tuple[bool, float]:
    rightwards = sum(bundle.ends) / len(bundle.ends) > sum(bundle.begins) / len(bundle.begins)
    return rightwards, -max(bundle.begins) if rightwards else min(bundle.begins)


def _is_free(bundle: _Bundle, taken: Sequence[_Bundle]) -> bool:
    return all(
        bundle.right + _APART < other.left or other.right + _APART < bundle.left for other in taken
    )


def _is_sideways(segment: Segment, middles: Sequence[float]) -> bool:
    begin, end = ends_of(segment, middles)
    return abs(begin - end) > _SIDEWAYS

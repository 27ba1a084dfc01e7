"""Cells and wires -> where each cell stands and through which points each wire runs."""

from __future__ import annotations

from bisect import bisect_left, bisect_right, insort
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise
from math import sqrt

from nodegraph.draw.layers import (
    BEND_WIDTH,
    LANE,
    Cell,
    Net,
    Point,
    Segment,
    Wire,
    bundled,
    ends_of,
    is_crowded,
    lane_count,
    lanes,
    layers_of,
    net,
)

_SWEEPS = 24
_PATIENCE = 6
_EXCHANGES = 4
_MANY_SEGMENTS = 8000
_FEWER = 4


def ordered(net: Net) -> list[list[int]]:
    """Return the layers, each in the best order that the sweeps found.

    Of a very large net fewer orders are tried, so that nobody waits for a picture that cannot
    be overlooked anyway.
    """
    many = sum(map(len, net.gaps)) > _MANY_SEGMENTS
    effort = _FEWER if many else 1
    layers = [list(layer) for layer in net.layers]
    best, fewest, idle = layers, crossings(net, layers), 0
    for sweep in range(_SWEEPS // effort):
        if not fewest or idle == _PATIENCE:
            break
        swept = _sweep(net, layers, downwards=sweep % 2 == 0)
        layers = _exchanged(net, swept, _EXCHANGES // effort)
        found = crossings(net, layers)
        idle = 0 if found < fewest else idle + 1
        if found < fewest:
            best, fewest = layers, found
    return best


def crossings(net: Net, layers: Sequence[Sequence[int]]) -> int:
    """Return how many pairs of segments cross."""
    places = _places(net, layers)
    return sum(_crossings_in(gap, places, net.widths) for gap in net.gaps)


def _places(net: Net, layers: Sequence[Sequence[int]]) -> dict[int, int]:
    return {cell: place for layer in layers for place, cell in enumerate(layer)}


def _upper(segment: Segment, places: Mapping[int, int], widths: Sequence[float]) -> float:
    """Return where a segment begins: the cell's place, and where along the cell the port is."""
    return places[segment.upper] + segment.upper_offset / widths[segment.upper]


def _lower(segment: Segment, places: Mapping[int, int], widths: Sequence[float]) -> float:
    return places[segment.lower] + segment.lower_offset / widths[segment.lower]


def _crossings_in(
    gap: Sequence[Segment], places: Mapping[int, int], widths: Sequence[float]
) -> int:
    ends = sorted((_upper(one, places, widths), _lower(one, places, widths)) for one in gap)
    seen: list[float] = []
    count = 0
    for _, lower in ends:
        count += len(seen) - bisect_right(seen, lower)
        insort(seen, lower)
    return count


def _sweep(net: Net, layers: Sequence[Sequence[int]], *, downwards: bool) -> list[list[int]]:
    """Order each layer by the middle of its neighbours above (or below), one after the other."""
    swept = [list(layer) for layer in layers]
    places = _places(net, swept)
    numbers = range(1, len(swept)) if downwards else range(len(swept) - 2, -1, -1)
    for number in numbers:
        gap = net.gaps[number - 1] if downwards else net.gaps[number]
        pulls: dict[int, list[float]] = {}
        for one in gap:
            if downwards:
                pulls.setdefault(one.lower, []).append(_upper(one, places, net.widths))
            else:
                pulls.setdefault(one.upper, []).append(_lower(one, places, net.widths))
        swept[number] = _reordered(swept[number], pulls)
        places.update({cell: place for place, cell in enumerate(swept[number])})
    return swept


def _reordered(layer: Sequence[int], pulls: Mapping[int, Sequence[float]]) -> list[int]:
    """Sort the cells that are pulled among the places they hold; the others stay."""
    means = {cell: sum(pulls[cell]) / len(pulls[cell]) for cell in layer if cell in pulls}
    pulled = iter(sorted(means, key=means.__getitem__))
    return [next(pulled) if cell in means else cell for cell in layer]


def _exchanged(net: Net, layers: Sequence[Sequence[int]], rounds: int) -> list[list[int]]:
    """Exchange neighbours in a layer where that saves crossings."""
    better = [list(layer) for layer in layers]
    places = _places(net, better)
    for _ in range(rounds):
        changed = False
        for number, layer in enumerate(better):
            ends = _ends(net, number, places)
            for left in range(len(layer) - 1):
                one, other = ends[layer[left]], ends[layer[left + 1]]
                if _saved(one, other) > 0:
                    layer[left], layer[left + 1] = layer[left + 1], layer[left]
                    changed = True
            places.update({cell: place for place, cell in enumerate(layer)})
        if not changed:
            break
    return better


_Ends = tuple[list[float], list[float]]


def _ends(net: Net, number: int, places: Mapping[int, int]) -> dict[int, _Ends]:
    """Return for each cell of a layer where its segments end above and below, sorted."""
    ends: dict[int, _Ends] = {cell: ([], []) for cell in net.layers[number]}
    for one in net.gaps[number - 1] if number else ():
        ends[one.lower][0].append(_upper(one, places, net.widths))
    for one in net.gaps[number]:
        ends[one.upper][1].append(_lower(one, places, net.widths))
    for above, below in ends.values():
        above.sort()
        below.sort()
    return ends


def _saved(left: _Ends, right: _Ends) -> int:
    """Return how many crossings fewer there are when two neighbours change places."""
    saved = 0
    for ours, theirs in zip(left, right, strict=True):
        saved += sum(bisect_left(theirs, end) for end in ours)
        saved -= sum(bisect_left(ours, end) for end in theirs)
    return saved


_Range = tuple[float, float]
_EVERYWHERE = (float("-inf"), float("inf"))


def straighten(
    net: Net,
    layers: Sequence[Sequence[int]],
    apart: Sequence[Sequence[float]],
    middles: list[float],
) -> None:
    """Move the bends of each long arrow in place, so that it changes its course least often."""
    beside = _beside(layers, apart)
    ends = _straight_ends(net)
    for chain in net.chains:
        free = [_free(cell, beside, middles) for cell in chain]
        # the end that is one port comes first: at the other many may fork or meet
        joined = sorted((ends[chain[0]], ends[chain[-1]]), key=len)
        wished = [middles[other] + shift for other, shift in joined[0] + joined[1]]
        for begin, end, (low, high) in _runs(free):
            x = _within(wished, low, high, sum(middles[cell] for cell in chain) / len(chain))
            for cell in chain[begin:end]:
                middles[cell] = x
            wished = [x, *wished]


def _beside(
    layers: Sequence[Sequence[int]], apart: Sequence[Sequence[float]]
) -> Mapping[int, tuple[tuple[int, float] | None, tuple[int, float] | None]]:
    """Return each cell's neighbours in its layer with their distances."""
    found = {}
    for layer, distances in zip(layers, apart, strict=True):
        left = [None, *zip(layer, distances, strict=False)]
        right = [*zip(layer[1:], distances, strict=True), None]
        found.update(dict(zip(layer, zip(left, right, strict=True), strict=True)))
    return found


def _straight_ends(net: Net) -> dict[int, list[tuple[int, float]]]:
    """Return for each bend the boxes that it is joined to, and how far off their ports are."""
    boxes = len(net.widths) - sum(len(chain) for chain in net.chains)
    ends: dict[int, list[tuple[int, float]]] = {}
    for chain in net.chains:
        ends |= {cell: [] for cell in chain}
    for gap in net.gaps:
        for one in gap:
            if one.upper < boxes <= one.lower:
                ends[one.lower].append((one.upper, one.upper_offset))
            elif one.lower < boxes <= one.upper:
                ends[one.upper].append((one.lower, one.lower_offset))
    return ends


def _free(
    cell: int,
    beside: Mapping[int, tuple[tuple[int, float] | None, tuple[int, float] | None]],
    middles: Sequence[float],
) -> _Range:
    left, right = beside[cell]
    low = middles[left[0]] + left[1] if left else _EVERYWHERE[0]
    high = middles[right[0]] - right[1] if right else _EVERYWHERE[1]
    return low, high


def _runs(free: Sequence[_Range]) -> Iterator[tuple[int, int, _Range]]:
    """Part the ranges into the fewest runs that have a place in common, from the top."""
    begin, (low, high) = 0, free[0]
    for index, (least, most) in enumerate(free):
        if max(low, least) > min(high, most):
            yield begin, index, (low, high)
            begin, low, high = index, least, most
        low, high = max(low, least), min(high, most)
    yield begin, len(free), (low, high)


def _within(wished: Sequence[float], low: float, high: float, now: float) -> float:
    """Return the first wish that fits, else the place nearest to where the arrow runs now."""
    fitting = [x for x in wished if low <= x <= high]
    return fitting[0] if fitting else min(max(now, low), high)


_Pulls = list[list[tuple[int, float, float]]]

_ROUNDS = 10
_ALIGNMENTS = 3
_BOX_GAP = 44.0
_BEND_GAP = 22.0
_BETWEEN_BENDS = 8.0
_LOOSE = 0.01
_LIGHT = 0.1


def placed(net: Net, layers: Sequence[Sequence[int]]) -> list[float]:
    """Return the middle of each cell, counted from the leftmost edge.

    Layer by layer, down and up in turn, each cell is pulled to its neighbours; within a layer
    the least squares solution that keeps order and distance is exact (`spread`). Then boxes are
    lined up with one of their neighbours each, and long arrows made straight.
    """
    apart = [_distances(layer, net.widths) for layer in layers]
    middles = [0.0] * len(net.widths)
    for layer, distances in zip(layers, apart, strict=True):
        _set(middles, layer, _centred(distances) if layer else [])
    above, below = _neighbours(net)
    both = [ups + downs for ups, downs in zip(above, below, strict=True)]
    for number, pulls in [
        *_tour(len(layers), above, below) * _ROUNDS,
        *_tour(len(layers), both, both),
    ]:
        _settle(middles, layers[number], apart[number], pulls, _mean)
    for _ in range(_ALIGNMENTS):
        for number, pulls in _tour(len(layers), both, both):
            _settle(middles, layers[number], apart[number], pulls, _median)
        straighten(net, layers, apart, middles)
    left = min((x - w / 2 for x, w in zip(middles, net.widths, strict=True)), default=0.0)
    return [x - left for x in middles]


def _centred(apart: Sequence[float]) -> list[float]:
    """Return places as near to each other as can be, around zero."""
    places = [0.0, *accumulate(apart)]
    return [place - places[-1] / 2 for place in places]


def _tour(count: int, down: _Pulls, up: _Pulls) -> list[tuple[int, _Pulls]]:
    """Return the layers downwards and upwards, with what pulls on the way."""
    return [(one, down) for one in range(count)] + [(one, up) for one in range(count)][::-1]


def _neighbours(net: Net) -> tuple[_Pulls, _Pulls]:
    """Return for each cell its neighbours above and below: cell, shift, weight."""
    above: _Pulls = [[] for _ in net.widths]
    below: _Pulls = [[] for _ in net.widths]
    for gap in net.gaps:
        for one in gap:
            shift = one.upper_offset - one.lower_offset
            above[one.lower].append((one.upper, shift, one.weight))
            below[one.upper].append((one.lower, -shift, one.weight))
    return above, below


def _distances(layer: Sequence[int], widths: Sequence[float]) -> list[float]:
    """Return how far the middles of neighbours in a layer must be apart."""
    apart = []
    for left, right in pairwise(layer):
        bends = (widths[left] <= BEND_WIDTH) + (widths[right] <= BEND_WIDTH)
        gap = (_BOX_GAP, _BEND_GAP, _BETWEEN_BENDS)[bends]
        apart.append((widths[left] + widths[right]) / 2 + gap)
    return apart


def _set(middles: list[float], layer: Sequence[int], values: Sequence[float]) -> None:
    for cell, value in zip(layer, values, strict=True):
        middles[cell] = value


def _settle(
    middles: list[float],
    layer: Sequence[int],
    apart: Sequence[float],
    pulls: _Pulls,
    choose: Callable[[Sequence[tuple[float, float]], float], float],
) -> None:
    wished, weights = [], []
    for cell in layer:
        pulling = [(middles[other] + shift, weight) for other, shift, weight in pulls[cell]]
        weight = sum(weight for _, weight in pulling)
        weights.append(max(weight, _LOOSE))
        if weight >= _LIGHT:
            wished.append(choose(pulling, middles[cell]))
        else:  # as one of very many it stays among them, in the middle
            wished.append(0.0 if pulling else middles[cell])
    _set(middles, layer, spread(wished, weights, apart))


def _mean(pulling: Sequence[tuple[float, float]], now: float) -> float:
    return sum(x * weight for x, weight in pulling) / sum(weight for _, weight in pulling)


def _median(pulling: Sequence[tuple[float, float]], now: float) -> float:
    """Return the weighted median of the places, of two the nearer: there one arrow is straight."""
    total = sum(weight for _, weight in pulling)
    passed = 0.0
    middles = []
    for x, weight in sorted(pulling):
        before, passed = passed, passed + weight
        if 2 * before <= total * 1.000001 and 2 * passed >= total * 0.999999:
            middles.append(x)
    return min(middles, key=lambda x: abs(x - now))


def spread(
    wished: Sequence[float], weights: Sequence[float], apart: Sequence[float]
) -> list[float]:
    """Return the places nearest to those wished that keep order and distance.

    Minimizes the weighted sum of squared shifts subject to ``x[i + 1] - x[i] >= apart[i]``. With
    the distances subtracted this is isotonic regression, solved by pooling adjacent violators
    (M. Ayer et al. (1955), Annals of Mathematical Statistics 26(4), 641-647).
    """
    starts = [0.0]
    for distance in apart:
        starts.append(starts[-1] + distance)
    pools: list[tuple[float, float, int]] = []  # mean, weight, count
    for index, (place, weight) in enumerate(zip(wished, weights, strict=True)):
        mean, count = place - starts[index], 1
        while pools and pools[-1][0] > mean:
            other, heavy, several = pools.pop()
            mean = (mean * weight + other * heavy) / (weight + heavy)
            weight, count = weight + heavy, count + several
        pools.append((mean, weight, count))
    means = [mean for mean, _, count in pools for _ in range(count)]
    return [mean + start for mean, start in zip(means, starts, strict=False)]


_TALL = 2000.0
_TOO_TALL = 2.2
_ASPECT = 1.4
_GUTTER = 70.0
_REACH = 0.45
_MOST_WIRES = 24
_DETOUR = 6.0


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


_GAP = 46.0
_WIDEST_GAP = 120.0
_BEFORE_LANES = 10.0
_AFTER_LANES = 26.0
_BESIDE_LANES = 22.0
_ENTRY_GAP = 28.0
_EXIT_GAP = 16.0


@dataclass(frozen=True, slots=True)
class Arranged:
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


def arranged(
    cells: Sequence[Cell], wires: Sequence[Wire], entries: int = 0, exits: int = 0
) -> Arranged:
    """Return a layout in layers, folded into columns where it would be far too tall.

    Parameters
    ----------
    cells, wires
    entries, exits
        How many cells, the first and the last, stand above and below all others; the very
        first of them stands at the left.
    """
    made = net(cells, wires, layers_of(cells, wires, entries, exits))
    layers = ordered(made)
    middles = placed(made, layers)
    if entries:
        middles[0] = cells[0].width / 2
    return _Stack(cells, made, layers, middles, bool(entries), bool(exits)).arranged()


class _Stack:
    def __init__(
        self,
        cells: Sequence[Cell],
        made: Net,
        layers: Sequence[Sequence[int]],
        middles: list[float],
        entered: bool,
        left: bool,
    ) -> None:
        self._cells = cells
        self._net = made
        self._layers = layers
        self._middles = middles
        self._depths = {cell: depth for depth, layer in enumerate(layers) for cell in layer}
        self._heights = [self._height(layer) for layer in layers]
        self._gaps = self._measured(entered, left)
        self._tops = [0.0] * len(layers)
        self._columns: list[_Column] = []
        self._cuts: dict[int, Mapping[Segment, int]] = {}
        self._stack(entered)
        if left and self._columns:
            self._tops[-1] = self._bottom()

    def arranged(self) -> Arranged:
        corners = [
            (self._middles[cell] - one.width / 2, self._tops[self._depths[cell]])
            for cell, one in enumerate(self._cells)
        ]
        routes = [self._route(one) for one in self._net.routes]
        right = max((column.right for column in self._columns), default=0.0)
        return Arranged(corners, routes, right, self._bottom())

    def _height(self, layer: Sequence[int]) -> float:
        return max((self._cells[one].height for one in layer if one < len(self._cells)), default=0)

    def _bottom(self) -> float:
        bottoms = [column.bottom for column in self._columns]
        lowest = max(bottoms, default=0.0)
        cut = [
            column.bottom + _BEFORE_LANES + LANE * lane_count(taken)
            for column, taken in zip(self._columns, self._cuts.values(), strict=False)
        ]
        return max([lowest, *cut])

    def _measured(self, entered: bool, left: bool) -> list[_Gap]:
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
        places = [ends_of(one, self._middles) for one in segments]
        sideways = max((abs(begin - end) for begin, end in places), default=0.0)
        return min(base + 0.12 * sideways, _WIDEST_GAP)

    def _stack(self, entered: bool) -> None:
        """Set the layers below each other, column by column."""
        counts = [len(bundled(gap.segments)) for gap in self._gaps]
        left, right = self._extent(range(len(self._layers)))
        folded = columns_of(self._heights, [gap.height for gap in self._gaps], counts, right - left)
        for column in folded[:-1]:
            self._cuts[column.stop - 1] = self._folding(self._gaps[column.stop - 1].segments)
        deepest = max((lane_count(one) for one in self._cuts.values()), default=0)
        x, top = 0.0, _AFTER_LANES + LANE * deepest if self._cuts else 0.0
        for column in folded:
            y = 0.0 if entered and not column.start else top
            self._columns.append(self._set_column(column, x, y))
            taken = self._cuts.get(column.stop - 1, {})
            x = self._columns[-1].right + 2 * _BESIDE_LANES + LANE * lane_count(taken)

    def _folding(self, segments: Sequence[Segment]) -> dict[Segment, int]:
        """Return the lane, from the inside, of what runs from a column to the next."""
        bundles = bundled(segments)
        bundles.sort(key=lambda many: -max(ends_of(one, self._middles)[0] for one in many))
        return {one: lane for lane, many in enumerate(bundles) for one in many}

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
        for one in segments:
            depth = self._depths[one.upper]
            begin, end = ends_of(one, self._middles)
            high = self._cells[one.upper].height if one.upper < len(self._cells) else 0.0
            bottom = self._tops[depth] + self._heights[depth]
            points += [(begin, self._tops[depth] + high), (begin, bottom)]
            points += self._between(one, depth, begin, end, bottom)
            points.append((end, self._tops[depth + 1]))
        return [points[0], *(point for before, point in pairwise(points) if point != before)]

    def _between(
        self, one: Segment, depth: int, begin: float, end: float, bottom: float
    ) -> list[Point]:
        if depth in self._cuts:
            return self._around(one, depth, begin, end)
        lane = self._gaps[depth].lanes.get(one)
        if lane is None:
            return []
        y = bottom + _BEFORE_LANES + LANE * lane
        return [(begin, y), (end, y)]

    def _around(self, one: Segment, depth: int, begin: float, end: float) -> list[Point]:
        """Return the way from the foot of a column to the head of the next."""
        column = next(column for column in self._columns if column.layers.stop == depth + 1)
        lane = LANE * self._cuts[depth][one]
        low, high = column.bottom + _BEFORE_LANES + lane, self._tops[depth + 1]
        x, top = column.right + _BESIDE_LANES + lane, high - _AFTER_LANES - lane
        return [(begin, low), (x, low), (x, top), (end, top)]

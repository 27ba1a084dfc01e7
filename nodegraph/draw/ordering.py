"""Order and horizontal position of cells within their layers."""

from __future__ import annotations

from bisect import bisect_left, bisect_right, insort
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import accumulate, pairwise
from math import inf

from nodegraph.draw.layers import BEND_WIDTH, Net, Segment

# Effort spent on the order: sweeps, sweeps without gain, rounds of exchanges in each sweep; a
# quarter of it for a net of many segments.
_SWEEPS = 24
_PATIENCE = 6
_EXCHANGES = 4
_MANY_SEGMENTS = 8000
_FEWER = 4
# Effort spent on the positions.
_ROUNDS = 10
_ALIGNMENTS = 3
# Distances between two boxes, a box and a bend, two bends.
_BOX_GAP = 44.0
_BEND_GAP = 22.0
_BETWEEN_BENDS = 8.0
# The least weight of a cell, and the weight from which its neighbours set its position.
_LOOSE = 0.01
_LIGHT = 0.1

_Ends = tuple[list[float], list[float]]
_Range = tuple[float, float]
_Pulls = list[list[tuple[int, float, float]]]
_Beside = tuple[tuple[int, float] | None, tuple[int, float] | None]


def order_layers(net: Net) -> list[list[int]]:
    """Return the layers, each in the order with the fewest crossings that the sweeps find.

    Sweeps sort each layer by the barycentres of its neighbours and exchange adjacent cells
    (K. Sugiyama et al. (1981), IEEE Trans. Systems, Man, and Cybernetics 11(2), 109-125).
    """
    many = sum(map(len, net.gaps)) > _MANY_SEGMENTS
    effort = _FEWER if many else 1
    layers = [list(layer) for layer in net.layers]
    best, fewest, idle = layers, crossings(net, layers), 0
    for sweep in range(_SWEEPS // effort):
        if not fewest or idle == _PATIENCE:
            break
        swept = _sweep(net, layers, downwards=sweep % 2 == 0)
        layers = _exchange(net, swept, _EXCHANGES // effort)
        count = crossings(net, layers)
        idle = 0 if count < fewest else idle + 1
        if count < fewest:
            best, fewest = layers, count
    return best


def crossings(net: Net, layers: Sequence[Sequence[int]]) -> int:
    """Return the number of crossings of segments."""
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
    ends = sorted(
        (_upper(segment, places, widths), _lower(segment, places, widths)) for segment in gap
    )
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
        for segment in gap:
            if downwards:
                pulls.setdefault(segment.lower, []).append(_upper(segment, places, net.widths))
            else:
                pulls.setdefault(segment.upper, []).append(_lower(segment, places, net.widths))
        swept[number] = _reorder(swept[number], pulls)
        places.update({cell: place for place, cell in enumerate(swept[number])})
    return swept


def _reorder(layer: Sequence[int], pulls: Mapping[int, Sequence[float]]) -> list[int]:
    """Sort the cells that are pulled among the places they hold; the others stay."""
    means = {cell: sum(pulls[cell]) / len(pulls[cell]) for cell in layer if cell in pulls}
    pulled = iter(sorted(means, key=means.__getitem__))
    return [next(pulled) if cell in means else cell for cell in layer]


def _exchange(net: Net, layers: Sequence[Sequence[int]], rounds: int) -> list[list[int]]:
    """Exchange neighbours in a layer where that saves crossings."""
    better = [list(layer) for layer in layers]
    places = _places(net, better)
    for _ in range(rounds):
        changed = False
        for number, layer in enumerate(better):
            ends = _ends(net, number, places)
            for left in range(len(layer) - 1):
                first, other = ends[layer[left]], ends[layer[left + 1]]
                if _saved(first, other) > 0:
                    layer[left], layer[left + 1] = layer[left + 1], layer[left]
                    changed = True
            places.update({cell: place for place, cell in enumerate(layer)})
        if not changed:
            break
    return better


def _ends(net: Net, number: int, places: Mapping[int, int]) -> dict[int, _Ends]:
    """Return for each cell of a layer where its segments end above and below, sorted."""
    ends: dict[int, _Ends] = {cell: ([], []) for cell in net.layers[number]}
    for segment in net.gaps[number - 1] if number else ():
        ends[segment.lower][0].append(_upper(segment, places, net.widths))
    for segment in net.gaps[number]:
        ends[segment.upper][1].append(_lower(segment, places, net.widths))
    for above, below in ends.values():
        above.sort()
        below.sort()
    return ends


def _saved(left: _Ends, right: _Ends) -> int:
    """Return the number of crossings saved when two neighbours change places."""
    saved = 0
    for ours, theirs in zip(left, right, strict=True):
        saved += sum(bisect_left(theirs, end) for end in ours)
        saved -= sum(bisect_left(ours, end) for end in theirs)
    return saved


def place_cells(net: Net, layers: Sequence[Sequence[int]]) -> list[float]:
    """Return the middle of each cell, counted from the leftmost edge.

    Layer by layer, down and up in turn, each cell is pulled to its neighbours; within a layer
    the least squares solution that keeps order and distance is exact (`spread`). Then boxes are
    lined up with one of their neighbours each, and long arrows made straight.
    """
    apart = [_distances(layer, net.widths) for layer in layers]
    middles = [0.0] * len(net.widths)
    for layer, distances in zip(layers, apart, strict=True):
        _set(middles, layer, _centre(distances) if layer else [])
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


def _centre(apart: Sequence[float]) -> list[float]:
    """Return places as near to each other as can be, around zero."""
    places = [0.0, *accumulate(apart)]
    return [place - places[-1] / 2 for place in places]


def _tour(count: int, down: _Pulls, up: _Pulls) -> list[tuple[int, _Pulls]]:
    """Return the layers downwards and upwards, with what pulls on the way."""
    return [(number, down) for number in range(count)] + [(number, up) for number in range(count)][
        ::-1
    ]


def _neighbours(net: Net) -> tuple[_Pulls, _Pulls]:
    """Return for each cell its neighbours above and below: cell, shift, weight."""
    above: _Pulls = [[] for _ in net.widths]
    below: _Pulls = [[] for _ in net.widths]
    for gap in net.gaps:
        for segment in gap:
            shift = segment.upper_offset - segment.lower_offset
            above[segment.lower].append((segment.upper, shift, segment.weight))
            below[segment.upper].append((segment.lower, -shift, segment.weight))
    return above, below


def _distances(layer: Sequence[int], widths: Sequence[float]) -> list[float]:
    """Return the least distances between the middles of neighbours in a layer."""
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
    desired, weights = [], []
    for cell in layer:
        pulling = [(middles[other] + shift, weight) for other, shift, weight in pulls[cell]]
        weight = sum(weight for _, weight in pulling)
        weights.append(max(weight, _LOOSE))
        if weight >= _LIGHT:
            desired.append(choose(pulling, middles[cell]))
        else:  # as one of very many it stays among them, in the middle
            desired.append(0.0 if pulling else middles[cell])
    _set(middles, layer, spread(desired, weights, apart))


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
    desired: Sequence[float], weights: Sequence[float], apart: Sequence[float]
) -> list[float]:
    """Return the places nearest to those desired that keep order and distance.

    Minimizes the weighted sum of squared shifts subject to ``x[i + 1] - x[i] >= apart[i]``. With
    the distances subtracted this is isotonic regression, solved by pooling adjacent violators
    (M. Ayer et al. (1955), Annals of Mathematical Statistics 26(4), 641-647).
    """
    starts = [0.0]
    for distance in apart:
        starts.append(starts[-1] + distance)
    pools: list[tuple[float, float, int]] = []  # mean, weight, count
    for index, (place, weight) in enumerate(zip(desired, weights, strict=True)):
        mean, count = place - starts[index], 1
        while pools and pools[-1][0] > mean:
            other, heavy, several = pools.pop()
            mean = (mean * weight + other * heavy) / (weight + heavy)
            weight, count = weight + heavy, count + several
        pools.append((mean, weight, count))
    means = [mean for mean, _, count in pools for _ in range(count)]
    return [mean + start for mean, start in zip(means, starts, strict=False)]


def straighten(
    net: Net,
    layers: Sequence[Sequence[int]],
    apart: Sequence[Sequence[float]],
    middles: list[float],
) -> None:
    """Move the bends of each long arrow in place, so that it changes its course least often."""
    beside = _beside(layers, apart)
    ends = _box_ends(net)
    for chain in net.chains:
        free = [_free(cell, beside, middles) for cell in chain]
        # an end at a single port comes first: at the other end many wires may fork or meet
        joined = sorted((ends[chain[0]], ends[chain[-1]]), key=len)
        desired = [middles[other] + shift for other, shift in joined[0] + joined[1]]
        for begin, end, (low, high) in _runs(free):
            x = _within(desired, low, high, sum(middles[cell] for cell in chain) / len(chain))
            for cell in chain[begin:end]:
                middles[cell] = x
            desired = [x, *desired]


def _beside(
    layers: Sequence[Sequence[int]], apart: Sequence[Sequence[float]]
) -> Mapping[int, _Beside]:
    """Return each cell's neighbours in its layer with their distances."""
    beside = {}
    for layer, distances in zip(layers, apart, strict=True):
        left = [None, *zip(layer, distances, strict=False)]
        right = [*zip(layer[1:], distances, strict=True), None]
        beside.update(dict(zip(layer, zip(left, right, strict=True), strict=True)))
    return beside


def _box_ends(net: Net) -> dict[int, list[tuple[int, float]]]:
    """Return for each bend the boxes that it is joined to, and how far off their ports are."""
    boxes = len(net.widths) - sum(len(chain) for chain in net.chains)
    ends: dict[int, list[tuple[int, float]]] = {}
    for chain in net.chains:
        ends |= {cell: [] for cell in chain}
    for gap in net.gaps:
        for segment in gap:
            if segment.upper < boxes <= segment.lower:
                ends[segment.lower].append((segment.upper, segment.upper_offset))
            elif segment.lower < boxes <= segment.upper:
                ends[segment.upper].append((segment.lower, segment.lower_offset))
    return ends


def _free(
    cell: int,
    beside: Mapping[int, _Beside],
    middles: Sequence[float],
) -> _Range:
    left, right = beside[cell]
    low = middles[left[0]] + left[1] if left else -inf
    high = middles[right[0]] - right[1] if right else inf
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


def _within(desired: Sequence[float], low: float, high: float, now: float) -> float:
    """Return the first wish that fits, else the place nearest to where the arrow runs now."""
    fitting = [x for x in desired if low <= x <= high]
    return fitting[0] if fitting else min(max(now, low), high)

"""Where the cells of each layer stand, so that arrows run straight and nothing overlaps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import accumulate, pairwise

from nodegraph.draw.cells import BEND_WIDTH
from nodegraph.draw.net import Net
from nodegraph.draw.straight import straighten

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

"""Where the cells of each layer stand, so that arrows run straight and nothing overlaps."""

from __future__ import annotations

from collections.abc import Sequence

from nodegraph.draw.net import BEND_WIDTH, Net

_ROUNDS = 12
_BOX_GAP = 44.0
_BEND_GAP = 22.0


def placed(net: Net, layers: Sequence[Sequence[int]]) -> list[float]:
    """Return the middle of each cell, counted from the leftmost edge.

    Layer by layer, down and up in turn, each cell is pulled to its neighbours; within a layer
    the least squares solution that keeps order and distance is exact (`spread`).
    """
    distances = [_distances(layer, net.widths) for layer in layers]
    middles = [0.0] * len(net.widths)
    for layer, apart in zip(layers, distances, strict=True):
        _set(middles, layer, spread([0.0] * len(layer), [1.0] * len(layer), apart))
    above, below = _neighbours(net)
    for round_number in range(_ROUNDS):
        last = round_number >= _ROUNDS - 3
        for down in (True, False):
            for number in range(len(layers)) if down else range(len(layers) - 1, -1, -1):
                pulls = [above, below] if last else [above if down else below]
                _settle(middles, layers[number], distances[number], pulls)
    left = min((x - w / 2 for x, w in zip(middles, net.widths, strict=True)), default=0.0)
    return [x - left for x in middles]


_Pulls = list[list[tuple[int, float, float]]]


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
    for left, right in zip(layer, layer[1:], strict=False):
        bend = min(widths[left], widths[right]) <= BEND_WIDTH
        gap = _BEND_GAP if bend else _BOX_GAP
        apart.append((widths[left] + widths[right]) / 2 + gap)
    return apart


def _set(middles: list[float], layer: Sequence[int], values: Sequence[float]) -> None:
    for cell, value in zip(layer, values, strict=True):
        middles[cell] = value


def _settle(
    middles: list[float], layer: Sequence[int], apart: Sequence[float], pulls: Sequence[_Pulls]
) -> None:
    wished, weights = [], []
    for cell in layer:
        pulling = [pull for one in pulls for pull in one[cell]]
        weight = sum(pull[2] for pull in pulling)
        total = sum((middles[other] + shift) * strength for other, shift, strength in pulling)
        wished.append(total / weight if weight else middles[cell])
        weights.append(weight or 0.01)
    _set(middles, layer, spread(wished, weights, apart))


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

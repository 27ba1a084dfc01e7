"""The order of cells within layers, so that few arrows cross.

Barycentre sweeps after K. Sugiyama, S. Tagawa and M. Toda (1981), "Methods for visual
understanding of hierarchical system structures", IEEE Transactions on Systems, Man, and
Cybernetics 11(2), 109-125; exchanges of neighbours after E. R. Gansner, E. Koutsofios,
S. C. North and K.-P. Vo (1993), "A technique for drawing directed graphs", IEEE Transactions on
Software Engineering 19(3), 214-230.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right, insort
from collections.abc import Mapping, Sequence

from nodegraph.draw.net import Net, Segment

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

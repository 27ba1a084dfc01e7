"""Long arrows made straight, as far as the cells beside them leave room."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from nodegraph.draw.net import Net

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
    ends = _ends(net)
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


def _ends(net: Net) -> dict[int, list[tuple[int, float]]]:
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

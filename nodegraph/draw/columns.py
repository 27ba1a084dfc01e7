"""A tall stack of layers folded into columns, cut where few wires pass."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate, pairwise
from math import sqrt

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

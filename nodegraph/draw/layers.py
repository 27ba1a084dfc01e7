"""Which layer each cell stands in: below all that feeds it, and no layer far too wide."""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

from nodegraph.draw.cells import Cell, Wire
from nodegraph.draw.depths import depths_of
from nodegraph.draw.shelves import SPACE_BESIDE, narrowed

_ASPECT = 1.6
_ALWAYS_NARROW_ENOUGH = 1800.0
_TOO_WIDE = 1.4
_SPACE_BELOW = 60.0


def layers_of(
    cells: Sequence[Cell], wires: Sequence[Wire], entries: int = 0, exits: int = 0
) -> list[int]:
    """Return each cell's layer.

    Parameters
    ----------
    cells, wires
        The wires do not run in a circle.
    entries, exits
        How many cells, the first and the last, stand above and below all others.
    """
    inner = range(entries, len(cells) - exits)
    links = [
        (one.source - entries, one.target - entries)
        for one in wires
        if one.source in inner and one.target in inner
    ]
    depths = _depths([cells[one] for one in inner], links)
    first = 1 if entries else 0
    last = max(depths, default=-1) + 1 + first
    return [0] * entries + [first + depth for depth in depths] + [last] * exits


def _depths(members: Sequence[Cell], links: Sequence[tuple[int, int]]) -> list[int]:
    depths = depths_of(len(members), links)
    limit, wide = _widest(members), _width(members, depths)
    if wide <= _TOO_WIDE * limit:
        return depths
    even = wide / max(2, round(wide / limit)) + max(one.width for one in members)
    return narrowed(members, links, even)


def _widest(cells: Sequence[Cell]) -> float:
    """Return how wide a drawing of the cells may be, that it is not much wider than high."""
    area = sum((one.width + SPACE_BESIDE) * (one.height + _SPACE_BELOW) for one in cells)
    return max(_ALWAYS_NARROW_ENOUGH, sqrt(_ASPECT * area))


def _width(cells: Sequence[Cell], depths: Sequence[int]) -> float:
    widths = [0.0] * (max(depths, default=-1) + 1)
    for one, depth in zip(cells, depths, strict=True):
        widths[depth] += one.width + SPACE_BESIDE
    return max(widths, default=0.0)

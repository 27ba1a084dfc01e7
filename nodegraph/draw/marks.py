"""Small pieces of SVG: numbers, tags, lines, arrow heads."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import copysign

from nodegraph.draw.cells import Point
from nodegraph.draw.text import escaped

HEAD_LENGTH = 8.0
_HEAD_HALF = 4.2
_STRANDS = (-5.0, 5.0, 0.0)
_MEETING = 14.0
_CORNER = 7.0


def number(value: float) -> str:
    """Return a length with one decimal, or none if it is whole."""
    return f"{round(value, 1) + 0.0:.1f}".removesuffix(".0")


def tag(name: str, text: str) -> str:
    """Return an element that holds only text."""
    return f"<{name}>{escaped(text)}</{name}>"


def line(points: Sequence[Point]) -> str:
    """Return the path of an arrow through its points.

    Between points below or beside each other it is straight, with round corners, else a curve
    that begins and ends downwards. The last point is the tip; the line ends where the head begins.
    """
    (tip_x, tip_y), rest = points[-1], points[:-1]
    return _path([*rest, (tip_x, tip_y - HEAD_LENGTH + 1.0)])


def fan(points: Sequence[Point]) -> str:
    """Return several such lines that run side by side and meet shortly before the tip."""
    tip_x, tip_y = points[-1]
    end = [(tip_x, tip_y - _MEETING), (tip_x, tip_y)]
    return "".join(line([*_beside(points, strand)[:-1], *end]) for strand in _STRANDS)


def _beside(points: Sequence[Point], right: float) -> list[Point]:
    """Return the points moved to one side: to the right of who looks along the way from above."""
    moved = []
    ways = [_way(one, other) for one, other in pairwise(points)]
    for (x, y), before, after in zip(points, [ways[0], *ways], [*ways, ways[-1]], strict=True):
        down = before[1] or after[1]
        aside = before[0] or after[0]
        moved.append((x + right * down, y - right * aside))
    return moved


def _way(one: Point, other: Point) -> tuple[float, float]:
    """Return the direction in which a line leaves and reaches its ends."""
    if one[1] == other[1]:
        return copysign(1.0, other[0] - one[0]), 0.0
    return 0.0, copysign(1.0, other[1] - one[1])


def _path(points: Sequence[Point]) -> str:
    points = _without_stops(points)
    path = [f"M{_pair(points[0])}"]
    for before, point, after in zip(points, points[1:], [*points[2:], None], strict=False):
        if before[0] != point[0] and before[1] != point[1]:
            half = (point[1] - before[1]) / 2
            bends = ((before[0], before[1] + half), (point[0], point[1] - half), point)
            path.append("C" + " ".join(_pair(one) for one in bends))
        elif after is None or not _is_corner(before, point, after):
            path.append(f"L{_pair(point)}")
        else:
            begin, end = _towards(point, before), _towards(point, after)
            path.append(f"L{_pair(begin)}Q{_pair(point)} {_pair(end)}")
    return "".join(path)


def _without_stops(points: Sequence[Point]) -> list[Point]:
    """Return the points without those that a straight line passes anyway."""
    kept = [points[0]]
    for point, after in zip(points[1:], [*points[2:], None], strict=True):
        before = kept[-1]
        passes = after is not None and (
            before[0] == point[0] == after[0] or before[1] == point[1] == after[1]
        )
        if point != before and not passes:
            kept.append(point)
    return kept


def _is_corner(before: Point, point: Point, after: Point) -> bool:
    return (before[0] == point[0] and point[1] == after[1]) or (
        before[1] == point[1] and point[0] == after[0]
    )


def _towards(point: Point, other: Point) -> Point:
    """Return the place on the way to another point where a corner's rounding begins."""
    x, y = other[0] - point[0], other[1] - point[1]
    share = min(_CORNER / (abs(x) + abs(y)), 0.5)
    return point[0] + x * share, point[1] + y * share


def _pair(point: Point) -> str:
    return f"{number(point[0])} {number(point[1])}"


def head(x: float, y: float) -> str:
    """Return an arrow head whose tip is at a point, from above."""
    left, right, base = number(x - _HEAD_HALF), number(x + _HEAD_HALF), number(y - HEAD_LENGTH)
    return f'<path class="head" d="M{left} {base}H{right}L{number(x)} {number(y)}Z"/>'

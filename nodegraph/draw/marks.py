"""Small pieces of SVG: numbers, tags, smooth lines, arrow heads, chips."""

from __future__ import annotations

from collections.abc import Sequence

from nodegraph.draw.text import escaped

HEAD_LENGTH = 8.0
_HEAD_HALF = 4.2
_STRANDS = (-5.0, 5.0, 0.0)
_MEETING = 14.0

Point = tuple[float, float]


def number(value: float) -> str:
    """Return a length with one decimal, or none if it is whole."""
    return f"{round(value, 1) + 0.0:.1f}".removesuffix(".0")


def tag(name: str, text: str) -> str:
    """Return an element that holds only text."""
    return f"<{name}>{escaped(text)}</{name}>"


def smooth(points: Sequence[Point]) -> str:
    """Return a path through the points, which come in pairs of equal x: straight, then curved.

    The last point is the tip of the arrow; the line ends where its head begins.
    """
    (x, y), rest = points[0], list(points[1:])
    rest[-1] = (rest[-1][0], rest[-1][1] - HEAD_LENGTH + 1.0)
    path = [f"M{number(x)} {number(y)}"]
    for next_x, next_y in rest:
        if abs(next_x - x) < 0.05:
            path.append(f"V{number(next_y)}")
        else:
            half = (next_y - y) / 2
            bends = ((x, y + half), (next_x, next_y - half), (next_x, next_y))
            path.append("C" + " ".join(f"{number(a)} {number(b)}" for a, b in bends))
        x, y = next_x, next_y
    return "".join(path)


def fan(points: Sequence[Point]) -> str:
    """Return several lines that run side by side and meet shortly before the tip."""
    tip_x, tip_y = points[-1]
    end = [(tip_x, tip_y - _MEETING), (tip_x, tip_y)]
    strands = [[(x + strand, y) for x, y in points[:-1]] for strand in _STRANDS]
    return "".join(smooth([*strand, *end]) for strand in strands)


def head(x: float, y: float) -> str:
    """Return an arrow head whose tip is at a point, from above."""
    left, right, base = number(x - _HEAD_HALF), number(x + _HEAD_HALF), number(y - HEAD_LENGTH)
    return f'<path class="head" d="M{left} {base}H{right}L{number(x)} {number(y)}Z"/>'

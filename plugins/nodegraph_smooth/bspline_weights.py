"""Weights of the B-spline smoothing, worked out exactly.

The trajectory's samples are the control points of a uniform B-spline curve of degree n, and the
curve is taken at each control point's own parameter: each output sample is a fixed weighted mean
of the samples around it. Fractions keep every weight exact until it is a float.
"""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from math import comb, factorial
from typing import TYPE_CHECKING, Literal

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

Ends = Literal["vertex", "clamped", "free"]
Row = list[Fraction]


def basis(order: int, k: int, t: Fraction) -> Fraction:
    """Return ``F_{k,n}(t)``, equation 12 of Zhang et al., exactly."""
    terms = (
        (-1) ** j * comb(order + 1, j) * (t + order - k - j) ** order for j in range(order - k + 1)
    )
    return sum(terms, Fraction(0)) / factorial(order)


def weights(order: int) -> Row:
    """Return the weights of an output sample, from ``order // 2`` frames before to as many after.

    At t = 0 where the order is odd, at t = 1/2 where it is even: both are the parameter of the
    control point in the middle.
    """
    t = Fraction(1 - order % 2, 2)
    return [basis(order, k, t) for k in range(2 * (order // 2) + 1)]


@lru_cache
def middle(order: int) -> NDArray[np.float64]:
    """Return the weights of the samples 1, 2, ... frames off, on either side."""
    return np.array([float(weight) for weight in weights(order)[order // 2 + 1 :]])


def irregular(order: int, ends: Ends) -> int:
    """Return how many output samples at each end have weights of their own."""
    return 2 * order - 1 - (order + 1) // 2 if ends == "clamped" else order // 2


@lru_cache
def first_rows(order: int, ends: Ends) -> NDArray[np.float64]:
    """Return the weights of a long run's irregular first samples, (irregular, samples needed).

    A run of twice as many samples as are irregular has those that are needed.
    """
    count = irregular(order, ends)
    rows = _rows(order, ends, 2 * count + order)[:count]
    width = max((at + 1 for row in rows for at, weight in enumerate(row) if weight), default=0)
    return _floats([row[:width] for row in rows], width)


@lru_cache
def all_rows(order: int, ends: Ends, length: int) -> NDArray[np.float64]:
    """Return the weights of every sample of a run, (length, length)."""
    return _floats(_rows(order, ends, length), length)


def _floats(rows: list[Row], width: int) -> NDArray[np.float64]:
    return np.array([[float(weight) for weight in row] for row in rows]).reshape(len(rows), width)


def _rows(order: int, ends: Ends, length: int) -> list[Row]:
    if ends == "clamped":
        return _clamped(min(order, length - 1), length)
    return [_row(order, ends, length, frame) for frame in range(length)]


def _row(order: int, ends: Ends, length: int, frame: int) -> Row:
    """Return an output sample's weights where the window may reach beyond the run."""
    reach = order // 2
    row = [Fraction(0)] * length
    inside = reach <= frame < length - reach
    if not inside and (ends == "free" or frame in (0, length - 1)):
        row[frame] = Fraction(1)
        return row
    for offset, weight in enumerate(weights(order), frame - reach):
        row[min(max(offset, 0), length - 1)] += weight
    return row


def _clamped(degree: int, length: int) -> list[Row]:
    """Return the quasi-uniform B-splines of a degree at their Greville abscissae."""
    if degree == 0:
        return [[Fraction(1)]]
    spans = length - degree
    inner = [Fraction(knot) for knot in range(1, spans)]
    knots = [Fraction(0)] * (degree + 1) + inner + [Fraction(spans)] * (degree + 1)
    places = [sum(knots[at + 1 : at + degree + 1], Fraction(0)) / degree for at in range(length)]
    return [_values(knots, degree, length, place) for place in places]


def _values(knots: Row, degree: int, length: int, place: Fraction) -> Row:
    """Return every B-spline's value at a place, by the recursion of de Boor and Cox."""
    span = min(int(place), length - degree - 1) + degree
    values = [Fraction(0)] * (len(knots) - 1)
    values[span] = Fraction(1)
    for up in range(1, degree + 1):
        for at in range(span - up, span + 1):
            left, right = knots[at + up] - knots[at], knots[at + up + 1] - knots[at + 1]
            rising = (place - knots[at]) / left * values[at] if left else Fraction(0)
            falling = (
                (knots[at + up + 1] - place) / right * values[at + 1] if right else Fraction(0)
            )
            values[at] = rising + falling
    return values[:length]

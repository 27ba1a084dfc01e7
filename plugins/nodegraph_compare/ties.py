"""Ties: numbers that differ by rounding alone count as equal.

Two methods that compute one thing in two ways differ in the last digits, and in which direction
depends on the machine. So values that are compared are made equal where they differ by no more
than a billionth of their size, before anything is ranked, tested or called the best. Values that
are not near another one stay exactly as they are: nothing is rounded to a grid, on whose borders
rounding would decide again.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Numbers = NDArray[np.float64]

ROUNDING = 1e-9
"""Share of their size by which numbers may differ and still be equal."""

_SMALL = 1e-3
"""Share of what is usual beside them that numbers have for a size at least."""

_AT_ONCE = 1_000_000


def tied(values: Numbers) -> Numbers:
    """Return values in which those that compete, along the last axis, are equal or truly apart.

    Values at most 1e-9 of their size apart all become the first of them. Those smaller than a
    thousandth of what is usual are compared by that size: 1e-31 equals 0 beside 30. Usual is the
    median over the other axes of the largest magnitude along the last, so that one method's
    failure in one block does not make the others equal. NaN stays NaN.

    Parameters
    ----------
    values : (..., K) array of float64

    Returns
    -------
    (..., K) array of float64
    """
    if not values.size:
        return values
    rows = values.reshape(-1, values.shape[-1])
    largest = np.fmax.reduce(np.abs(rows), axis=1)
    usual = np.median(largest[largest > 0.0]) if (largest > 0.0).any() else 0.0
    parts = np.array_split(rows, -(-rows.size // _AT_ONCE))  # a sort needs room
    steps = [settled(part, np.fmax(np.abs(part), _SMALL * usual)) for part in parts]
    return np.concatenate(steps).reshape(values.shape)


def apart(first: Numbers, second: Numbers) -> Numbers:
    """Return first minus second: 0 where the two are equal, one size where differences are.

    A difference is known to a billionth of the numbers that it is the difference of, however
    small it is itself: 0.3 - 0.2 and 0.2 - 0.1 are one.

    Parameters
    ----------
    first, second : (B,) or (B, K) arrays of float64
        A row per block; differences are compared within a column.

    Returns
    -------
    (B,) or (B, K) array of float64
    """
    difference = np.asarray(first - second)
    if not difference.size:
        return difference
    size = np.maximum(np.abs(first), np.abs(second))
    size = np.fmax(size, _SMALL * np.median(size, axis=0))
    far = np.where(np.abs(difference) <= ROUNDING * size, 0.0, np.abs(difference))
    return np.copysign(settled(far.T, size.T).T, difference) + 0.0  # no -0.0


def settled(values: Numbers, size: Numbers) -> Numbers:
    """Return values of which those along the last axis that are equal have become the first.

    Sorted values at most ``1e-9 size`` apart stand on one step, of two sizes the smaller; a
    step is no wider than that, so that many close values do not run into one.

    Parameters
    ----------
    values, size : (..., K) arrays of float64
        What each value's rounding error is measured by: its magnitude, or that of what it was
        computed from.

    Returns
    -------
    (..., K) array of float64
    """
    if not values.size:
        return values
    rows = values.reshape(-1, values.shape[-1])
    order = np.argsort(rows, axis=1, kind="stable")
    sizes = np.take_along_axis(size.reshape(rows.shape), order, axis=1)
    starts = _starts(np.take_along_axis(rows, order, axis=1), ROUNDING * sizes).ravel()
    first = np.minimum.reduceat(order.ravel(), np.flatnonzero(starts))
    source = first[np.cumsum(starts) - 1].reshape(rows.shape)
    result = np.empty_like(rows)
    np.put_along_axis(result, order, np.take_along_axis(rows, source, axis=1), axis=1)
    return result.reshape(values.shape)


def _starts(ordered: Numbers, width: Numbers) -> NDArray[np.bool_]:
    """Return, for sorted rows, where a step begins; every NaN has its own."""
    gap, width = np.diff(ordered, axis=1), np.minimum(width[:, 1:], width[:, :-1])
    near = gap <= width
    gone = np.cumsum(np.where(near, gap / np.where(width > 0.0, width, 1.0), 0.0), axis=1)
    since = gone - np.maximum.accumulate(np.where(near, 0.0, gone), axis=1)
    full = np.diff(np.floor(since), axis=1, prepend=0.0) > 0.0
    return np.concatenate([np.ones((len(ordered), 1), dtype=bool), ~near | full], axis=1)


def at_most(values: Numbers, level: float) -> NDArray[np.bool_]:
    """Return which values are at or below a level, up to rounding; none where it is NaN."""
    return np.asarray(values - level <= ROUNDING * np.maximum(np.abs(values), np.abs(level)))

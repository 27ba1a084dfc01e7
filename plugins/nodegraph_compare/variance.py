"""How much of the variance of a full table of numbers each of its axes explains."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.ties import ROUNDING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

Sources = tuple[int, ...]


def whole(values: NDArray[np.float64]) -> tuple[NDArray[np.intp], ...]:
    """Return the places along each axis that make a table without missing values.

    As long as something is missing, the place with the largest share missing goes; of equals,
    one of the axis with the most places, the last of them.
    """
    kept: list[NDArray[np.intp]] = [np.arange(size) for size in values.shape]
    missing = np.isnan(values)
    while missing.any():
        shares = [_mean(missing, (axis,)) for axis in range(missing.ndim)]
        largest = max(one.max() for one in shares)
        axis = max(
            (axis for axis, one in enumerate(shares) if one.max() == largest),
            key=lambda one: missing.shape[one],
        )
        # what is missing altogether goes at once
        gone = np.flatnonzero(shares[axis] == largest)
        gone = gone if largest == 1.0 else gone[-1:]
        kept[axis] = np.delete(kept[axis], gone)
        missing = np.delete(missing, gone, axis=axis)
    return tuple(kept)


def effects(values: NDArray[np.float64]) -> Mapping[Sources, float]:
    """Return the variance that each axis, and each pair of axes, explains.

    The functional analysis of variance of a full table y (Hoeffding 1948; Hutter et al. 2014 for
    settings of algorithms), population variances: with m the mean over all cells, ``m_a`` the
    means along axis a and ``m_ab`` those along two, ``V_a = mean((m_a - m)^2)`` and
    ``V_ab = mean((m_ab - m_a - m_b + m)^2)``. The key ``()`` has what is left of
    ``V = mean((y - m)^2)``; of one or two axes, nothing is. A variance that rounding alone would
    make, at most ``mean(y^2)`` times the square of 1e-9, is 0.
    """
    left = values - values.mean()
    least = ROUNDING**2 * float(np.square(values).mean())
    axes = range(values.ndim)
    main = {axis: _mean(left, (axis,)) for axis in axes}
    parts: dict[Sources, NDArray[np.float64]] = {(axis,): one for axis, one in main.items()}
    for one, other in combinations(axes, 2):
        both = _mean(left, (one, other)) - main[one][:, np.newaxis] - main[other]
        parts[one, other] = both
    for sources, part in parts.items():
        left -= np.expand_dims(part, tuple(axis for axis in axes if axis not in sources))
    found = {sources: float(np.square(part).mean()) for sources, part in parts.items()}
    found[()] = float(np.square(left).mean()) if values.ndim > 2 else 0.0
    return {sources: one if one > least else 0.0 for sources, one in found.items()}


def winner_changes(values: NDArray[np.float64], compared: int, axis: int) -> float:
    """Return how often two places along an axis, all else equal, have another lowest place.

    The share of all pairs of places along `axis`, over all places along the others, for which
    the first of the lowest values along `compared` stands elsewhere; NaN for a single place.

    Parameters
    ----------
    values
        A full table, an array with an axis per factor.
    compared
        The axis along which the lowest wins.
    axis
        The axis whose places are taken in pairs.
    """
    if values.shape[axis] < 2:
        return np.nan
    winners = np.moveaxis(values, compared, -1).argmin(axis=-1)
    along = np.moveaxis(winners, axis - (axis > compared), -1)
    count = along.shape[-1]
    wins = np.stack([(along == one).sum(axis=-1) for one in range(values.shape[compared])])
    same = (wins * (wins - 1)).sum(axis=0) / (count * (count - 1))
    return float(1.0 - same.mean())


def _mean(
    values: NDArray[np.float64] | NDArray[np.bool_], axes: tuple[int, ...]
) -> NDArray[np.float64]:
    """Return the means over all axes but these."""
    others = tuple(axis for axis in range(values.ndim) if axis not in axes)
    return np.asarray(np.mean(values, axis=others, dtype=np.float64))

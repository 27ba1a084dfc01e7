"""Ranks from 1, of which equal values share the mean of theirs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def midranks(values: NDArray[np.float64], axis: int = -1) -> NDArray[np.float64]:
    """Return the rank of each value along an axis, 1 for the smallest; NaN comes last.

    Parameters
    ----------
    values
    axis
        Along which they are ranked.
    """
    order = values.argsort(axis=axis, kind="stable")
    ordered = np.moveaxis(np.take_along_axis(values, order, axis), axis, -1)
    place = np.arange(1.0, ordered.shape[-1] + 1)
    begins = np.ones(ordered.shape, dtype=np.bool_)
    begins[..., 1:] = ordered[..., 1:] != ordered[..., :-1]
    ends = np.ones_like(begins)
    ends[..., :-1] = begins[..., 1:]
    first = np.maximum.accumulate(np.where(begins, place, 0.0), axis=-1)
    last = np.minimum.accumulate(np.where(ends, place, np.inf)[..., ::-1], axis=-1)[..., ::-1]
    ranks = np.empty(values.shape)
    np.put_along_axis(ranks, order, np.moveaxis((first + last) / 2, -1, axis), axis)
    return ranks

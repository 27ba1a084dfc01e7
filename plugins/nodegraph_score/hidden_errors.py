"""Errors of an estimate where a mask has hidden the truth."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap import Mask, Trajectories
from nodegraph_mocap.truth import check_same_samples

if TYPE_CHECKING:
    from numpy.typing import NDArray


def hidden_errors(
    estimate: Trajectories, truth: Trajectories, hidden: Mask
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return estimate minus truth, and what is hidden, in the order of the truth's markers.

    Parameters
    ----------
    estimate
        T frames of M markers.
    truth
        The same frames and markers, present wherever `hidden` is true.
    hidden
        A mask of the same frames and markers.

    Returns
    -------
    (M, T, 3) array of float64
        Millimetres; NaN where one of the two lacks the sample.
    (M, T) array of bool

    Raises
    ------
    ValueError
        If frame counts or markers differ, or the truth lacks a hidden sample.
    """
    check_same_samples("estimate", estimate, "truth", truth)
    check_same_samples("hidden", hidden, "truth", truth)
    mask = hidden.hidden[:, columns(hidden.markers, truth.markers)].T
    unknown = mask & ~truth.present.T
    if unknown.any():
        marker, frame = np.argwhere(unknown)[0]
        raise ValueError(
            f"frame {frame}, marker {truth.markers[marker]!r}: hidden, but the truth has no "
            f"sample there ({np.count_nonzero(unknown)} such samples)"
        )
    error = estimate.positions[:, columns(estimate.markers, truth.markers)] - truth.positions
    return error.transpose(1, 0, 2), mask


def columns(names: tuple[str, ...], wanted: tuple[str, ...]) -> list[int]:
    """Return the position of each of the wanted names."""
    place = {name: column for column, name in enumerate(names)}
    return [place[name] for name in wanted]

"""Errors of an estimate where a mask has hidden the truth."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap import Mask, Trajectories

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
    _check(estimate, truth, hidden)
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


def _check(estimate: Trajectories, truth: Trajectories, hidden: Mask) -> None:
    for what, frames, markers in (
        ("estimate", estimate.frames, estimate.markers),
        ("hidden", hidden.hidden.shape[0], hidden.markers),
    ):
        if frames != truth.frames:
            raise ValueError(f"{what} has {frames} frames, the truth has {truth.frames}")
        if set(markers) != set(truth.markers):
            lacks = [name for name in truth.markers if name not in markers]
            adds = [name for name in markers if name not in truth.markers]
            lists = (("lacks", lacks), ("has besides", adds))
            differences = "; ".join(f"{verb} {', '.join(names)}" for verb, names in lists if names)
            raise ValueError(f"{what} and truth differ in their markers: {what} {differences}")

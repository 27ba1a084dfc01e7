"""The motion of the nearest markers between two frames as one rigid body, applied to a marker."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_LEAST = 3
_FLAT = 0.05
"""Thickness of a body, relative to its length, below which its turn about itself is unknown."""
_AT_ONCE = 4096
"""Samples that are computed together, so that memory does not grow with the take."""


def carried(
    positions: NDArray[np.float64],
    end: NDArray[np.intp],
    frame: NDArray[np.intp],
    marker: NDArray[np.intp],
    neighbours: int,
) -> NDArray[np.float64]:
    """Return markers as the motion of their neighbours carries them from one frame to another.

    Parameters
    ----------
    positions : (T, M, 3) array of float64
        Millimetres; NaN where missing.
    end : (S,) array of int
        The frames in which the markers are present. One beyond the take gives NaN.
    frame : (S,) array of int
        The frames in which the markers' positions are asked.
    marker : (S,) array of int
    neighbours
        How many of the nearest markers that are present in both frames make up the body.

    Returns
    -------
    (S, 3) array of float64
        Millimetres; NaN where there are fewer than three neighbours or they lie on a line.
    """
    places = np.full((len(frame), 3), np.nan)
    there = np.flatnonzero((end >= 0) & (end < len(positions)))
    for first in range(0, len(there), _AT_ONCE):
        some = there[first : first + _AT_ONCE]
        then, now = positions[end[some]], positions[frame[some]]
        places[some] = moved(then, now, marker[some], neighbours)
    return places


def moved(
    then: NDArray[np.float64],
    now: NDArray[np.float64],
    marker: NDArray[np.intp],
    neighbours: int,
) -> NDArray[np.float64]:
    """Return a marker as the motion of its neighbours carries it from one frame to another.

    Parameters
    ----------
    then, now : (S, M, 3) arrays of float64
        For each of S markers the frame in which it is present, and the one where it is asked.
    marker : (S,) array of int
    neighbours
        As for `carried`.

    Returns
    -------
    (S, 3) array of float64
        As for `carried`.
    """
    place = then[np.arange(len(marker)), marker]
    squared = ((then - place[:, None]) ** 2).sum(axis=2)
    # the marker itself is missing in the frame
    squared[np.isnan(then[..., 0]) | np.isnan(now[..., 0])] = np.inf
    nearest = squared.argsort(axis=1, kind="stable")[:, :neighbours, None]
    there = np.isfinite(np.take_along_axis(squared, nearest[..., 0], axis=1))[..., None]
    source = np.where(there, np.take_along_axis(then, nearest, axis=1), 0.0)
    target = np.where(there, np.take_along_axis(now, nearest, axis=1), 0.0)
    return np.asarray(_turned(place, source, target, there))


def _turned(
    place: NDArray[np.float64],
    source: NDArray[np.float64],
    target: NDArray[np.float64],
    there: NDArray[np.bool_],
) -> NDArray[np.float64]:
    """Return the place as each body's motion takes it; NaN where a body is too small or thin."""
    count = there.sum(axis=1)
    middle, goal = (body.sum(axis=1) / np.maximum(count, 1) for body in (source, target))
    source = np.where(there, source - middle[:, None], 0.0)
    target = np.where(there, target - goal[:, None], 0.0)
    u, _, v = np.linalg.svd(source.transpose(0, 2, 1) @ target)
    u[:, :, 2] *= np.linalg.det(u @ v)[:, None]
    turned = np.einsum("si,sij->sj", place - middle, u @ v) + goal
    known = (count[:, 0] >= _LEAST) & _spans_a_plane(source) & _spans_a_plane(target)
    return np.where(known[:, None], turned, np.nan)


def _spans_a_plane(body: NDArray[np.float64]) -> NDArray[np.bool_]:
    if body.shape[1] < _LEAST:
        return np.zeros(len(body), dtype=np.bool_)
    extent = np.linalg.svd(body, compute_uv=False)
    return np.asarray(extent[:, 1] > _FLAT * extent[:, 0])

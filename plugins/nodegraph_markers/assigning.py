"""Whole tracks to markers, several of which may follow one another as one marker."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_markers.tracks import UNNAMED

if TYPE_CHECKING:
    from numpy.typing import NDArray


def assign(
    distances: NDArray[np.float64], present: NDArray[np.bool_], gate: float
) -> NDArray[np.intp]:
    """Return each track's place, (K,), or -1: the best assignment, in rounds.

    A track at distance d from a place, with n frames that no track of the place has yet, is
    worth ``n (1 - (d / gate)^2)`` there, or nothing if these are less than half of its own. In
    each round every place gets one track at most, by `scipy.optimize.linear_sum_assignment`, so
    that the sum is largest; a track that would still be worth more at another place waits for
    the next.

    Parameters
    ----------
    distances
        (K, M) mm.
    present
        (T, K), the frames of each track.
    gate
        Millimetres.
    """
    from scipy.optimize import linear_sum_assignment

    nearness = np.maximum(0.0, 1.0 - (np.minimum(distances, gate) / gate) ** 2)
    named = np.full(len(nearness), UNNAMED)
    taken = np.zeros((len(present), distances.shape[1]), dtype=np.bool_)
    while (worth := _worth(nearness, present, taken)).any():
        track, place = linear_sum_assignment(worth, maximize=True)
        useful = worth[track, place] > 0
        track, place = track[useful], place[useful]
        after = taken.copy()
        after[:, place] |= present[:, track]
        later = _worth(nearness[track], present[:, track], after).max(axis=1)
        now = worth[track, place] >= later
        now |= not now.any()
        named[track[now]] = place[now]
        taken[:, place[now]] |= present[:, track[now]]
        nearness[track[now]] = 0.0
    return named


def _worth(
    nearness: NDArray[np.float64], present: NDArray[np.bool_], taken: NDArray[np.bool_]
) -> NDArray[np.float64]:
    length = present.sum(axis=0)[:, np.newaxis]
    # in float32 the product is one of BLAS, and counts up to 16 million frames are exact
    shared = present.T.astype(np.float32) @ taken.astype(np.float32)
    return np.where(2 * shared <= length, (length - shared) * nearness, 0.0)

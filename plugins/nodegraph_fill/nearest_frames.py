"""The marker's mean position in those frames in which the other markers are most alike."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph_fill.gaps import Gaps
from nodegraph_fill.tuning import Tune
from nodegraph_fill.whole_take import Estimate, whole_take
from nodegraph_mocap import Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

_MOST_FRAMES = 4000
"""Frames to choose among, evenly spread over the take."""
_AT_ONCE = 1000
"""Frames whose distances to all of these are in memory."""


@whole_take(
    "fill.nearest_frames",
    cite="troyanskaya2001",
    adapted="from Troyanskaya et al. 2001: frames take the place of genes",
    otherwise="no frame like it",
)
def nearest_frames(
    recording: Trajectories,
    gaps: Gaps,
    *,
    frames: Annotated[int, Field(ge=1), Tune(5, 20, 40)] = 5,
) -> Estimate:
    """Fill a sample with the marker's mean position in the most similar frames (Troyanskaya).

    Of the frames in which the marker is present, those whose other markers lie nearest are
    averaged, each weighted by the inverse of its distance, as `sklearn.impute.KNNImputer` does. The
    distance of two frames is the root of ``sum |P[t, i] - P[s, i]|^2`` over the markers that
    both have, made up for those that they lack; no frame need be complete. Of takes longer than
    4,000 frames, neighbours are chosen among 4,000 of them, evenly spread.

    For `ends` met, the samples beside all gaps are hidden and filled in the same way: a frame is
    most like itself.

    Frames are compared where the head is: remove its motion first, where it is large.

    Looks at the whole take.

    Parameters
    ----------
    frames
        How many frames are averaged, fewer where there are fewer.
    """
    # beside the gaps, a frame is most like itself: hide what is to be estimated there
    positions = recording.positions.copy()
    for frame in (gaps.start - 1, gaps.stop):
        within = (frame >= 0) & (frame < recording.frames)
        positions[frame[within], gaps.marker[within]] = np.nan
    origin = np.where(np.isnan(positions[..., 0]), Origin.MISSING, recording.origin)
    hidden = replace(recording, positions=positions, origin=origin, sigma=None)
    ends = gaps.beside(_imputed(hidden, frames, hidden.origin != recording.origin))
    return Estimate(_imputed(recording, frames, gaps.mask), ends=ends)


def _imputed(recording: Trajectories, frames: int, asked: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return the positions, (T, M, 3), with the missing samples that are asked for, (T, M).

    A marker that is never present stays missing.
    """
    positions, present = recording.positions.copy(), recording.present
    seen = np.flatnonzero(present.any(axis=0))
    spread = np.linspace(0, len(present) - 1, min(len(present), _MOST_FRAMES)).round()
    # of each marker some frame, should all of it lie between those that were chosen
    chosen = np.union1d(spread.astype(np.intp), present[:, seen].argmax(axis=0))
    # distances come from squares: far from the origin, their differences would lose all digits
    middle = np.nanmean(positions[:, seen], axis=0)
    places = np.where(present[:, seen, None], positions[:, seen] - middle, 0.0)
    there = present[:, seen]
    lacking, asked = np.flatnonzero(asked.any(axis=1)), asked[:, seen]
    for some in np.split(lacking, np.arange(_AT_ONCE, len(lacking), _AT_ONCE)):
        distances = _distances(places[some], there[some], places[chosen], there[chosen])
        for marker in np.flatnonzero(asked[some].any(axis=0)):
            wanted, has = asked[some, marker], there[chosen, marker]
            mean = _mean(distances[np.ix_(wanted, has)], places[chosen[has], marker], frames)
            positions[some[wanted], seen[marker]] = mean + middle[marker]
    return positions


def _distances(
    places: NDArray[np.float64],
    there: NDArray[np.bool_],
    others: NDArray[np.float64],
    others_there: NDArray[np.bool_],
) -> NDArray[np.float64]:
    """Return the distances of frames, (T, N, 3), 0 where missing, from others, (U, N, 3): (T, U).

    They are infinite where two frames have no marker in common.
    """
    shown, others_shown = there.astype(np.float64), others_there.astype(np.float64)
    square = (places**2).sum(axis=2) @ others_shown.T + shown @ (others**2).sum(axis=2).T
    square -= 2.0 * np.tensordot(places, others, axes=((1, 2), (1, 2)))
    common = shown @ others_shown.T
    mean = np.divide(square, common, out=np.full_like(square, np.inf), where=common > 0.0)
    return np.asarray(np.sqrt(np.maximum(there.shape[1] * mean, 0.0)))


def _mean(
    distances: NDArray[np.float64], places: NDArray[np.float64], frames: int
) -> NDArray[np.float64]:
    """Return the mean of the nearest places, (F, 3), by the inverse of their distances, (T, F).

    Where none is at a finite distance, it is that of all places.
    """
    count = min(frames, len(places))
    nearest = np.argpartition(distances, count - 1, axis=1)[:, :count]
    apart = np.take_along_axis(distances, nearest, axis=1)
    with np.errstate(divide="ignore"):
        weights = 1.0 / apart
    equal = (apart == 0.0).any(axis=1)
    weights[equal] = apart[equal] == 0.0
    total = weights.sum(axis=1)
    mean = np.einsum("tf,tfc->tc", weights, places[nearest])
    mean /= np.where(total, total, 1.0)[:, None]
    mean[total == 0.0] = places.mean(axis=0)
    return np.asarray(mean)

"""The marker's mean position in those frames in which the other markers are most alike."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph_fill.gaps import Gaps
from nodegraph_fill.whole_take import Estimate, whole_take
from nodegraph_mocap import Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

_MOST_FRAMES = 4000
"""Frames to choose among, evenly spread over the take."""


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
    frames: Annotated[int, Field(ge=1)] = 5,
) -> Estimate:
    """Fill a sample with the marker's mean position in the most similar frames (Troyanskaya).

    Of the frames in which the marker is present, those whose other markers lie nearest are
    averaged, each weighted by the inverse of its distance, by `sklearn.impute.KNNImputer`. The
    distance of two frames is the root of ``sum |P[t, i] - P[s, i]|^2`` over the markers that
    both have, made up for those that they lack; no frame need be complete. Of takes longer than
    4,000 frames, neighbours are chosen among 4,000 of them, evenly spread.

    For `ends` met, the samples beside all gaps are hidden and filled in the same way, which takes
    as long again: a frame is most like itself.

    Frames are compared where the head is: remove its motion first, where it is large.

    Looks at the whole take.

    Parameters
    ----------
    frames
        How many frames are averaged, fewer where there are fewer.
    """

    def beside() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        # a frame is most like itself: hide what is to be estimated there
        positions = recording.positions.copy()
        for frame in (gaps.start - 1, gaps.stop):
            within = (frame >= 0) & (frame < recording.frames)
            positions[frame[within], gaps.marker[within]] = np.nan
        origin = np.where(np.isnan(positions[..., 0]), Origin.MISSING, recording.origin)
        hidden = replace(recording, positions=positions, origin=origin, sigma=None)
        return gaps.beside(_imputed(hidden, frames))

    return Estimate(_imputed(recording, frames), ends=beside)


def _imputed(recording: Trajectories, frames: int) -> NDArray[np.float64]:
    """Return the positions, (T, M, 3), with no sample missing of a marker that is ever present."""
    from sklearn.impute import KNNImputer

    seen = recording.present.any(axis=0)
    rows = recording.positions[:, seen].reshape(recording.frames, -1)
    # distances come from squares: far from the origin, their differences would lose all digits
    middle = np.nanmean(rows, axis=0)
    rows = rows - middle
    spread = np.linspace(0, len(rows) - 1, min(len(rows), _MOST_FRAMES)).round().astype(np.intp)
    # of each marker some frame, should all of it lie between those that were chosen
    spread = np.union1d(spread, recording.present[:, seen].argmax(axis=0))
    imputer = KNNImputer(n_neighbors=frames, weights="distance").fit(rows[spread])
    lacking = ~recording.present[:, seen].all(axis=1)
    positions = recording.positions.copy()
    if not lacking.any():
        return positions
    imputed = imputer.transform(rows[lacking]) + middle
    positions[np.ix_(lacking, seen)] = imputed.reshape(-1, np.count_nonzero(seen), 3)
    return positions

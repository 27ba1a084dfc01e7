"""The marker's mean position in those frames in which the other markers are most alike."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import node
from nodegraph_fill.gaps import Gaps, MaxGap
from nodegraph_fill.whole_take import Estimate, fill_from
from nodegraph_mocap import Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

_MOST_FRAMES = 4000
"""Frames to choose among, evenly spread over the take."""


@node(
    "fill.nearest_frames",
    cite="troyanskaya2001",
    adapted="from Troyanskaya et al. 2001: frames take the place of genes",
    lookahead=None,
    ends=False,
)
def nearest_frames(
    recording: Trajectories,
    *,
    frames: Annotated[int, Field(ge=1)] = 5,
    max_gap: MaxGap = None,
) -> Trajectories:
    """Fill a sample with the marker's mean position in the most similar frames (Troyanskaya).

    Of the frames in which the marker is present, those whose other markers lie nearest are
    averaged, each weighted by the inverse of its distance, by `sklearn.impute.KNNImputer`. The
    distance of two frames is the root of ``sum |P[t, i] - P[s, i]|^2`` over the markers that
    both have, made up for those that they lack; no frame need be complete. Of takes longer than
    4,000 frames, so many are chosen among, evenly spread.

    Where a marker is never measured, it stays missing, counted in a warning. Samples that are
    present come out as they went in; those that an earlier fill has made count like measured
    ones. Frames are compared where the head is: remove its motion first, where it is large.

    Looks at the whole take.

    Parameters
    ----------
    recording
        Trajectories with gaps.
    frames
        How many frames are averaged, fewer where there are fewer.
    max_gap
        Gaps longer than this stay missing; none: gaps of any length are filled. A gap is a run
        of missing samples of one marker.

    Returns
    -------
    Trajectories
        The recording with filled samples, their origin `Origin.FILLED`.
    """

    def model(recording: Trajectories, gaps: Gaps) -> Estimate:
        return Estimate(_imputed(recording, frames))

    return fill_from(recording, max_gap, model, bend=False, otherwise="no frame like it")


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
    imputed = imputer.transform(rows[lacking]) + middle
    positions[np.ix_(lacking, seen)] = imputed.reshape(-1, np.count_nonzero(seen), 3)
    return positions

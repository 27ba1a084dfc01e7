"""Several fills, averaged by how plausible each is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import node
from nodegraph_combine.recording_stack import RecordingStack, Several, stack_recordings
from nodegraph_mocap import Trajectories
from nodegraph_mocap.frame_ranges import runs_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

_LEAST_SPREAD = 1e-3
"""Smallest variation of a distance that is assumed, relative to the distance."""


@node(
    "combine.ensemble",
    cite="tits2018",
    adapted="from Tits et al. 2018: plausibility comes from distances to neighbours alone",
    lookahead=None,
    shares=Several,
)
def ensemble(several: Several, *, neighbours: Annotated[int, Field(ge=1)] = 5) -> Trajectories:
    """Average several fills, each weighted by how plausible its distances are (after Tits et al.).

    Where the recordings differ in a marker m, from frame a to frame b, its neighbours are the
    markers i whose distance to it varies least, relative to its mean, in the frames in which all
    recordings have both alike; ``mu_i`` and ``s_i`` are the mean and the standard deviation of
    that distance there, ``s_i`` being a thousandth of ``mu_i`` at least. The weight of recording
    c is ``exp(-z_c / 2)``, with z_c the mean of ``((|P_c[t, m] - P[t, i]| - mu_i) / s_i)^2`` over
    a to b and over those neighbours that all recordings have alike there: what is left of a
    normal density, the same for all frames of the gap so that nothing jumps. The sample is the
    weighted mean of the recordings that have it.

    Without any such neighbour the weights are equal. What all recordings have alike comes out
    bit for bit, and what none has stays missing. Markers are matched by name. Recordings that
    were refused or failed are named in a warning.

    Looks at the whole take.

    Parameters
    ----------
    neighbours
        How many markers tell how plausible a fill is, fewer where there are fewer.
    """
    all_of_them = stack_recordings(several)
    known = all_of_them.shared & ~np.isnan(all_of_them.positions[0, ..., 0])
    positions = np.full_like(all_of_them.first.positions, np.nan)
    for marker in np.flatnonzero(~all_of_them.shared.all(axis=0)):
        usual = _usual(all_of_them.positions[0], known, int(marker), neighbours)
        _, starts, stops = runs_of(~all_of_them.shared[:, marker])
        for frames in map(slice, starts.tolist(), stops.tolist()):
            weight = _weights(all_of_them, known, int(marker), frames, usual)
            positions[frames, marker] = _weighted(all_of_them.positions[:, frames, marker], weight)
    return all_of_them.with_samples(positions)


def _usual(
    positions: NDArray[np.float64], known: NDArray[np.bool_], marker: int, neighbours: int
) -> tuple[NDArray[np.intp], NDArray[np.float64], NDArray[np.float64]]:
    """Return the markers whose distance varies least, its mean and its standard deviation."""
    both = known & known[:, [marker]]
    distance = np.linalg.norm(positions - positions[:, [marker]], axis=2)
    count = np.maximum(both.sum(axis=0), 1)
    mean = np.where(both, distance, 0.0).sum(axis=0) / count
    spread = np.sqrt((np.where(both, distance - mean, 0.0) ** 2).sum(axis=0) / count)
    usable = (both.sum(axis=0) > 1) & (mean > 0.0)
    usable[marker] = False
    relative = np.where(usable, spread / np.where(mean > 0.0, mean, 1.0), np.inf)
    chosen = relative.argsort(kind="stable")[: min(neighbours, np.count_nonzero(usable))]
    return chosen, mean[chosen], np.maximum(spread, _LEAST_SPREAD * mean)[chosen]


def _weights(
    all_of_them: RecordingStack,
    known: NDArray[np.bool_],
    marker: int,
    frames: slice,
    usual: tuple[NDArray[np.intp], NDArray[np.float64], NDArray[np.float64]],
) -> NDArray[np.float64]:
    """Return the weight of each recording, (C,), the largest being 1."""
    chosen, mean, spread = usual
    here = all_of_them.positions[:, frames, marker, None]
    distance = np.linalg.norm(here - all_of_them.positions[0, frames][:, chosen], axis=3)
    squared = ((distance - mean) / spread) ** 2
    there = known[frames][:, chosen] & ~np.isnan(squared)
    count = there.sum(axis=(1, 2))
    apart = np.where(there, squared, 0.0).sum(axis=(1, 2)) / np.maximum(count, 1)
    # relative to the most plausible, since all may be so implausible that none has any weight
    return np.asarray(np.exp((apart.min() - apart) / 2.0))


def _weighted(samples: NDArray[np.float64], weight: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the weighted mean, (F, 3), of the samples, (C, F, 3), that are there."""
    share = np.where(np.isnan(samples), 0.0, weight[:, None, None])
    # a recording alone counts, however little its weight
    share = np.where(share.sum(axis=0) > 0.0, share, (~np.isnan(samples)).astype(np.float64))
    total = share.sum(axis=0)
    mixed = (share * np.nan_to_num(samples)).sum(axis=0)
    return np.where(total > 0.0, mixed / np.where(total > 0.0, total, 1.0), np.nan)

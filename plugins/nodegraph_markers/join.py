"""Two takes as one."""

from __future__ import annotations

import math
import warnings
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import listed, node
from nodegraph_mocap import Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

_SAME_RATE = 1e-6


@node("recording.join")
def join(recording: Trajectories, following: Trajectories) -> Trajectories:
    """Put one take after another, as if the camera had run on.

    Markers are matched by name. A marker that only one of the takes has is missing in the other,
    and a warning says which. Nothing is moved or blended: where the takes do not meet, there is
    a jump, which despiking and smoothing see.

    Parameters
    ----------
    recording
        The first take.
    following
        The second take, of the same rate.

    Returns
    -------
    Trajectories
        The markers of the first, then those that only the second has; the marker set of the
        first.

    Raises
    ------
    ValueError
        If the rates differ, or no marker is in both.
    """
    if not math.isclose(recording.rate, following.rate, rel_tol=_SAME_RATE):
        raise ValueError(
            f"the first take has {recording.rate:g} Hz, the following {following.rate:g} Hz: "
            "resample one of them (recording.resample)"
        )
    new = [name for name in following.markers if name not in recording.markers]
    if len(new) == len(following.markers):
        raise ValueError(
            f"no marker is in both: the first has {listed(recording.markers)}, the following has "
            f"{listed(following.markers)}"
        )
    lost = [name for name in recording.markers if name not in following.markers]
    _warn(lost, new)
    markers = (*recording.markers, *new)
    takes = (recording, following)
    return Trajectories(
        positions=np.concatenate(
            [_spread(take, take.positions, markers, np.nan) for take in takes]
        ),
        markers=markers,
        rate=recording.rate,
        marker_set=recording.marker_set,
        origin=np.concatenate(
            [_spread(take, take.origin, markers, Origin.MISSING) for take in takes]
        ),
        sigma=None
        if recording.sigma is following.sigma is None
        else np.concatenate([_spread(take, _sigma(take), markers, np.nan) for take in takes]),
    )


def _spread(
    take: Trajectories, samples: NDArray[np.generic], markers: tuple[str, ...], missing: float
) -> NDArray[np.generic]:
    """Return a take's samples in columns of these markers; those it lacks hold `missing`."""
    shape = (take.frames, len(markers), *samples.shape[2:])
    spread = np.full(shape, missing, dtype=samples.dtype)
    spread[:, [markers.index(name) for name in take.markers]] = samples
    return spread


def _sigma(take: Trajectories) -> NDArray[np.float64]:
    return np.full(take.origin.shape, np.nan) if take.sigma is None else take.sigma


def _warn(lost: list[str], new: list[str]) -> None:
    sides = (("following", lost), ("first", new))
    messages = [
        f"{len(names)} markers are missing in the {which} take, which does not have them: "
        f"{listed(names)}"
        for which, names in sides
        if names
    ]
    if messages:
        warnings.warn("; ".join(messages), stacklevel=3)

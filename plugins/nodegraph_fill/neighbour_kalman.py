"""A Kalman filter of each marker, which its neighbours help where it is missing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import Unit, node
from nodegraph_fill.gaps import Gaps, MaxGap, to_limit
from nodegraph_fill.rigid_motion import carried
from nodegraph_fill.whole_take import Estimate, fill_from
from nodegraph_mocap import Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

Noise = Annotated[float, Field(gt=0, allow_inf_nan=False), Unit("mm")]


@node(
    "fill.neighbour_kalman",
    cite="aristidou2008",
    adapted=(
        "from Aristidou et al. 2008: the nearest markers take the place of those of a limb, "
        "three at least"
    ),
    lookahead=to_limit,
    ends=False,
)
def neighbour_kalman(
    recording: Trajectories,
    *,
    neighbours: Annotated[int, Field(ge=3)] = 6,
    acceleration: Annotated[float, Field(gt=0, allow_inf_nan=False), Unit("mm/s^2")] = 1000.0,
    noise: Noise = 0.1,
    neighbour_noise: Noise = 1.0,
    max_gap: MaxGap = None,
) -> Trajectories:
    """Predict missing markers by a Kalman filter that neighbours help (Aristidou et al., 2008).

    Each coordinate of a marker has a position and a velocity, constant but for an acceleration
    that is drawn anew for each frame: ``x[t+1] = [[1, T], [0, 1]] x[t] + a [T^2 / 2, T]``, T
    being the time of a frame and a normal with the standard deviation `acceleration`. Where the
    marker is present, the filter observes its position, with `noise`. Where it is missing, it
    observes where its neighbours would take it, with `neighbour_noise`, and the sample is what the
    filter then has: a prediction from the marker's own motion at first, from its neighbours'
    the longer the gap lasts.

    The neighbours tell the position of a rigid body: those nearest to the marker in frame a,
    the last in which it was present, among all that are present both there and at frame t, are
    fitted by the rigid motion that minimizes ``sum |R P[a, i] + c - P[t, i]|^2``, and tell
    ``R P[a, m] + c``.

    Of the original only the idea is taken, a Kalman filter combined with what the neighbouring
    markers tell. There the neighbours are the markers of the same limb, which keep their
    distances; here, where there are no limbs, they are the nearest ones. Its way to tell the
    position from fewer than three neighbours is left out: there the sample stays missing, and
    so it does where they lie on a line (their second principal extent is under a twentieth of
    the first). That is counted in a warning, as is a marker that is never measured.

    Samples that are present come out as they went in; those that an earlier fill has made count
    like measured ones. Does not depend on where the origin lies or how the axes are turned; on
    the unit it does, by the three settings in mm.

    Causal: a sample depends on its frame and on earlier ones, no frame ahead. Only gaps at the
    start of the take are filled backward in time, in the same way, from the frames up to the
    marker's next gap.

    Parameters
    ----------
    recording
        Trajectories with gaps.
    neighbours
        How many markers make up the body, fewer where there are fewer, three at least; equally
        near ones go by marker order.
    acceleration
        Standard deviation of the acceleration, per coordinate: how quickly a marker may change
        its velocity.
    noise
        Standard deviation of a present sample, per coordinate.
    neighbour_noise
        Standard deviation of what the neighbours tell, per coordinate: the larger, the longer
        the marker's own motion counts.
    max_gap
        Gaps longer than this stay missing; none: gaps of any length are filled. A gap is a run
        of missing samples of one marker.

    Returns
    -------
    Trajectories
        The recording with filled samples, their origin `Origin.FILLED`.
    """

    def model(recording: Trajectories, gaps: Gaps) -> Estimate:
        from nodegraph_fill.neighbour_kalman_kernel import follow

        observations = _observations(recording, gaps, neighbours)
        variance = np.where(recording.present, noise, neighbour_noise) ** 2
        positions = np.full_like(observations, np.nan)
        for marker in np.unique(gaps.marker[~gaps.at_start]):
            observed, spread = observations[:, marker].copy(), variance[:, marker].copy()
            # the frames before the marker is seen are not asked forward in time
            observed[: recording.present[:, marker].argmax()] = np.nan
            positions[:, marker] = follow(observed, spread, 1.0 / recording.rate, acceleration)
        for marker, stop in zip(gaps.marker[gaps.at_start], gaps.stop[gaps.at_start], strict=True):
            rest = ~recording.present[stop:, marker]
            last = stop + int(rest.argmax()) if rest.any() else recording.frames
            observed, spread = (
                observations[:last, marker][::-1].copy(),
                variance[:last, marker][::-1].copy(),
            )
            backward = follow(observed, spread, 1.0 / recording.rate, acceleration)[::-1]
            positions[:stop, marker] = backward[:stop]
        return Estimate(np.where(np.isnan(observations), np.nan, positions))

    otherwise = "no three neighbours that span a plane"
    return fill_from(recording, max_gap, model, bend=False, otherwise=otherwise)


def _observations(recording: Trajectories, gaps: Gaps, neighbours: int) -> NDArray[np.float64]:
    """Return the positions with estimates from the neighbours in the gaps, (T, M, 3)."""
    gap, frame, marker, _ = gaps.samples
    seen = np.where(gaps.at_start, gaps.stop, gaps.start - 1)[gap]
    observations = recording.positions.copy()
    observations[frame, marker] = carried(recording, seen, frame, marker, neighbours)
    return observations

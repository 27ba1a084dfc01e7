"""A Kalman filter of each marker, which its neighbours help where it is missing."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import StateForm, Unit
from nodegraph_fill.gaps import Gaps, to_gap_end, to_limit
from nodegraph_fill.meet_ends import are_met
from nodegraph_fill.rigid_motion import carried, moved
from nodegraph_fill.streams import Limit
from nodegraph_fill.tuning import Tune, unless_tuned
from nodegraph_fill.whole_take import Estimate, whole_take
from nodegraph_mocap import MarkerFrame, Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

Noise = Annotated[float, Field(gt=0, allow_inf_nan=False), Unit("mm")]


def _lookahead(settings: Mapping[str, object]) -> int | None:
    return to_gap_end(settings) if are_met(settings) else to_limit(settings)


def _live_lookahead(settings: Mapping[str, object]) -> int | None:
    return None if are_met(settings) else to_limit(settings)


class _Stream:
    """The filter of every marker forward in time, frame by frame."""

    def __init__(
        self,
        recording: Trajectories,
        *,
        neighbours: int,
        acceleration: float,
        noise: float,
        neighbour_noise: float,
        ends: object,
        max_gap: int | None,
        settings: object,
    ) -> None:
        markers = len(recording.markers)
        self.header = recording
        self._limit = Limit(markers, max_gap)
        self._neighbours = neighbours
        self._noises = neighbour_noise**2, noise**2
        self._motion = 1.0 / recording.rate, acceleration
        self._position = np.full((markers, 3), np.nan)
        self._velocity, self._spread = np.zeros((2, markers, 3))
        self._before = np.full((markers, 3), np.nan)
        """The frame before."""
        self._seen: list[NDArray[np.float64] | None] = [None] * markers
        """For each missing marker, the last frame in which it was present, if there is one."""

    def push(self, frame: MarkerFrame) -> MarkerFrame | None:
        known = self._limit.push(frame)
        return None if known is None else self._filtered(*known)

    def drain(self) -> Iterable[MarkerFrame]:
        return [self._filtered(*known) for known in self._limit.drain()]

    def _filtered(self, frame: MarkerFrame, wanted: NDArray[np.bool_]) -> MarkerFrame:
        from nodegraph_fill import neighbour_kalman_kernel

        present = frame.present
        for marker in np.flatnonzero(~present & ~np.isnan(self._before[:, 0])):
            self._seen[marker] = self._before
        self._before = frame.positions
        seen = [marker for marker in np.flatnonzero(wanted) if self._seen[marker] is not None]
        observations, filled = frame.positions, wanted & False
        if seen:
            column = np.array(seen)
            then = np.array([self._seen[marker] for marker in seen])
            now = np.broadcast_to(frame.positions, then.shape)
            observations = frame.positions.copy()
            observations[column] = moved(then, now, column, self._neighbours)
            filled[column] = ~np.isnan(observations[column, 0])
        neighbours, own = self._noises
        neighbour_kalman_kernel.advance(
            self._position,
            self._velocity,
            self._spread,
            observations,
            np.where(present, own, neighbours),
            *self._motion,
        )
        return MarkerFrame(
            np.where(filled[:, None], self._position, frame.positions),
            frame.marked(filled, Origin.FILLED),
            frame.sigma,
        )


@whole_take(
    "fill.neighbour_kalman",
    cite="aristidou2008",
    adapted=(
        "from Aristidou et al. 2008: the nearest markers take the place of those of a limb, "
        "three at least"
    ),
    lookahead=_lookahead,
    live=StateForm(
        _Stream, lookahead=unless_tuned(_live_lookahead), leaves="gaps at the start of the take"
    ),
    otherwise="no three neighbours that span a plane",
)
def neighbour_kalman(
    recording: Trajectories,
    gaps: Gaps,
    *,
    neighbours: Annotated[int, Field(ge=3), Tune(4, 6, 10)] = 6,
    acceleration: Annotated[
        float,
        Field(gt=0, allow_inf_nan=False),
        Unit("mm/s^2"),
        Tune(times=(0.3, 3.0)),
    ] = 1000.0,
    noise: Noise = 0.1,
    neighbour_noise: Annotated[Noise, Tune(times=(0.3, 3.0))] = 1.0,
) -> Estimate:
    """Predict missing markers by a Kalman filter that neighbours help (Aristidou et al., 2008).

    Each coordinate of a marker has a position and a velocity, constant but for an acceleration
    that is drawn again for each frame: ``x[t+1] = [[1, T], [0, 1]] x[t] + a [T^2 / 2, T]``, T
    being the time of a frame and a normal with the standard deviation `acceleration`. Where the
    marker is present, the filter observes its position, with `noise`. Where it is missing, it
    observes where its neighbours would take it, with `neighbour_noise`, and the sample is what the
    filter then has: a prediction from the marker's own motion at first, from its neighbours'
    the longer the gap lasts.

    The neighbours predict the position of a rigid body: those nearest to the marker in frame a,
    the last in which it was present, among all that are present both there and at frame t, are
    fitted by the rigid motion that minimizes ``sum |R P[a, i] + c - P[t, i]|^2``, and predict
    ``R P[a, m] + c``.

    Of the original only the idea is taken, a Kalman filter combined with what the neighbouring
    markers predict. There the neighbours are the markers of the same limb, which keep their
    distances; here, where there are no limbs, they are the nearest ones. Its way to predict the
    position from fewer than three neighbours is left out: there the sample stays missing, and
    so it does where they lie on a line (their second principal extent is under a twentieth of
    the first). That is counted in a warning. For `ends` met, the estimate beside a gap is the
    filter's in the frame before, and what it predicts for the frame after.

    Does not depend on where the origin lies or how the axes are turned; on
    the unit it does, by the three settings in mm.

    Causal: a sample depends on its frame and on earlier ones, no frame ahead, unless `max_gap`
    or `ends` met need the gap's end. Only gaps at the start of the take are filled backward in
    time, in the same way, from the frames up to the marker's next gap.

    Parameters
    ----------
    neighbours
        How many markers make up the body, fewer where there are fewer, three at least; equally
        near ones go by marker order.
    acceleration
        Standard deviation of the acceleration, per coordinate: how quickly a marker may change
        its velocity.
    noise
        Standard deviation of a present sample, per coordinate.
    neighbour_noise
        Standard deviation of what the neighbours predict, per coordinate: the larger, the longer
        the marker's own motion counts.
    """
    return _Filter(recording, gaps, neighbours, acceleration, noise, neighbour_noise).estimate()


class _Filter:
    """The filter of every marker, and what it observes."""

    def __init__(
        self,
        recording: Trajectories,
        gaps: Gaps,
        neighbours: int,
        acceleration: float,
        noise: float,
        neighbour_noise: float,
    ) -> None:
        self._recording, self._gaps, self._neighbours = recording, gaps, neighbours
        self._acceleration, self._neighbour_noise = acceleration, neighbour_noise
        self._observations = _observations(recording, gaps, neighbours)
        self._variance = np.where(recording.present, noise, neighbour_noise) ** 2

    def estimate(self) -> Estimate:
        """Return the estimates in the gaps, and beside them."""
        gaps = self._gaps
        positions = np.full_like(self._observations, np.nan)
        after = np.full((len(gaps.start), 3), np.nan)
        for marker in np.unique(gaps.marker[~gaps.at_start]):
            positions[:, marker] = self._forward(marker)
        for gap in np.flatnonzero(gaps.at_start):
            marker, stop = gaps.marker[gap], gaps.stop[gap]
            backward = self._backward(marker, stop)
            positions[:stop, marker], after[gap] = backward[:stop], backward[stop]
        positions[np.isnan(self._observations)] = np.nan
        after[gaps.inner] = self._predicted(gaps.subset(gaps.inner))
        return Estimate(positions, ends=(gaps.beside(positions)[0], after))

    def _forward(self, marker: int) -> NDArray[np.float64]:
        return self._follow(self._observed(marker), self._variance[:, marker])

    def _backward(self, marker: int, stop: int) -> NDArray[np.float64]:
        """Return what is filtered backward in time, from the marker's next gap on."""
        rest = ~self._recording.present[stop:, marker]
        last = stop + int(rest.argmax()) if rest.any() else self._recording.frames
        observed, variance = self._observations[:last, marker], self._variance[:last, marker]
        return self._follow(observed[::-1], variance[::-1])[::-1]

    def _predicted(self, gaps: Gaps) -> NDArray[np.float64]:
        """Return what the filter would have after each gap if the marker were still missing."""
        positions = self._recording.positions
        body = carried(positions, gaps.start - 1, gaps.stop, gaps.marker, self._neighbours)
        after = np.full_like(body, np.nan)
        for gap in np.flatnonzero(~np.isnan(body[:, 0])):
            marker, stop = gaps.marker[gap], gaps.stop[gap]
            observed, variance = self._observed(marker), self._variance[:, marker].copy()
            observed[stop], variance[stop] = body[gap], self._neighbour_noise**2
            after[gap] = self._follow(observed[: stop + 1], variance[: stop + 1])[stop]
        return after

    def _observed(self, marker: int) -> NDArray[np.float64]:
        observed = self._observations[:, marker].copy()
        # the frames before the marker is seen are not asked forward in time
        observed[: self._recording.present[:, marker].argmax()] = np.nan
        return observed

    def _follow(
        self, observed: NDArray[np.float64], variance: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        from nodegraph_fill.neighbour_kalman_kernel import follow

        seconds = 1.0 / self._recording.rate
        return np.asarray(follow(observed.copy(), variance.copy(), seconds, self._acceleration))


def _observations(recording: Trajectories, gaps: Gaps, neighbours: int) -> NDArray[np.float64]:
    """Return the positions with estimates from the neighbours in the gaps, (T, M, 3)."""
    gap, frame, marker, _ = gaps.samples
    seen = np.where(gaps.at_start, gaps.stop, gaps.start - 1)[gap]
    observations = recording.positions.copy()
    observations[frame, marker] = carried(recording.positions, seen, frame, marker, neighbours)
    return observations

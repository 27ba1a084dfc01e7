"""A Kalman filter forward in time, which sees no frame ahead."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import StateForm, node, read_only
from nodegraph_mocap import MarkerFrame, Trajectories
from nodegraph_smooth.kalman import Driven, Motion, components, density_of
from nodegraph_smooth.present_runs import Runs, smooth_runs

if TYPE_CHECKING:
    from numpy.typing import NDArray

_TOLERANCE = 1e-14
"""Change of a gain from frame to frame below which it counts as constant."""


class _Stream:
    """The filter frame by frame."""

    def __init__(
        self, recording: Trajectories, *, cutoff: float, motion: Motion, noise: float
    ) -> None:
        self._gains, self._spread = _gains(recording.rate, cutoff, motion)
        self._noise = noise
        markers = len(recording.markers)
        self.header = replace(recording, sigma=np.empty((0, markers)))
        self._first = np.full((markers, 3), np.nan)
        """Of each marker's run, from which the others are counted; NaN where it is missing."""
        self._age = np.zeros(markers, dtype=np.intp)
        """Frames since then."""
        self._state = np.zeros((markers, 3, self._gains.shape[1]))

    def push(self, frame: MarkerFrame) -> MarkerFrame:
        from nodegraph_smooth import kalman_kernel

        present = frame.present
        begins = present & np.isnan(self._first[:, 0])
        self._age = np.where(begins, 0, self._age + 1)
        self._first[~present] = np.nan
        self._first[begins] = frame.positions[begins]
        self._state[begins] = 0.0
        relative = frame.positions - self._first
        kalman_kernel.advance(self._state, relative, self._age, self._gains)
        spread = self._spread[np.minimum(self._age, len(self._spread) - 1)]
        return MarkerFrame(
            self._first + self._state[..., 0],
            frame.origin.copy(),
            np.where(present, self._noise * spread, np.nan),
        )

    def drain(self) -> Iterable[MarkerFrame]:
        return ()


@node(
    "smooth.kalman_filter",
    cite=("kalman1960", "bar_shalom2001"),
    lookahead=0,
    live=StateForm(_Stream),
    shares=Driven,
)
def kalman_filter(driven: Driven) -> Trajectories:
    """Smooth causally by a Kalman filter: it lags, sees no frame ahead, and gives sigma.

    The model is that of `smooth.kalman`: each coordinate has a state x of d components, position
    and velocity (d = 2) or acceleration too (d = 3), ``x[t+1] = F x[t] + w`` with w of covariance
    Q, and a sample z is the position plus noise of variance r. Where that node's output knows all
    samples of a run, this one's knows those up to its frame: with the prediction ``y = F x[t-1]``
    and its covariance ``M = F P[t-1] F' + Q``, ``x[t] = y + K (z[t] - y[0])`` and
    ``P[t] = (I - K H) M``, with ``K = M H' / (H M H' + r)`` and H the first unit vector. Nothing
    is known of the state before the first frame: the first d samples of a run stay as they are.

    q is chosen as in `smooth.kalman`, such that the smoother, not the filter, keeps half of the
    amplitude at the cut-off. The filter keeps more of what is above it, and lags.

    A gap splits a trajectory into runs, each filtered by itself, however short. Nothing is filled.

    Looks ahead 0 frames.

    Parameters
    ----------
    cutoff
        The frequency of which `smooth.kalman` keeps half the amplitude.
    """
    recording = driven.recording
    gains, spread = _gains(recording.rate, driven.cutoff, driven.motion)

    def filtered(block: NDArray[np.float64]) -> NDArray[np.float64]:
        from nodegraph_smooth import kalman_kernel

        return np.asarray(kalman_kernel.follow(np.ascontiguousarray(block), gains))

    sigma = np.full(recording.origin.shape, np.nan)
    for length, alike in Runs.of(recording).by_length():
        age = np.minimum(np.arange(length), len(spread) - 1)
        sigma[alike.samples()] = driven.noise * spread[age, None]
    return replace(smooth_runs(recording, filtered), sigma=sigma)


@lru_cache
def _gains(
    rate: float, cutoff: float, motion: Motion
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return K in each frame of a run, (T, d), and the standard deviation of the position, (T,).

    Both stay as they are in the last. Time is counted in frames and r is 1. What is unknown has
    an infinite variance, which is followed apart from the finite one.
    """
    from nodegraph_smooth.kalman_kernel import transition

    order = components(motion)
    step, noise = transition(order, density_of(cutoff, rate, order))
    known, unknown = np.zeros((order, order)), np.eye(order)
    gains, variances = [np.zeros(order)], [np.inf]
    while len(gains) <= order + 1 or np.abs(gains[-1] - gains[-2]).max() > _TOLERANCE:
        if len(gains) > 1:
            known, unknown = step @ known @ step.T + noise, step @ unknown @ step.T
        if len(gains) <= order:
            gain = unknown[:, 0] / unknown[0, 0]
        else:
            gain = known[:, 0] / (known[0, 0] + 1.0)
        left = np.eye(order)
        left[:, 0] -= gain
        known = left @ known @ left.T + np.outer(gain, gain)
        unknown = left @ unknown @ left.T
        gains.append(gain)
        variances.append(known[0, 0])
    return read_only(np.array(gains[1:])), read_only(np.sqrt(variances[1:]))

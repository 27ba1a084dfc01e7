"""A Kalman filter forward, and the Rauch-Tung-Striebel smoother backward."""

from __future__ import annotations

import math
from dataclasses import KW_ONLY, dataclass, replace
from typing import Annotated, Literal, get_args

import numpy as np
from pydantic import Field

from nodegraph import Unit, node
from nodegraph_mocap import Trajectories
from nodegraph_smooth.bspline_weights import middle
from nodegraph_smooth.cutoff import Cutoff, angle, check_stiffness
from nodegraph_smooth.present_runs import Runs, Smoothing, long_enough

Motion = Literal["velocity", "acceleration"]


@dataclass(frozen=True)
class Driven(Smoothing):
    """A recording that is smoothed as the positions of markers which white noise drives.

    Attributes
    ----------
    cutoff
        The frequency of which half the amplitude is kept.
    motion
        The motion that a marker would keep if nothing drove it: its velocity, or its acceleration.
    noise
        Standard deviation of a sample, per coordinate. Positions do not depend on it, sigma is
        proportional to it.

    Returns
    -------
    Trajectories
        The recording with other positions, and with `sigma`, the standard deviation of each
        sample per coordinate as the model has it.

    Raises
    ------
    Refusal
        If the cut-off is not below half the frame rate or too low to be computed.
    ValueError
        If `motion` is not one of its choices or `noise` not positive.
    """

    _: KW_ONLY
    cutoff: Cutoff = 10.0
    motion: Motion = "velocity"
    noise: Annotated[float, Field(gt=0.0, allow_inf_nan=False), Unit("mm")] = 0.1

    def __post_init__(self) -> None:
        if not self.noise > 0.0:
            raise ValueError(f"noise must be a positive number of mm, got {self.noise}")


@node("smooth.kalman", cite=("rauch1965", "bar_shalom2001"), lookahead=None, shares=Driven)
def kalman(driven: Driven) -> Trajectories:
    """Smooth by a Kalman filter and the smoother of Rauch, Tung & Striebel; gives sigma.

    Each coordinate has a state x of d components, position and velocity (d = 2) or acceleration
    too (d = 3), whose last one is driven by white noise of density q: ``x[t+1] = F x[t] + w``,
    ``F[i, j] = T^(j-i) / (j-i)!`` with T the time of a frame, and ``w`` of covariance
    ``Q[i, j] = q T^(2d-1-i-j) / ((d-1-i)! (d-1-j)! (2d-1-i-j))`` (Bar-Shalom et al.). A sample
    is the position plus noise of variance ``noise^2``. Nothing is known of the state before the
    first frame. The output is the mean of the position, all samples of the run being known; it
    is also the smoothing spline of degree 2 d - 1.

    Only the ratio of q to ``noise^2`` matters to that mean. Away from the ends it keeps
    ``1 / (1 + noise^2 / (q S(w)))`` of the amplitude at w radians per frame, with
    ``S(w) = T^(2d-1) sum(b[k] cos(k w)) / (2 sin(w / 2))^(2 d)`` and b the weights of
    `smooth.bspline` of order 2 d - 1; q is chosen such that half of it is kept at the cut-off.

    A gap splits a trajectory into runs, each smoothed by itself; those of fewer than d samples
    stay as they are, counted in a warning, with the sigma that they have or else that of a
    measurement. Nothing is filled.

    Looks ahead to the end of the run; what lies ``rate / cutoff`` frames ahead counts for
    little.

    Raises
    ------
    Refusal
        If the cut-off is not below half the frame rate or too low to be computed, or every run
        is too short.
    """
    recording, order = driven.recording, components(driven.motion)
    density = density_of(driven.cutoff, recording.rate, order)
    return _smoothed(recording, order, density, driven.noise)


def components(motion: Motion) -> int:
    """Return d, how many components the state has.

    Raises
    ------
    ValueError
        If `motion` is not one of its choices.
    """
    if motion not in get_args(Motion):
        raise ValueError(f"motion must be {' or '.join(get_args(Motion))}, got {motion!r}")
    return 2 + get_args(Motion).index(motion)


def density_of(cutoff: float, rate: float, order: int) -> float:
    """Return q, time in frames and the variance of a sample 1, for half the amplitude at a cut-off.

    Raises
    ------
    Refusal
        If the cut-off is not below half the frame rate or too low to be computed.
    """
    density = 1.0 / _spectrum(angle(cutoff, rate), order)
    check_stiffness(1.0 / density, cutoff, rate)
    return density


def _spectrum(width: float, order: int) -> float:
    """Return S, in frames: the spectrum of the sampled position where the density is 1."""
    weights = middle(2 * order - 1)
    symbol = 1.0 + 2.0 * sum(
        weight * (math.cos(k * width) - 1.0) for k, weight in enumerate(weights, 1)
    )
    return float(symbol / (2.0 * math.sin(width / 2.0)) ** (2 * order))


def _smoothed(recording: Trajectories, order: int, density: float, noise: float) -> Trajectories:
    from nodegraph_smooth import kalman_kernel

    positions = recording.positions.copy()
    measured = np.where(recording.present, noise, np.nan)
    sigma = measured if recording.sigma is None else recording.sigma.copy()
    for length, alike in long_enough(Runs.of(recording), order).by_length():
        *matrices, variance = kalman_kernel.gains(length, order, density)
        where = alike.samples()
        block = positions[where]
        flat = (block - block[0]).reshape(length, -1)
        positions[where] = block[0] + kalman_kernel.smooth(flat, *matrices).reshape(block.shape)
        sigma[where] = noise * np.sqrt(variance)[:, None]
    return replace(recording, positions=positions, sigma=sigma)

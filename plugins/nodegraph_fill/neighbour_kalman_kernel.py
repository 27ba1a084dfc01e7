"""The loop of the neighbour-aided filter, compiled: import this module only when it runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


@kernel()
def follow(observations: Floats, variance: Floats, seconds: float, acceleration: float) -> Floats:
    """Return a marker's position in every frame, filtered from it and the frames before.

    Each coordinate has a position and a velocity; its covariance, the same for all three, is
    ``[[p, c], [c, v]]``.

    Parameters
    ----------
    observations : (T, 3) array of float64
        Observed or estimated positions, mm; NaN where there is none.
    variance : (T,) array of float64
        Its variance, mm^2.
    seconds
        The time of a frame.
    acceleration
        Standard deviation of the acceleration, mm/s^2.

    Returns
    -------
    (T, 3) array of float64
        Millimetres; NaN before the first frame that has an observation.
    """
    path = np.empty_like(observations)
    position, velocity, spread = np.full(3, np.nan), np.zeros(3), np.zeros(3)
    for t in range(len(observations)):
        _follow(position, velocity, spread, observations[t], variance[t], seconds, acceleration)
        path[t, 0], path[t, 1], path[t, 2] = position
    return path


@kernel("position", "velocity", "spread")
def advance(
    position: Floats,
    velocity: Floats,
    spread: Floats,
    observations: Floats,
    variance: Floats,
    seconds: float,
    acceleration: float,
) -> None:
    """Filter the next frame of several markers, as `follow` does.

    Parameters
    ----------
    position, velocity, spread : (M, 3) arrays of float64
        State in the frame before; that of this one is written there. The spread is p, c and v; the
        position is NaN before the first observation.
    observations : (M, 3) array of float64
    variance : (M,) array of float64
    seconds, acceleration
        As for `follow`.
    """
    for m in range(len(position)):
        _follow(
            position[m], velocity[m], spread[m], observations[m], variance[m], seconds, acceleration
        )


@kernel("position", "velocity", "spread", no_cpython_wrapper=True)
def _follow(
    position: Floats,
    velocity: Floats,
    spread: Floats,
    observation: Floats,
    variance: float,
    seconds: float,
    acceleration: float,
) -> None:
    here = not np.isnan(observation[0])
    if np.isnan(position[0]):
        if here:
            for i in range(3):  # `position[:]` would take four times as long to compile
                position[i], velocity[i] = observation[i], 0.0
            # as if it had been speeding up for a second
            spread[0], spread[1], spread[2] = variance, 0.0, acceleration**2
        return
    p, c, v = spread
    jolt = (acceleration * seconds) ** 2
    for i in range(3):
        position[i] += velocity[i] * seconds
    p += seconds * (2.0 * c + seconds * (v + jolt / 4.0))
    c += seconds * (v + jolt / 2.0)
    v += jolt
    if here:
        total = p + variance
        for i in range(3):
            off = (observation[i] - position[i]) / total
            position[i] += p * off
            velocity[i] += c * off
        v -= c * c / total
        c -= p * c / total
        p -= p * p / total
    spread[0], spread[1], spread[2] = p, c, v

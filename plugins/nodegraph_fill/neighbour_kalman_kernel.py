"""The loop of the neighbour-aided filter, compiled: import this module only when it runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

compiled = kernel()


@compiled
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
    path = np.full_like(observations, np.nan)
    position, velocity = np.zeros(3), np.zeros(3)
    jolt = (acceleration * seconds) ** 2
    p, c, v, started = 0.0, 0.0, 0.0, False
    for t in range(len(observations)):
        here = not np.isnan(observations[t, 0])
        if not started:
            if here:
                started = True
                position[:] = observations[t]
                # as if it had been speeding up for a second
                p, v = variance[t], acceleration**2
                path[t] = position
            continue
        position += velocity * seconds
        p += seconds * (2.0 * c + seconds * (v + jolt / 4.0))
        c += seconds * (v + jolt / 2.0)
        v += jolt
        if here:
            total = p + variance[t]
            for i in range(3):
                off = (observations[t, i] - position[i]) / total
                position[i] += p * off
                velocity[i] += c * off
            v -= c * c / total
            c -= p * c / total
            p -= p * p / total
        path[t] = position
    return path

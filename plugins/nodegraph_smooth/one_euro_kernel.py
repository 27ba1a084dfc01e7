"""The loop of the one-euro filter, compiled: import this module only when it runs."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

inlined = partial(kernel, forceinline=True, no_cpython_wrapper=True)


@kernel()
def smooth(values: Floats, rate: float, least: float, slope: float, derivative: float) -> Floats:
    """Return the filtered runs, (T, R, 3); see `nodegraph_smooth.one_euro`.

    Parameters
    ----------
    values : (T, R, 3) array of float64
    rate
        Frames per second.
    least, slope, derivative
        Cut-off at rest in Hz, what it gains in Hz per mm/s, and that of the velocity in Hz.
    """
    smoothed = values.copy()
    steady = 1.0 / (1.0 + rate / (2.0 * math.pi * derivative))
    velocity = np.empty(3)
    for run in range(values.shape[1]):
        velocity[:] = 0.0
        for t in range(1, len(values)):
            before = smoothed[t - 1, run]
            _follow(smoothed[t, run], values[t, run], before, velocity, rate, least, slope, steady)
    return smoothed


@kernel("smoothed", "velocity")
def advance(
    smoothed: Floats,
    velocity: Floats,
    values: Floats,
    rate: float,
    least: float,
    slope: float,
    derivative: float,
) -> None:
    """Filter the next frame of some runs, as `smooth` does.

    Parameters
    ----------
    smoothed, velocity : (R, 3) arrays of float64
        Results of the frame before; those of this one are written there.
    values : (R, 3) array of float64
    rate, least, slope, derivative
        As for `smooth`.
    """
    steady = 1.0 / (1.0 + rate / (2.0 * math.pi * derivative))
    for run in range(len(values)):
        at = smoothed[run]
        _follow(at, values[run], at, velocity[run], rate, least, slope, steady)


@inlined("out", "velocity")
def _follow(
    out: Floats,
    value: Floats,
    before: Floats,
    velocity: Floats,
    rate: float,
    least: float,
    slope: float,
    steady: float,
) -> None:
    """Write a sample's output and velocity from those before it."""
    speed = 0.0
    for axis in range(3):
        step = (value[axis] - before[axis]) * rate
        velocity[axis] += steady * (step - velocity[axis])
        speed += velocity[axis] ** 2
    cutoff = least + slope * math.sqrt(speed)
    share = 1.0 / (1.0 + rate / (2.0 * math.pi * cutoff))
    for axis in range(3):
        out[axis] = before[axis] + share * (value[axis] - before[axis])

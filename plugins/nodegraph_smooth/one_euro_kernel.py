"""The loop of the one-euro filter, compiled: import this module only when it runs."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from nodegraph import kernel

compiled = kernel()


@compiled
def smooth(values: Any, rate: float, least: float, slope: float, derivative: float) -> Any:
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
            speed = 0.0
            for axis in range(3):
                step = (values[t, run, axis] - smoothed[t - 1, run, axis]) * rate
                velocity[axis] += steady * (step - velocity[axis])
                speed += velocity[axis] ** 2
            cutoff = least + slope * math.sqrt(speed)
            share = 1.0 / (1.0 + rate / (2.0 * math.pi * cutoff))
            for axis in range(3):
                before = smoothed[t - 1, run, axis]
                smoothed[t, run, axis] = before + share * (values[t, run, axis] - before)
    return smoothed

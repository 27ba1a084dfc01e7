"""Least squares with a penalty on differences."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import node
from nodegraph_mocap import Trajectories
from nodegraph_smooth.cutoff import Cutoff, angle, check_stiffness
from nodegraph_smooth.present_runs import Smoothing, smooth_runs

if TYPE_CHECKING:
    from numpy.typing import NDArray


@node("smooth.whittaker", cite="eilers2003", lookahead=None, shares=Smoothing)
def whittaker(
    smoothing: Smoothing,
    *,
    cutoff: Cutoff = 10.0,
    order: Annotated[int, Field(ge=1, le=3)] = 2,
) -> Trajectories:
    """Smooth by least squares with a penalty on the differences of order d (Whittaker, Eilers).

    The output z minimizes ``sum((P[t] - z[t])^2) + lambda sum((D^d z)[t]^2)`` over a run, D^d
    being differences of order d: it solves ``(I + lambda D'D) z = P``, a banded system, by
    `scipy.linalg.solveh_banded`. Away from the ends it keeps
    ``1 / (1 + lambda (2 sin(pi f / rate))^(2 d))`` of the amplitude of frequency f, so that
    ``lambda = (2 sin(pi fc / rate))^(-2 d)`` keeps half of it at the cut-off fc: 1 with the
    defaults at 60 Hz.

    A gap splits a trajectory into runs, each smoothed by itself; those of d samples or fewer
    stay as they are, counted in a warning. Nothing is filled.

    Looks ahead to the end of the run.

    Parameters
    ----------
    cutoff
        fc, the frequency of which half the amplitude is kept.
    order
        d; 2 is Eilers' usual choice.

    Raises
    ------
    Refusal
        If the cut-off is not below half the frame rate, or so low that the system cannot be
        solved; or if no run is longer than d samples.
    """
    recording = smoothing.recording
    penalty = (2.0 * math.sin(angle(cutoff, recording.rate) / 2.0)) ** (-2 * order)
    check_stiffness(penalty, cutoff, recording.rate)

    def solved(block: NDArray[np.float64]) -> NDArray[np.float64]:
        from scipy.linalg import solveh_banded

        bands = penalty * _squared_differences(len(block), order)
        bands[0] += 1.0
        flat = block.reshape(len(block), -1)
        return np.asarray(solveh_banded(bands, flat, lower=True)).reshape(block.shape)

    return smooth_runs(recording, solved, shortest=order + 1)


def _squared_differences(length: int, order: int) -> NDArray[np.float64]:
    """Return ``D'D`` as its diagonal and those below it, (order + 1, length)."""
    row = np.array([(-1.0) ** k * math.comb(order, k) for k in range(order + 1)])
    bands = np.zeros((order + 1, length))
    for first in range(order + 1):
        for below in range(order + 1 - first):
            last = length - order + first
            bands[below, first:last] += row[first] * row[first + below]
    return bands

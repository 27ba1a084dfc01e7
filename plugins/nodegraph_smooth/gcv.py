"""The smoothing spline that cross-validation chooses."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph import node
from nodegraph_mocap import Trajectories
from nodegraph_smooth.present_runs import Smoothing, smooth_runs

if TYPE_CHECKING:
    from numpy.typing import NDArray

SHORTEST = 5


@node("smooth.gcv", cite=("craven_wahba1979", "woltring1986"), lookahead=None, shares=Smoothing)
def gcv(smoothing: Smoothing) -> Trajectories:
    """Smooth by the cubic smoothing spline that generalised cross-validation chooses (Woltring).

    The output is the natural cubic spline f that minimizes
    ``sum(|P[t] - f(t)|^2) + lambda integral(|f''|^2)`` over a run of T samples. lambda is the
    one that minimizes ``T sum(|P[t] - f(t)|^2) / trace(I - A)^2`` (Craven & Wahba), A being the
    matrix that takes the samples to f at the frames: how much to smooth is read from each run's
    own noise, and there is nothing to set. As in Woltring's program, the three coordinates of a
    run share one lambda, so that the result does not depend on how the axes lie. It equals
    `scipy.interpolate.make_smoothing_spline` with that lambda (in frames^3), which by itself
    would choose one per coordinate and none above T.

    Noise must be independent from frame to frame: what is already filtered is hardly smoothed
    any more. Short runs give a poor estimate.

    A gap splits a trajectory into runs, each smoothed by itself; those of fewer than 5 samples
    stay as they are, counted in a warning. Nothing is filled.

    Looks ahead to the end of the run.

    Raises
    ------
    Refusal
        If every run is shorter than 5 samples.
    """
    return smooth_runs(smoothing.recording, _splines, shortest=SHORTEST)


def _splines(block: NDArray[np.float64]) -> NDArray[np.float64]:
    from nodegraph_smooth import gcv_kernel

    smoothed, _ = gcv_kernel.smooth(np.ascontiguousarray(block))
    return np.asarray(smoothed)

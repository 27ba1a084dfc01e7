"""The cubic spline on evenly spaced knots that fits best."""

from __future__ import annotations

from nodegraph import Refusal, node
from nodegraph_mocap import Trajectories
from nodegraph_smooth.cutoff import Seconds, frames_of
from nodegraph_smooth.knots import fit
from nodegraph_smooth.present_runs import Smoothing, smooth_runs

DEGREE = 3
_NEAREST = 1.1
"""Frames between knots; nearer ones leave the coefficients of a long run undetermined."""


@node("smooth.least_squares", cite="deboor1978", lookahead=None, shares=Smoothing)
def least_squares(smoothing: Smoothing, *, spacing: Seconds = 0.05) -> Trajectories:
    """Smooth by the cubic spline on evenly spaced knots that fits best in the least squares.

    The output is the spline ``S(t) = sum(c[j] B[j](t))`` whose coefficients minimize
    ``sum(|P[t] - S(t)|^2)`` over a run, B[j] being the cubic B-splines on its knots; by
    `scipy.interpolate.make_lsq_spline`. Knots lie on the run's first and last frame and between
    them `spacing` apart, or as near to that as a whole number of spans comes. The farther apart,
    the smoother: movement faster than about ``1 / (2 spacing)`` Hz is lost. The curve does not
    go through the end samples.

    A gap splits a trajectory into runs, each smoothed by itself; those of fewer than 5 samples
    stay as they are, counted in a warning. Nothing is filled.

    Looks ahead to the end of the run; what lies several knots ahead counts for little.

    Parameters
    ----------
    spacing
        Time from knot to knot; 3 frames at 60 Hz with the default.

    Raises
    ------
    Refusal
        If knots would lie less than 1.1 frames apart, or every run is too short.
    """
    recording = smoothing.recording
    frames = frames_of(spacing, recording.rate)
    if not frames >= _NEAREST:
        raise Refusal(
            f"knots {spacing:g} s apart are {frames:g} frames apart at {recording.rate:g} Hz: "
            "the spline would go through nearly every sample; take at least "
            f"{_NEAREST:g} frames, such as {2.0 / recording.rate:.3g} s for 2"
        )
    return smooth_runs(
        recording, lambda block: fit(block, frames, degree=DEGREE), shortest=DEGREE + 2
    )

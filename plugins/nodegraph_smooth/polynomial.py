"""Polynomials of low degree, segment by segment."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nodegraph import Refusal, node
from nodegraph_mocap import Trajectories
from nodegraph_smooth.cutoff import Seconds, frames_of
from nodegraph_smooth.knots import fit
from nodegraph_smooth.present_runs import Smoothing, smooth_runs


@node(
    "smooth.polynomial",
    cite="liu2004",
    adapted=(
        "from Liu et al. 2004, known from Zhang et al. alone: segments of equal length that "
        "meet in value and slope"
    ),
    lookahead=None,
    shares=Smoothing,
)
def polynomial(
    smoothing: Smoothing,
    *,
    segment: Seconds = 0.1,
    degree: Annotated[int, Field(ge=2, le=9)] = 3,
) -> Trajectories:
    """Smooth by least-squares polynomials of low degree, one per segment of a run (Liu et al.).

    Zhang et al. report of that method that a polynomial of higher degree over the whole curve fits
    no better, and that segments were added to keep the degree low and the fit smooth; the
    original could not be checked. Here a run is cut into segments of equal length, and the
    polynomials ``p[s](t)`` of all of them together minimize ``sum(|P[t] - p(t)|^2)`` such that
    where two meet, their values and their slopes agree. That is a spline whose inner knots count
    ``degree - 1`` times; by `scipy.interpolate.make_lsq_spline`. Each segment adds
    ``degree - 1`` free coefficients: movement faster than about
    ``(degree - 1) / (2 segment)`` Hz is lost. The curve does not go through the end samples.

    A gap splits a trajectory into runs, each smoothed by itself; those of fewer than
    ``degree + 2`` samples stay as they are, counted in a warning. Nothing is filled.

    Looks ahead to the end of the run; what lies several segments ahead counts for little.

    Parameters
    ----------
    segment
        Length of a segment, or as near to that as a whole number of them comes; 6 frames at
        60 Hz with the default. Take one longer than the take for a single polynomial.
    degree
        Degree of each polynomial.

    Raises
    ------
    Refusal
        If a segment has no more frames than free coefficients, or every run is too short.
    """
    recording = smoothing.recording
    frames = frames_of(segment, recording.rate)
    if not frames > degree - 1:
        raise Refusal(
            f"a segment of {segment:g} s is {frames:g} frames at {recording.rate:g} Hz, and a "
            f"polynomial of degree {degree} needs more than {degree - 1} to smooth anything"
        )
    return smooth_runs(
        recording,
        lambda block: fit(block, frames, degree=degree, repeated=degree - 1),
        shortest=degree + 2,
    )

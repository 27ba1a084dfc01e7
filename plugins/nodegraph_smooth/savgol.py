"""A polynomial fitted to each window of frames."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from nodegraph import Refusal, node
from nodegraph_mocap import Trajectories
from nodegraph_smooth.cutoff import Seconds, frames_of
from nodegraph_smooth.present_runs import smooth_runs

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@node("smooth.savgol", cite="savitzky_golay1964", lookahead=None)
def savgol(
    recording: Trajectories,
    *,
    window: Seconds = 0.15,
    degree: Annotated[int, Field(ge=0, le=9)] = 3,
) -> Trajectories:
    """Smooth by the least-squares polynomial of the window around each frame (Savitzky & Golay).

    The output at frame t is ``p(0)`` of the polynomial p of the given degree that minimizes
    ``sum((P[t + k] - p(k))^2)`` over the window ``k = -h .. h``; a fixed weighted mean of the
    window's samples, by `scipy.signal.savgol_filter`. In the first and last h frames of a run,
    the polynomial of the run's first and last window is taken. With the defaults the window is
    9 frames at 60 Hz, which keeps .255 of the variance of white noise.

    A gap splits a trajectory into runs, each smoothed by itself; runs shorter than the window
    stay as they are, counted in a warning. Nothing is filled.

    Looks ahead h frames, 4 with the defaults at 60 Hz; up to 2 h at the start of a run.

    Parameters
    ----------
    recording
        Trajectories, with or without gaps.
    window
        Length of the window, ``2 h + 1`` frames: the nearest odd number.
    degree
        Of the polynomial.

    Returns
    -------
    Trajectories
        The recording with other positions; `sigma`, if it has any, NaN where they differ.

    Raises
    ------
    Refusal
        If a polynomial goes through every sample of a window, or no run is as long as one.
    """
    frames = 2 * int(frames_of(window, recording.rate) / 2.0) + 1
    if frames <= degree + 1:
        raise Refusal(
            f"a window of {window:g} s is {frames} frames at {recording.rate:g} Hz, and a "
            f"polynomial of degree {degree} needs more than {degree + 1} to smooth anything"
        )

    def fitted(block: NDArray[np.float64]) -> NDArray[np.float64]:
        from scipy.signal import savgol_filter

        return savgol_filter(block, frames, degree, axis=0, mode="interp")

    return smooth_runs(recording, fitted, shortest=frames)

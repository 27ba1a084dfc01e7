"""A polynomial fitted to each window of frames."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import Field

from nodegraph import Refusal, Unit, Window, WindowForm, node, read_only
from nodegraph_mocap import MarkerFrame, Trajectories
from nodegraph_smooth.cutoff import Seconds, frames_of
from nodegraph_smooth.present_runs import Runs, Smoothing, long_enough, smoothed, smoothed_at

if TYPE_CHECKING:
    from numpy.typing import NDArray


def _lookahead(settings: Mapping[str, Any]) -> int | None:
    reach: int | None = settings["reach"]
    # at the start of a run the first window must be complete
    return None if reach is None or 2 * reach <= settings["degree"] else 2 * reach


def _frames_before(settings: Mapping[str, object]) -> int | None:
    ahead = _lookahead(settings)
    # so that a run that begins before the window is seen to be longer than one
    return None if ahead is None else ahead + 1


def _fitted_at(
    around: Window[MarkerFrame, Trajectories], *, window: float, degree: int, reach: int
) -> MarkerFrame:
    return smoothed_at(around, partial(_fit_into, reach=reach, degree=degree))


@node(
    "smooth.savgol",
    cite="savitzky_golay1964",
    lookahead=_lookahead,
    live=WindowForm(_fitted_at, before=_frames_before, after=_lookahead),
    shares=Smoothing,
)
def savgol(
    smoothing: Smoothing,
    *,
    window: Seconds = 0.15,
    degree: Annotated[int, Field(ge=0, le=9)] = 3,
    reach: Annotated[int | None, Field(ge=1), Unit("frames")] = None,
) -> Trajectories:
    """Smooth by the least-squares polynomial of the window around each frame (Savitzky & Golay).

    The output at frame t is ``p(0)`` of the polynomial p of the given degree that minimizes
    ``sum((P[t + k] - p(k))^2)`` over the window ``k = -h .. h``; a fixed weighted mean of the
    window's samples. In the first and last h frames of a run, the polynomial of the run's first
    and last window is taken. With the defaults the window is 9 frames at 60 Hz, which keeps .255
    of the variance of white noise.

    A gap splits a trajectory into runs, each smoothed by itself; runs shorter than the window
    stay as they are, counted in a warning. Nothing is filled.

    Looks ahead h frames, 4 with the defaults at 60 Hz; up to 2 h at the start of a run. On a
    stream h must be given, as `reach`: in seconds it is not known before the rate is.

    Parameters
    ----------
    window
        Length of the window, ``2 h + 1`` frames: the nearest odd number.
    degree
        Degree of the polynomial.
    reach
        h; takes the place of `window`.

    Raises
    ------
    Refusal
        If a polynomial goes through every sample of a window, or no run is as long as one.
    """
    recording = smoothing.recording
    half = int(frames_of(window, recording.rate) / 2.0) if reach is None else reach
    if 2 * half <= degree:
        length = f"{window:g} s" if reach is None else f"reach {reach}"
        raise Refusal(
            f"a window of {length} is {2 * half + 1} frames at {recording.rate:g} Hz, and a "
            f"polynomial of degree {degree} needs more than {degree + 1} to smooth anything"
        )
    return smoothed(recording, _fitted(recording, half, degree))


def _fitted(recording: Trajectories, reach: int, degree: int) -> NDArray[np.float64]:
    # a call of its own, so that the warning of `long_enough` names the line that called the node
    runs = Runs.of(recording)
    long_enough(runs, 2 * reach + 1)
    positions = np.ascontiguousarray(recording.positions)
    fitted = np.empty_like(positions)
    _fit_into(fitted, positions, runs, reach, degree)
    return fitted


def _fit_into(
    fitted: NDArray[np.float64],
    positions: NDArray[np.float64],
    runs: Runs,
    reach: int,
    degree: int,
) -> None:
    """Write the smoothed runs, and as they are those shorter than a window; NaN elsewhere.

    Parameters
    ----------
    fitted, positions
        (T, M, 3) mm, contiguous and apart from each other; NaN where `positions` is in no run.
    runs
        All runs of present samples.
    reach, degree
        h, and that of the polynomial.
    """
    from nodegraph_smooth import weights_kernel

    rows = _rows(reach, degree)
    middle, first = rows[reach, reach + 1 :], rows[: reach + 1]
    if weights_kernel.curve_into(fitted, positions, middle, *runs, first):
        for length, alike in runs.subset(runs.length <= len(rows)).by_length():
            every = rows if length == len(rows) else np.eye(length)
            weights_kernel.rows_into(fitted, positions, alike.marker, alike.start, every)


@lru_cache
def _rows(reach: int, degree: int) -> NDArray[np.float64]:
    """Return the weights of a window's samples in the polynomial at each of its frames."""
    place = np.arange(-reach, reach + 1) / reach
    basis, _ = np.linalg.qr(np.polynomial.legendre.legvander(place, degree))
    return read_only(np.ascontiguousarray(basis @ basis.T))

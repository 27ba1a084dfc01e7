"""A uniform B-spline curve whose control points are the samples."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any, get_args

import numpy as np
from pydantic import Field

from nodegraph import Window, WindowForm, node
from nodegraph_mocap import MarkerFrame, Trajectories
from nodegraph_smooth.bspline_weights import Ends, all_rows, first_rows, irregular, middle
from nodegraph_smooth.present_runs import Runs, Smoothing, long_enough, smoothed, smoothed_at

if TYPE_CHECKING:
    from numpy.typing import NDArray

HIGHEST = 9


def _lookahead(settings: Mapping[str, Any]) -> int:
    order: int = settings["order"]
    return 2 * order - 2 if settings["ends"] == "clamped" else order // 2


def _frames_before(settings: Mapping[str, Any]) -> int:
    # a run of this many frames and one more is long, and past its irregular start
    return 2 * irregular(settings["order"], settings["ends"])


def _curve_at(window: Window[MarkerFrame, Trajectories], *, order: int, ends: Ends) -> MarkerFrame:
    return smoothed_at(window, partial(curve_into, order=order, ends=ends))


@node(
    "smooth.bspline",
    cite="zhang_scattered",
    lookahead=_lookahead,
    live=WindowForm(_curve_at, before=_frames_before, after=_lookahead),
    shares=Smoothing,
)
def bspline(
    smoothing: Smoothing,
    *,
    order: Annotated[int, Field(ge=1, le=HIGHEST)] = 3,
    ends: Ends = "vertex",
) -> Trajectories:
    """Smooth by a B-spline curve that has the samples for control points (Zhang et al.).

    ``P_{i,n}(t) = sum(P_{i+k} F_{k,n}(t))`` for k = 0 .. n, with ``F_{k,n}(t) = 1/n! sum((-1)^j
    C(n+1, j) (t + n - k - j)^n)`` for j = 0 .. n - k; equations 11 and 12. What the text calls
    order n is the degree. The curve is neither an interpolation nor a least-squares fit: one
    sample of it per frame, at that control point's own parameter (t = 0 for odd n, 1/2 for even
    n, so that nothing shifts in time), is a weighted mean of the samples around the frame:

    = ====================================== ========== ===============
    n weights                                noise kept -3 dB at 60 Hz
    = ====================================== ========== ===============
    3 1 4 1 / 6                              .500       13.8 Hz
    4 1 76 230 76 1 / 384                    .437       12.2 Hz
    5 1 26 66 26 1 / 120                     .397       11.2 Hz
    6 1 722 10543 23548 10543 722 1 / 46080  .366       10.4 Hz
    7 1 120 1191 2416 1191 120 1 / 5040      .343       9.7 Hz
    = ====================================== ========== ===============

    (noise kept: variance of white noise after and before; the frequencies go with the rate).
    Order 1 changes nothing. A gap splits a trajectory into runs, each smoothed by itself,
    however short; nothing is filled.

    Looks ahead ``order // 2`` frames; at the ends of a run with `ends` clamped up to
    ``2 order - 2`` frames.

    Parameters
    ----------
    order
        n, the degree of the curve: the higher, the smoother. 3 is the paper's.
    ends
        vertex: each end sample is repeated n times in all, so that the curve starts and ends on
        the first and the last sample. clamped: the quasi-uniform knot vector, the curve taken
        at the Greville abscissae; it too starts and ends there, and a run of L <= n samples has
        degree L - 1. free: nothing is repeated, and half a window at each end stays as it was.

    Raises
    ------
    ValueError
        If `order` or `ends` is not one of its choices.
    """
    recording = smoothing.recording
    if not 1 <= order <= HIGHEST:
        raise ValueError(f"order must be 1 to {HIGHEST}, got {order}")
    if ends not in get_args(Ends):
        raise ValueError(f"ends must be {', '.join(get_args(Ends))}, got {ends!r}")
    return smoothed(recording, _curve(recording, order, ends))


def _curve(recording: Trajectories, order: int, ends: Ends) -> NDArray[np.float64]:
    positions = np.ascontiguousarray(recording.positions)
    smoothed = np.empty_like(positions)
    curve_into(smoothed, positions, long_enough(Runs.of(recording), 1), order, ends)
    return smoothed


def curve_into(
    smoothed: NDArray[np.float64],
    positions: NDArray[np.float64],
    runs: Runs,
    order: int,
    ends: Ends,
) -> None:
    """Write the curve, once per frame; NaN where there is no run.

    Parameters
    ----------
    smoothed, positions
        (T, M, 3) mm, contiguous and apart from each other; NaN where `positions` is in no run.
    runs
        All runs of present samples.
    order, ends
        As for `bspline`.
    """
    from nodegraph_smooth import weights_kernel

    rows = first_rows(order, ends)
    if weights_kernel.curve_into(smoothed, positions, middle(order), *runs, rows):
        for length, alike in runs.subset(runs.length < 2 * len(rows)).by_length():
            every = all_rows(order, ends, length)
            weights_kernel.rows_into(smoothed, positions, alike.marker, alike.start, every)

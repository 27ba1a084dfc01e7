"""Two long steps in a row: the impulse filter of Zhang, Liang and Wei."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Annotated, Literal, get_args

import numpy as np
from pydantic import Field

from nodegraph import StateForm, Unit, node
from nodegraph_despike.repair import Repairing, repaired, repaired_frame
from nodegraph_mocap import MarkerFrame, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

Order = Literal["simultaneous", "in_place", "redetect"]


def _lookahead(settings: Mapping[str, object]) -> int | None:
    # the mean step of the whole take; the worst sample of the whole take
    unbounded = settings["mean_step"] is None and settings["calibration"] is None
    return None if unbounded or settings["order"] == "redetect" else 1


class _Stream:
    """The filter frame by frame: a frame is judged when the next one is there."""

    def __init__(
        self,
        recording: Trajectories,
        *,
        factor: float,
        order: Order,
        mean_step: float | None,
        calibration: int | None,
    ) -> None:
        from nodegraph_despike import impulse_kernel

        _check(order, mean_step, calibration)
        self.header = recording
        self._repair = getattr(impulse_kernel, order)
        self._in_place = order == "in_place"
        self._factor = factor
        self._bar = np.full(len(recording.markers), factor * (mean_step or np.inf))
        self._calibration = calibration or 0
        self._first: list[NDArray[np.float64]] = []
        """Frames of the calibration."""
        self._now: MarkerFrame | None = None
        self._positions = np.full((3, len(recording.markers), 3), np.nan)
        """Before the frame that is judged, in it, and after it."""

    def push(self, frame: MarkerFrame) -> MarkerFrame | None:
        now, self._now = self._now, frame
        positions = self._positions
        positions[0], positions[1], positions[2] = positions[1], positions[2], frame.positions
        if now is None:
            return None
        if len(self._first) < self._calibration:
            self._calibrate(now)
            return now
        # in the second frame those before are missing: nothing is bad
        judged = positions.copy()
        self._repair(judged, positions, self._bar, 1)
        repaired = repaired_frame(now, judged[1])
        if self._in_place:
            positions[1] = repaired.positions
        return repaired

    def drain(self) -> Iterable[MarkerFrame]:
        return () if self._now is None else (self._now,)

    def _calibrate(self, frame: MarkerFrame) -> None:
        from nodegraph_despike import impulse_kernel

        self._first.append(frame.positions)
        if len(self._first) == self._calibration:
            self._bar = impulse_kernel.bars(np.stack(self._first), self._factor)


def _check(order: Order, mean_step: float | None, calibration: int | None) -> None:
    if order not in get_args(Order):
        raise ValueError(f"order must be simultaneous, in_place or redetect, got {order!r}")
    if mean_step is not None and calibration is not None:
        raise ValueError(
            f"mean_step ({mean_step} mm) and calibration ({calibration} frames) both give the "
            "mean step; set one of them"
        )


@node(
    "despike.impulse",
    cite="zhang_scattered",
    lookahead=_lookahead,
    live=StateForm(_Stream),
    shares=Repairing,
)
def impulse(
    repairing: Repairing,
    *,
    factor: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] = 1.5,
    order: Order = "simultaneous",
    mean_step: Annotated[float | None, Field(gt=0.0, allow_inf_nan=False), Unit("mm")] = None,
    calibration: Annotated[int | None, Field(ge=2), Unit("frames")] = None,
) -> Trajectories:
    """Repair samples between two long steps (Zhang et al.).

    Equations 8 to 10, for each marker by itself: with ``l_i = |P_i - P_{i-1}|`` between samples
    that are both present, and k the mean of all l of the marker, taken once and before any
    change, the sample ``P_i`` is bad when ``l_i >= factor k`` and ``l_{i+1} >= factor k``, and
    is put at the midpoint ``(P_{i-1} + P_{i+1}) / 2`` ("mid-value" is not a median).

    A sample of which a neighbour is missing is not bad, nor is the first or the last one; where
    k = 0, the marker stands still, and nothing is bad. So an impulse of one frame is found, one
    of two or three frames is not. The rule takes fast motion for noise: of a clean sinusoid it
    flags 10 % at a period of 20 frames, 18 % at 100, 19 % at most, and as much of a clean face.
    How many samples were repaired, and by how much, is in a warning; what an earlier method has
    filled or repaired counts as present.

    Looks ahead 1 frame to judge and repair a sample, and to the take's end for k unless it is set
    or made from the first frames; `order` redetect to the take's end as well.

    Parameters
    ----------
    factor
        How many times the mean step a step must be to be long.
    order
        simultaneous (the paper): all bad samples are found, then each is repaired from its
        neighbours as they came; of impulses in frames 10 and 12, the good frame 11 is bad too,
        and becomes an impulse. in_place: one pass forward, each frame judged and repaired after
        the one before it. redetect: the worst sample, with the largest distance from its
        midpoint, the earliest of equals, is repaired and everything judged again, until none is
        bad; each is repaired at most once.
    mean_step
        k of every marker. None: that of the marker, from the take or the `calibration`.
    calibration
        Number of first frames from which k is taken, and which stay as they are. None: from the
        whole take.

    Raises
    ------
    ValueError
        If the order is not one of its choices, or both `mean_step` and `calibration` are set.
    """
    recording = repairing.recording
    from nodegraph_despike import impulse_kernel

    _check(order, mean_step, calibration)
    positions = np.ascontiguousarray(recording.positions)
    if mean_step is None:
        bar = impulse_kernel.bars(positions[:calibration], float(factor))
    else:
        bar = np.full(len(recording.markers), factor * mean_step)
    judged = positions.copy()  # numpy's copy of a long take takes a quarter of numba's time
    getattr(impulse_kernel, order)(judged, positions, bar, max(calibration or 0, 1))
    return repaired(recording, judged)

"""The one-euro filter, which sees no frame ahead."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import StateForm, Unit, node
from nodegraph_mocap import MarkerFrame, Trajectories
from nodegraph_smooth.present_runs import Smoothing, smooth_runs

if TYPE_CHECKING:
    from numpy.typing import NDArray

Frequency = Annotated[float, Field(gt=0.0, allow_inf_nan=False), Unit("Hz")]


class _Stream:
    """The filter frame by frame."""

    def __init__(
        self,
        recording: Trajectories,
        *,
        min_cutoff: float,
        beta: float,
        derivative_cutoff: float,
    ) -> None:
        _check(min_cutoff, beta, derivative_cutoff)
        self.header = recording
        self._settings = recording.rate, min_cutoff, beta, derivative_cutoff
        shape = (len(recording.markers), 3)
        # of each marker's run its first sample, from which the others are counted, the output and
        # the velocity; NaN where it is missing
        self._origin, self._smoothed, self._velocity = np.full((3, *shape), np.nan)

    def push(self, frame: MarkerFrame) -> MarkerFrame:
        from nodegraph_smooth import one_euro_kernel

        present = frame.present
        begins = present & np.isnan(self._origin[:, 0])
        self._origin[~present] = np.nan
        self._origin[begins] = frame.positions[begins]
        relative = frame.positions - self._origin
        one_euro_kernel.advance(self._smoothed, self._velocity, relative, *self._settings)
        self._smoothed[begins] = self._velocity[begins] = 0.0
        positions, sigma = self._origin + self._smoothed, frame.sigma
        if sigma is not None:
            sigma = np.where(np.any(positions != frame.positions, axis=1), np.nan, sigma)
        return MarkerFrame(positions, frame.origin.copy(), sigma)

    def drain(self) -> Iterable[MarkerFrame]:
        return ()


def _check(min_cutoff: float, beta: float, derivative_cutoff: float) -> None:
    if not (min_cutoff > 0.0 and derivative_cutoff > 0.0 and beta >= 0.0):
        raise ValueError(
            "cut-offs must be positive and beta not negative, got "
            f"{min_cutoff}, {derivative_cutoff} Hz and {beta}"
        )


@node(
    "smooth.one_euro",
    cite="casiez2012",
    adapted=(
        "from Casiez et al. 2012: one cut-off for all three coordinates, by the length of the "
        "velocity"
    ),
    lookahead=0,
    live=StateForm(_Stream),
    shares=Smoothing,
)
def one_euro(
    smoothing: Smoothing,
    *,
    min_cutoff: Frequency = 3.0,
    beta: Annotated[float, Field(ge=0.0, allow_inf_nan=False), Unit("Hz per mm/s")] = 0.5,
    derivative_cutoff: Frequency = 1.0,
) -> Trajectories:
    """Smooth causally by the one-euro filter (Casiez et al.): it lags, and sees no frame ahead.

    A low-pass filter of first order whose cut-off rises with the speed: with x the sample, y the
    output before it and ``share(f) = 1 / (1 + rate / (2 pi f))``,
    ``v <- v + share(derivative_cutoff) ((x - y) rate - v)``, v being 0 in the first frame,
    ``fc = min_cutoff + beta |v|`` and ``y <- y + share(fc) (x - y)``. ``|v|`` is the length of
    the marker's velocity, so that the three coordinates are filtered alike and the result does
    not depend on how the axes lie.

    A gap splits a trajectory into runs, each filtered by itself from its first sample on,
    however short. Nothing is filled.

    Looks ahead 0 frames. The output lags, at cut-off fc by about ``1 / (2 pi fc)`` s.

    Parameters
    ----------
    min_cutoff
        Cut-off of a marker at rest: lower, and it jitters less.
    beta
        Rise of the cut-off with speed: with a higher one a moving marker lags less. With
        lengths in another unit it changes inversely.
    derivative_cutoff
        Cut-off of the velocity; the authors' 1 Hz.

    Raises
    ------
    ValueError
        If a cut-off is not positive, or `beta` is negative.
    """
    recording = smoothing.recording
    _check(min_cutoff, beta, derivative_cutoff)

    def filtered(block: NDArray[np.float64]) -> NDArray[np.float64]:
        from nodegraph_smooth import one_euro_kernel

        settings = recording.rate, min_cutoff, beta, derivative_cutoff
        return np.asarray(one_euro_kernel.smooth(np.ascontiguousarray(block), *settings))

    return smooth_runs(recording, filtered)

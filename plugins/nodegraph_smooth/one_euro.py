"""The one-euro filter, which sees no frame ahead."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import Unit, node
from nodegraph_mocap import Trajectories
from nodegraph_smooth.present_runs import smooth_runs

if TYPE_CHECKING:
    from numpy.typing import NDArray

Frequency = Annotated[float, Field(gt=0.0, allow_inf_nan=False), Unit("Hz")]


@node(
    "smooth.one_euro",
    cite="casiez2012",
    adapted=(
        "from Casiez et al. 2012: one cut-off for all three coordinates, by the length of the "
        "velocity"
    ),
    lookahead=0,
)
def one_euro(
    recording: Trajectories,
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
    recording
        Trajectories, with or without gaps.
    min_cutoff
        Cut-off of a marker at rest: lower, and it jitters less.
    beta
        What the cut-off gains with speed: higher, and a moving marker lags less. With lengths in
        another unit it changes inversely.
    derivative_cutoff
        Cut-off of the velocity; the authors' 1 Hz.

    Returns
    -------
    Trajectories
        The recording with other positions; `sigma`, if it has any, NaN where they differ.

    Raises
    ------
    ValueError
        If a cut-off is not positive, or `beta` is negative.
    """
    if not (min_cutoff > 0.0 and derivative_cutoff > 0.0 and beta >= 0.0):
        raise ValueError(
            "cut-offs must be positive and beta not negative, got "
            f"{min_cutoff}, {derivative_cutoff} Hz and {beta}"
        )

    def filtered(block: NDArray[np.float64]) -> NDArray[np.float64]:
        from nodegraph_smooth import one_euro_kernel

        settings = recording.rate, min_cutoff, beta, derivative_cutoff
        return np.asarray(one_euro_kernel.smooth(np.ascontiguousarray(block), *settings))

    return smooth_runs(recording, filtered)

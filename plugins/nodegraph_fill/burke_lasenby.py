"""A Kalman smoother in the subspace of the complete frames."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

import numpy as np
from pydantic import Field

from nodegraph import Refusal, Unit
from nodegraph_fill.gaps import Gaps
from nodegraph_fill.state_space import StateSpace
from nodegraph_fill.tuning import Tune
from nodegraph_fill.whole_take import Estimate, TakeMatrix, whole_take
from nodegraph_mocap import Trajectories

_TOLERANCE, _NOISE = 0.0025, 0.001
"""Those of the authors' code."""
_UNKNOWN = 1e9
"""Times the noise: as good as no knowledge of the state before the first frame."""


def _adapted(settings: Mapping[str, object]) -> str:
    """Return what differs from the authors' code, which has the defaults."""
    source = "from Burke and Lasenby 2016: tolerance and noise are"
    if settings["settings"] == "tuned":
        return f"{source} tuned on the take"
    theirs = settings["tolerance"] == _TOLERANCE and settings["noise"] == _NOISE
    return "" if theirs else f"{source} not theirs"


@whole_take("fill.burke_lasenby", cite="burke_lasenby2016", adapted=_adapted)
def burke_lasenby(
    recording: Trajectories,
    gaps: Gaps,
    *,
    tolerance: Annotated[float, Field(gt=0, lt=1), Tune(0.0025, 0.01, 0.03, 0.1)] = _TOLERANCE,
    noise: Annotated[
        float, Field(ge=1e-6, allow_inf_nan=False), Unit("mm"), Tune(times=(10.0, 100.0))
    ] = _NOISE,
) -> Estimate:
    """Fill gaps by a Kalman smoother in the subspace of complete frames (Burke & Lasenby, 2016).

    Frames that have every marker, all coordinates in a row, teach the model: their mean m and
    the singular value decomposition of what is left without it, ``U S V'``. C are the first d
    columns of V, as many as keep the sum of their singular values within ``1 - tolerance`` of
    that of all. A frame is ``m + C x[t] + v[t]``, where ``x[t+1] = x[t] + w[t]`` is a random
    walk; w has the covariance ``C' diag(s) C`` with s the standard deviations of the
    coordinates' steps from one complete frame to the next, and v is noise, alike and independent
    in all coordinates. A Kalman filter forward and the smoother of Rauch, Tung and Striebel
    backward give the mean of x, all present samples being known, and so the missing ones.

    The paper's text could not be checked. The numbers, and s for the variances that would stand
    there, are those of the authors' Python code (MoGapFill); so `noise` too stands for a variance.
    That code takes the gain of its pass
    back from the frame before, a slip that is not repeated here, and starts from a random state
    of variance 1e12, which makes no difference. `fill.subspace_kalman` is the same idea without
    complete frames.

    A take with fewer than two complete frames is refused. A marker that is never measured is not
    part of "every marker". Does not depend on where the origin lies, but depends on the axes, by
    s, and on the unit by `noise`.

    For `ends` met, the estimate beside a gap is that which leaves the samples there out, as those
    in the gap are.

    Looks at the whole take.

    Parameters
    ----------
    tolerance
        Share of the sum of the singular values that is left out.
    noise
        The assumed variance of a coordinate's noise. With less than the least allowed,
        rounding would decide what is filled where many markers are missing.

    Raises
    ------
    Refusal
        If there are gaps to fill, and fewer than two complete frames.
    """
    matrix = TakeMatrix.of(recording)
    # noise that is set and not learnt is not a measure of errors
    return _learnt(matrix, tolerance, noise).estimate(matrix, gaps, with_sigma=False)


def _learnt(matrix: TakeMatrix, tolerance: float, noise: float) -> StateSpace:
    complete = np.asarray(~matrix.missing.any(axis=1))
    rows = matrix.rows[complete]
    if len(rows) < 2:
        raise Refusal(
            f"needs two complete frames: {len(rows)} of {len(complete)} have every marker that is "
            "ever measured"
        )
    middle = rows.mean(axis=0)
    _, values, components = np.linalg.svd(rows - middle, full_matrices=False)
    kept = np.cumsum(values) <= (1.0 - tolerance) * values.sum()
    basis = np.ascontiguousarray(components[: max(1, np.count_nonzero(kept))].T)
    spread = np.diff(rows, axis=0).std(axis=0)
    return StateSpace(
        middle,
        basis,
        noise=np.full(len(middle), noise),
        first=np.full(basis.shape[1], _UNKNOWN * noise),
        drift=(basis.T * spread) @ basis,
    )

"""Prediction of a missing marker from other markers, learnt by ridge regression from the take."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import Unit
from nodegraph_fill.gaps import Gaps
from nodegraph_fill.tuning import Tune
from nodegraph_fill.whole_take import Estimate, whole_take
from nodegraph_mocap import Trajectories
from nodegraph_mocap.reference_shape import reference_shape

if TYPE_CHECKING:
    from numpy.typing import NDArray

    _Model = Callable[[NDArray[np.float64]], NDArray[np.float64]]

_MOST_FRAMES = 5000
"""Frames to learn from, evenly spread over what there is: more hardly improve the fit."""


@whole_take(
    "fill.ridge",
    cite="hoerl_kennard1970",
    adapted="from Hoerl and Kennard 1970: applied to each gap, from the nearest markers",
    otherwise="no marker, or no frames, to learn from",
)
def ridge(
    recording: Trajectories,
    gaps: Gaps,
    *,
    neighbours: Annotated[int, Field(ge=1), Tune(12, 24, 40)] = 12,
    penalty: Annotated[
        float, Field(gt=0, allow_inf_nan=False), Unit("mm^2"), Tune(times=(0.1, 10.0))
    ] = 10.0,
) -> Estimate:
    """Fill gaps by ridge regression on the nearest markers (Hoerl & Kennard, 1970).

    For each gap, the markers that are present all through it and at its ends, the nearest in
    the reference shape first, predict the missing one: ``P[t, m] = c + W x[t]`` with x their
    coordinates and W, c the least ``sum |c + W x - P|^2 + penalty |W|^2`` over the frames in
    which all of them are present (5,000 of these, evenly spread, where there are more). No frame
    need be complete.

    Where no marker is present all through the gap, or no two frames to learn from, the gap
    stays missing, counted in a warning. The head's motion is learnt along with the face's:
    remove it first, where it is large.

    Looks at the whole take.

    Parameters
    ----------
    neighbours
        How many markers predict, fewer where there are fewer.
    penalty
        How strongly large coefficients are avoided, in the squares of what is learnt from.
    """
    estimate = np.full_like(recording.positions, np.nan)
    before, after = np.full((2, len(gaps.start), 3), np.nan)
    near, present = nearest_first(recording), recording.present
    models: dict[tuple[int, bytes], _Model | None] = {}
    for gap, (marker, start, stop) in enumerate(
        zip(gaps.marker, gaps.start, gaps.stop, strict=True)
    ):
        window = slice(max(start - 1, 0), stop + 1)
        whole = np.all(present[window], axis=0)
        predictors = near[marker][whole[near[marker]]][:neighbours]
        key = marker, predictors.tobytes()
        if key not in models:
            models[key] = _model(recording, present, marker, predictors, penalty)
        model = models[key]
        if model is not None:
            now = recording.positions[window][:, predictors]
            predicted = model(now.reshape(len(now), -1))
            estimate[window, marker] = predicted
            before[gap], after[gap] = predicted[0], predicted[-1]
    return Estimate(estimate, ends=(before, after))


def nearest_first(recording: Trajectories) -> NDArray[np.intp]:
    """Return the other markers, (M, M - 1), in the order of their distance to each."""
    shape = reference_shape(recording)
    squared = ((shape[:, None] - shape) ** 2).sum(axis=2)
    np.fill_diagonal(squared, -1.0)
    order = np.argsort(np.nan_to_num(squared, nan=np.inf), axis=1, kind="stable")
    return np.asarray(order[:, 1:])


def _model(
    recording: Trajectories,
    present: NDArray[np.bool_],
    marker: int,
    predictors: NDArray[np.intp],
    penalty: float,
) -> _Model | None:
    """Return the prediction of a marker from others, None if there is nothing to learn from."""
    lesson = _frames_with(present, marker, predictors)
    if not len(predictors) or len(lesson) < 2:
        return None
    known = recording.positions[np.ix_(lesson, predictors)].reshape(len(lesson), -1)
    return _learnt(known, recording.positions[lesson, marker], penalty)


def _learnt(known: NDArray[np.float64], wanted: NDArray[np.float64], penalty: float) -> _Model:
    """Return the prediction of wanted, (F, 3), from rows like the known ones, (F, P)."""
    middle, output = known.mean(axis=0), wanted.mean(axis=0)
    known, wanted = known - middle, wanted - output
    squares, vectors = np.linalg.eigh(known.T @ known)
    # along the others nothing varies but by rounding
    varied = squares > len(squares) * np.finfo(np.float64).eps * squares[-1]
    squares, vectors = squares[varied], vectors[:, varied]
    weights = vectors / (squares + penalty) @ (vectors.T @ (known.T @ wanted))
    return lambda rows: np.asarray((rows - middle) @ weights + output)


def _frames_with(
    present: NDArray[np.bool_], marker: int, predictors: NDArray[np.intp]
) -> NDArray[np.intp]:
    frames: NDArray[np.intp] = np.flatnonzero(
        present[:, marker] & np.all(present[:, predictors], axis=1)
    )
    spread = np.linspace(0, len(frames) - 1, min(len(frames), _MOST_FRAMES)).round()
    chosen: NDArray[np.intp] = frames[spread.astype(np.intp)]
    return chosen

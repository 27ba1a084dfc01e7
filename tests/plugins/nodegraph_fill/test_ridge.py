"""Prediction of a missing marker from other markers, learnt by ridge regression from the take."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_fill.meet_ends import Ends
from nodegraph_fill.ridge import ridge
from nodegraph_mocap import Origin
from tests.plugins.nodegraph_fill.plain_fills import driven
from tests.plugins.recordings import make_recording

Positions = NDArray[np.float64]
take = partial(driven, movements=4, noise=0.01, seed=3)


def solved(x: Positions, y: Positions, penalty: float, at: Positions) -> Positions:
    """The ridge estimate by its normal equations."""
    middle, goal = x.mean(axis=0), y.mean(axis=0)
    x, y = x - middle, y - goal
    w = np.linalg.solve(x.T @ x + penalty * np.eye(x.shape[1]), x.T @ y)
    return np.asarray((at - middle) @ w + goal)


@pytest.mark.parametrize("ends", ["as_published", "met"])
@pytest.mark.parametrize("penalty", [0.1, 10.0, 1e4])
def test_equals_the_normal_equations(penalty: float, ends: Ends) -> None:
    truth = take(80, 6)
    gappy = truth.copy()
    gappy[20:30, 0] = gappy[25, 5] = np.nan
    filled = ridge(
        make_recording(gappy[:, :6]), neighbours=3, penalty=penalty, ends=ends, max_gap=10
    )
    apart = np.linalg.norm(truth[0, 1:5] - truth[0, 0], axis=1)
    # the marker with a hole there does not predict, whatever its distance
    chosen = 1 + np.argsort(_shape_distances(gappy)[1:5])[:3]
    assert len(apart) == 4
    lesson = np.flatnonzero(~np.isnan(gappy[:, [0, *chosen], 0]).any(axis=1))
    x = gappy[:, chosen].reshape(len(gappy), -1)
    output = solved(x[lesson], gappy[lesson, 0], penalty, x[19:31])
    if ends == "met":
        share = np.linspace(0, 1, 12)[:, None]
        first, last = gappy[19, 0] - output[0], gappy[30, 0] - output[-1]
        output = output + (1 - share) * first + share * last
    np.testing.assert_allclose(filled.positions[20:30, 0], output[1:-1], rtol=0, atol=1e-7)


def _shape_distances(positions: Positions) -> Positions:
    """Distances to marker 0 in the first complete frame, which is the reference shape."""
    frame = int(np.argmax(~np.isnan(positions[..., 0]).any(axis=1)))
    return np.asarray(np.linalg.norm(positions[frame] - positions[frame, 0], axis=1))


def test_where_nothing_can_be_learnt_the_gap_is_left_and_reported() -> None:
    positions = take(6, 3)
    positions[1:5, 0] = np.nan
    positions[[0, 5], 1:] = np.nan
    message = "^8 samples of 3 markers left missing: no marker, or no frames, to learn from 8$"
    with pytest.warns(UserWarning, match=message):
        filled = ridge(make_recording(positions))
    assert not np.any(filled.origin[1:5, 0] == Origin.FILLED)

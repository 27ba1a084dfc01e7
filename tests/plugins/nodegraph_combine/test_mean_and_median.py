"""The mean and the median of several recordings."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from nodegraph import Across
from nodegraph_combine.mean import mean
from nodegraph_combine.median import median
from nodegraph_mocap import Trajectories

Filled = Callable[[list[float]], Across[Trajectories]]


def test_mean_is_that_of_those_that_are_there(filled: Filled, truth: Trajectories) -> None:
    combined = mean(filled([1.0, np.nan, 4.0, 7.0]))
    off = combined.positions[10:20, 1] - truth.positions[10:20, 1]
    np.testing.assert_allclose(off, np.broadcast_to([4.0, 0.0, 0.0], off.shape), atol=1e-12)


@pytest.mark.parametrize(
    ("errors", "expected"),
    [([1.0, 900.0, 3.0], 3.0), ([1.0, np.nan, 4.0], 2.5), ([np.nan, 2.0], 2.0)],
)
def test_median_is_the_middle_of_those_that_are_there(
    filled: Filled, truth: Trajectories, errors: list[float], expected: float
) -> None:
    combined = median(filled(errors))
    off = combined.positions[10:20, 1, 0] - truth.positions[10:20, 1, 0]
    np.testing.assert_allclose(off, expected, atol=1e-12)


def test_median_equals_numpys(truth: Trajectories) -> None:
    random = np.random.default_rng(1)
    many = {}
    for index in range(6):
        positions = truth.positions + random.normal(0, 1, truth.positions.shape)
        positions[random.random(truth.origin.shape) < 0.3] = np.nan
        many[str(index)] = Trajectories(positions=positions, markers=truth.markers, rate=truth.rate)
    every = np.stack([take.positions for take in many.values()])
    combined = median(Across.of(many, axis="fill"))
    seen = ~np.isnan(every).all(axis=0)
    np.testing.assert_allclose(
        combined.positions[seen], np.nanmedian(every[:, seen], axis=0), atol=1e-12
    )
    assert np.isnan(combined.positions[~seen]).all()

"""Samples hidden in recordings of a real face, and asked back."""

from __future__ import annotations

import numpy as np
import pytest

from nodegraph_fill.guenter import guenter
from nodegraph_fill.muscle import muscle
from nodegraph_gaps.cut import cut
from nodegraph_mocap import Trajectories
from tests.plugins.recordings import real_take
from tests.studies import needs_recordings

EXPECTED = {
    ("jaw", 5): (0.27, 0.28),
    ("jaw", 15): (0.63, 0.63),
    ("jaw", 45): (1.03, 1.06),
    ("cheeks", 5): (0.51, 0.50),
    ("cheeks", 15): (1.04, 1.02),
    ("cheeks", 45): (1.79, 1.78),
}
"""RMSE in mm of three muscles and of the plain mean, known to about a tenth."""


def error(take: Trajectories, length: int, seed: int) -> tuple[float, float]:
    gappy, truth, mask = cut(take, length=length, count=200, seed=seed)
    errors = []
    for fill in (muscle, guenter):
        off = (fill(gappy).positions - truth.positions)[mask.hidden]
        errors.append(float(np.sqrt((off**2).sum(axis=1).mean())))
    return errors[0], errors[1]


@needs_recordings
@pytest.mark.parametrize("name", ["jaw", "cheeks"])
def test_muscles_and_plain_mean_come_as_near_as_is_known(name: str) -> None:
    take = real_take(f"animface/{name}")
    for length in (5, 15, 45):
        actual = np.mean([error(take, length, seed) for seed in range(6)], axis=0)
        assert actual == pytest.approx(EXPECTED[name, length], rel=0.15)

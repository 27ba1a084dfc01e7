"""The time over which a recording's motion is correlated."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from nodegraph_mocap import Trajectories
from nodegraph_score.take import take_of


def recording(speed: np.ndarray[tuple[int], np.dtype[np.float64]]) -> Trajectories:
    path = np.concatenate([[0.0], np.cumsum(speed)])
    positions = np.stack([path, 0 * path, 0 * path], axis=1)[:, np.newaxis]
    return Trajectories(positions=np.repeat(positions, 2, axis=1), markers=("a", "b"), rate=60.0)


@pytest.mark.parametrize("time", [5, 20])
def test_of_an_autoregressive_speed_it_is_its_correlation_time(time: int) -> None:
    random = np.random.default_rng(time)
    found = []
    phi = np.exp(-1 / time)
    for _ in range(40):
        speed = lfilter([np.sqrt(1 - phi**2)], [1.0, -phi], random.normal(size=4000))
        found.append(take_of(recording(10 + speed)).correlation)
    assert np.median(found) == pytest.approx(phi / (1 - phi), rel=0.2)


def test_it_is_known_of_gaps_still_and_short_recordings() -> None:
    assert take_of(recording(np.zeros(100))).correlation == 0.0
    assert take_of(recording(np.ones(2))).correlation == 0.0
    whole = recording(1.0 + np.sin(np.arange(400) / 9))
    positions = whole.positions.copy()
    positions[100:150, 0] = np.nan
    gappy = Trajectories(positions=positions, markers=whole.markers, rate=60.0)
    assert take_of(gappy) == take_of(whole)
    assert take_of(whole).frames == 401
    assert take_of(whole).correlation > 5.0

"""The marker's mean position in those frames in which the other markers are most alike."""

from __future__ import annotations

import numpy as np
import pytest

from nodegraph_fill.nearest_frames import nearest_frames
from tests.plugins.recordings import make_recording


@pytest.mark.parametrize("frames", [1, 3])
def test_equals_the_plain_weighted_mean(frames: int) -> None:
    truth = np.cumsum(np.random.default_rng(1).normal(size=(25, 4, 3)), axis=0)
    gappy = truth.copy()
    gappy[8:12, 0] = gappy[3, 2] = gappy[9, 3] = np.nan
    filled = nearest_frames(make_recording(gappy), frames=frames)
    missing = np.isnan(gappy[..., 0])
    for frame, marker in np.argwhere(missing):
        apart = []
        for other in np.flatnonzero(~missing[:, marker]):
            both = ~missing[frame] & ~missing[other]
            squared = ((gappy[frame, both] - gappy[other, both]) ** 2).sum()
            apart.append((float(np.sqrt(squared * 4 / both.sum())), int(other)))
        nearest = sorted(apart)[:frames]
        weights = np.array([1 / distance for distance, _ in nearest])
        places = gappy[[other for _, other in nearest], marker]
        expected = (weights[:, None] * places).sum(axis=0) / weights.sum()
        np.testing.assert_allclose(filled.positions[frame, marker], expected, rtol=0, atol=1e-9)


def test_of_a_long_take_a_marker_seen_between_the_chosen_frames_is_found() -> None:
    positions = np.random.default_rng(4).normal(size=(9000, 2, 3))
    positions[:, 0] = np.nan
    positions[4321, 0] = 7.0
    filled = nearest_frames(make_recording(positions))
    np.testing.assert_allclose(filled.positions[:, 0], 7.0, atol=1e-9)

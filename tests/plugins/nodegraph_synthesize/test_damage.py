from __future__ import annotations

import numpy as np
import pytest

from nodegraph_mocap import Trajectories
from nodegraph_synthesize.damage import LONGEST_GAP, impulses, occlusions, unlabelled

_POINTS = np.random.default_rng(1).standard_normal((12, 3)) * 40.0


def _random(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


@pytest.mark.parametrize("share", [0.0, 0.01, 0.05, 0.2, 0.5])
@pytest.mark.parametrize("frames", [2, 25, 600])
def test_the_share_of_missing_samples_is_exact(share: float, frames: int) -> None:
    hidden = occlusions(_random(), share, frames, _POINTS)
    assert hidden.shape == (frames, 12)
    assert np.count_nonzero(hidden) == round(share * hidden.size)


def _gap_lengths(hidden: np.ndarray) -> np.ndarray:
    padded = np.pad(hidden.T, ((0, 0), (1, 1))).astype(int)
    steps = np.diff(padded, axis=1)
    return np.argwhere(steps == -1)[:, 1] - np.argwhere(steps == 1)[:, 1]


def test_gaps_have_many_lengths() -> None:
    lengths = _gap_lengths(occlusions(_random(), 0.02, 20000, _POINTS))
    assert lengths.min() == 1
    assert 30 < np.percentile(lengths, 98) <= LONGEST_GAP
    assert np.median(lengths) < 12


def test_neighbours_are_sometimes_hidden_together() -> None:
    hidden = occlusions(_random(), 0.05, 20000, _POINTS)
    distances = np.linalg.norm(_POINTS[:, None] - _POINTS[None], axis=2)
    nearest, farthest = distances.argsort(axis=1)[0, [1, -1]]
    together = np.corrcoef(hidden.T.astype(float))[0]
    assert together[nearest] > 0.05
    assert together[nearest] > together[farthest]


@pytest.mark.parametrize("share", [0.0, 0.005, 0.1, 0.2])
def test_the_share_of_impulses_is_exact_and_each_is_single(share: float) -> None:
    present = ~occlusions(_random(), 0.05, 600, _POINTS)
    hit, jumps = impulses(_random(1), share, present)
    assert np.count_nonzero(hit) == round(share * np.count_nonzero(present))
    assert not (hit & ~present).any()
    assert not (hit[1:] & hit[:-1]).any()
    assert not hit[[0, -1]].any()
    np.testing.assert_array_equal(jumps.any(axis=2), hit)


def test_impulses_that_do_not_fit_are_counted() -> None:
    with pytest.warns(UserWarning, match="0 impulses instead of 5"):
        impulses(_random(), 0.2, np.ones((2, 12), dtype=bool))


def test_detections_are_the_present_samples_in_another_order() -> None:
    positions = np.random.default_rng(2).standard_normal((50, 12, 3))
    positions[occlusions(_random(), 0.2, 50, _POINTS)] = np.nan
    positions[7] = np.nan
    captured = Trajectories(positions=positions, markers=tuple("abcdefghijkl"), rate=30.0)
    detections = unlabelled(_random(3), captured)
    assert detections.rate == 30.0
    assert detections.frames == 50
    shuffled = 0
    for frame in range(50):
        seen = positions[frame, captured.present[frame]]
        start, end = detections.offsets[frame : frame + 2]
        result = detections.points[start:end]
        assert sorted(result.tolist()) == sorted(seen.tolist())
        shuffled += not np.array_equal(result, seen)
    assert shuffled > 40

"""What other markers predict, and a Gaussian process over time of what they leave."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_fill.gaussian_process import gaussian_process
from nodegraph_fill.kriging import kriging
from nodegraph_fill.ridge import ridge
from nodegraph_gaps.cut import Cut, cut
from nodegraph_mocap import Origin, Trajectories
from nodegraph_synthesize.face import synthesize_face
from tests.plugins.recordings import make_recording


@pytest.fixture(scope="module")
def faces() -> dict[int, Cut]:
    """A made face with noise and impulses, with gaps of each length."""
    face = synthesize_face(seconds=8.0, markers=24, seed=5)
    return {length: cut(face.captured, truth=face.truth, length=length) for length in (5, 45)}


def errors(damaged: Cut, filled: Trajectories) -> NDArray[np.float64]:
    return (filled.positions - damaged.truth.positions)[damaged.hidden.hidden]


def test_is_as_good_as_the_better_of_its_two_parts(faces: dict[int, Cut]) -> None:
    for damaged in faces.values():
        own, parts = (
            [float(np.sqrt((errors(damaged, fill(damaged.gappy)) ** 2).mean())) for fill in fills]
            for fills in ((kriging,), (ridge, gaussian_process))
        )
        assert own[0] < 1.05 * min(parts)


def test_sigma_holds_about_95_in_100_errors_to_the_place_itself(faces: dict[int, Cut]) -> None:
    for damaged in faces.values():
        filled = kriging(damaged.gappy)
        assert filled.sigma is not None
        apart = np.abs(errors(damaged, filled)) / filled.sigma[damaged.hidden.hidden][:, None]
        assert 0.9 < np.mean(apart < 1.96) < 0.999


@pytest.mark.parametrize("before", [1, 4])
def test_an_impulse_is_kept_and_counts_like_a_missing_sample(
    faces: dict[int, Cut], before: int
) -> None:
    gappy = faces[45].gappy
    positions = gappy.positions.copy()
    hidden = faces[45].hidden.hidden
    marker = int(np.flatnonzero(hidden[100:].any(axis=0) & ~hidden[:100].any(axis=0))[0])
    beside = (int(hidden[:, marker].argmax()) - before, marker)
    positions[beside] += (0.0, 30.0, 0.0)
    filled = kriging(replace(gappy, positions=positions))
    np.testing.assert_array_equal(filled.positions[beside], positions[beside])
    positions = gappy.positions.copy()
    positions[beside] = np.nan
    changed = ~gappy.present.copy()
    changed[beside] = True
    without = gappy.with_samples(positions, changed=changed, origin=Origin.MISSING)
    moved = (filled.positions - kriging(without).positions)[~gappy.present]
    assert np.abs(moved).max() < 0.01


def test_a_long_gap_where_the_face_is_elsewhere_is_filled_there() -> None:
    random = np.random.default_rng(4)
    time = np.arange(600)[:, None, None] / 60.0
    drift = 40.0 * np.exp(-(((time - 5.0) / 1.5) ** 2)) * (1.0, 0.5, 0.0)
    speech = np.cumsum(random.normal(0.0, 0.1, (600, 1, 3)), axis=0)
    truth = random.normal(0.0, 40.0, (12, 3)) + drift + speech
    truth += np.cumsum(random.normal(0.0, 0.01, truth.shape), axis=0)
    positions = truth.copy()
    positions[200:400, 3] = np.nan
    off = (kriging(make_recording(positions)).positions - truth)[200:400, 3]
    assert np.abs(off.mean(axis=0)).max() < 1.0

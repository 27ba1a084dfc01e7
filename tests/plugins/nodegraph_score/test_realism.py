"""Measures of how recordings move, on movement whose measures are known."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from nodegraph import Across, Refusal
from nodegraph_mocap import Table
from nodegraph_score.realism import MEASURES, realism
from nodegraph_synthesize.smooth_noise import red_noise, smooth_noise
from tests.plugins.recordings import make_recording

RATE, FRAMES, MARKERS = 60.0, 3600, 18
SHAPE = np.random.default_rng(1).uniform(-60.0, 60.0, (MARKERS, 3))


def _measured(movement: NDArray[np.float64]) -> dict[str, float]:
    table = realism(Across.of({"a": make_recording(SHAPE + movement)}, axis="take")).table
    return dict(table.iloc[0].drop("recording"))


def _noise(slope: float | None = None) -> NDArray[np.float64]:
    random = np.random.default_rng(3)
    if slope is None:
        curves = smooth_noise(random, FRAMES, [1.0] * 3 * MARKERS, RATE)
    else:
        curves = red_noise(random, FRAMES, 3 * MARKERS, slope, RATE)
    return curves.reshape(FRAMES, MARKERS, 3)


def test_independent_normal_movement() -> None:
    measured = _measured(_noise())
    assert measured["kurtosis"] == pytest.approx(0.0, abs=0.3)
    assert measured["together"] == pytest.approx(0.0, abs=0.15)
    assert measured["components"] > 0.9
    assert measured["apart"] > 0.5
    # Velocities of 2 pi 0.5 Hz mm; 99.9 % of vectors of three normal numbers are below 4.03.
    assert measured["speed"] == pytest.approx(4.03 * np.pi, rel=0.15)


def test_bursts_and_the_slope() -> None:
    on = np.repeat(np.arange(FRAMES // 60) % 5 == 0, 60)
    soft = np.convolve(on, np.ones(20) / 20, mode="same")[:, None, None]
    assert _measured(soft * _noise())["kurtosis"] > 5.0  # 3 / 0.2 - 3 = 12 for sudden ends
    assert _measured(_noise(-3.0))["slope"] == pytest.approx(-3.0, abs=0.3)
    assert _measured(_noise(-1.0))["fast"] > 10 * _measured(_noise(-3.0))["fast"]


def test_what_moves_together_is_known_from_its_neighbours() -> None:
    random = np.random.default_rng(4)
    courses = smooth_noise(random, FRAMES, [1.0] * 3, RATE)
    low_rank = np.einsum("tk,kmc->tmc", courses, random.normal(0.0, 2.0, (3, MARKERS, 3)))
    measured = _measured(low_rank)
    assert measured["apart"] < 0.05
    assert measured["components"] < 0.1
    grown = courses[:, :1, None] * 0.05 * SHAPE  # neighbours move alike
    assert _measured(grown)["together"] > 0.5


def test_head_motion_changes_nothing() -> None:
    movement, random = _noise(), np.random.default_rng(5)
    turns = Rotation.from_rotvec(0.1 * smooth_noise(random, FRAMES, [0.5] * 3, RATE)).as_matrix()
    shifts = 20.0 * smooth_noise(random, FRAMES, [0.5] * 3, RATE)
    turned = np.einsum("tij,tmj->tmi", turns, SHAPE + movement) + shifts[:, None]
    still, moved = _measured(movement), _measured(turned - SHAPE)
    for name in MEASURES:
        # kurtosis is of coordinates, which are those of one frame
        near = 0.05 if name == "kurtosis" else 1e-6
        assert moved[name] == pytest.approx(still[name], abs=near)


def test_missing_samples_are_bridged_and_counted() -> None:
    movement = _noise()
    gappy = movement.copy()
    gappy[100:110, 3] = np.nan
    with pytest.warns(match=r"a: 0\.0154 % of the samples are bridged"):
        bridged = _measured(gappy)
    assert bridged["kurtosis"] == pytest.approx(_measured(movement)["kurtosis"], abs=0.1)


def test_people_stand_beside_the_recordings() -> None:
    take = make_recording(SHAPE + _noise())
    table: Table = realism(Across.of({"a": take, "b": take}, axis="take")).table
    assert table["recording"].tolist() == ["a", "b", "people, lowest", "people, highest"]
    lowest, highest = table.iloc[2].drop("recording"), table.iloc[3].drop("recording")
    assert (lowest < highest).all()


@pytest.mark.parametrize(
    ("frames", "rate", "markers", "message"),
    [
        (29, 60.0, 18, "a: needs 0.5 s at 20 Hz or more; got 29 frames at 60 Hz"),
        (200, 10.0, 18, "got 200 frames at 10 Hz"),
        (400, 60.0, 5, "a: needs 6 markers; 5 are ever seen"),
    ],
)
def test_too_little_is_refused(frames: int, rate: float, markers: int, message: str) -> None:
    positions = np.full((frames, MARKERS, 3), np.nan)
    positions[:, :markers] = SHAPE[:markers]
    take = make_recording(positions, rate=rate)
    with pytest.raises(Refusal, match=message):
        realism(Across.of({"a": take}, axis="take"))
    whole = make_recording(SHAPE + _noise())
    with pytest.warns(match=f"not measured: .*{message}"):
        table = realism(Across.of({"a": take, "b": whole}, axis="take")).table
    assert table["recording"].tolist()[0] == "b"

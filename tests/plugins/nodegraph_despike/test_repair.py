"""What every despiker does alike: marks and counts, turned and scaled takes, short takes."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from nodegraph_despike.acceleration import acceleration
from nodegraph_despike.hampel import hampel
from nodegraph_despike.impulse import impulse
from nodegraph_despike.median import median
from nodegraph_despike.repair import repaired
from nodegraph_despike.wavelet import wavelet
from nodegraph_mocap import Origin, Trajectories
from tests.plugins.recordings import quietly

Method = Callable[..., Trajectories]
METHODS: dict[str, Method] = {
    "simultaneous": impulse,
    "in_place": partial(impulse, order="in_place"),
    "redetect": partial(impulse, order="redetect"),
    "hampel": hampel,
    "median": median,
    "acceleration": acceleration,
    "wavelet": wavelet,
    "rbio2.2": partial(wavelet, wavelet="rbio2.2"),
}
THRESHOLDS = {"median": 2.0, "acceleration": 20_000.0}
"""Settings in millimetres, which scale with the recording."""

every = pytest.mark.parametrize("name", METHODS)


@pytest.fixture(scope="session")
def spiky(wavy: Trajectories) -> Trajectories:
    """Impulses in single frames of each marker, and gaps."""
    random = np.random.default_rng(11)
    positions = wavy.positions.copy()
    for marker in range(6):
        frames = random.choice(np.arange(5, 115, 5), 6, replace=False)
        positions[frames, marker] += random.normal(0, 8, (6, 3))
    positions[50:58, 2] = positions[70, 4] = positions[:3, 5] = np.nan
    return replace(wavy, positions=positions, origin=np.where(np.isnan(positions[..., 0]), 0, 1))


def marks(despiked: Trajectories) -> np.ndarray:
    return np.asarray(despiked.origin == Origin.REPAIRED)


@every
def test_turned_as_a_whole(name: str, spiky: Trajectories) -> None:
    turn = Rotation.from_rotvec([0.4, -1.1, 0.7]).as_matrix()
    despiked = quietly(METHODS[name], spiky)
    turned = quietly(METHODS[name], replace(spiky, positions=spiky.positions @ turn.T))
    assert marks(despiked).any()
    assert np.array_equal(marks(despiked), marks(turned))
    back = turned.positions @ turn
    assert np.allclose(back, despiked.positions, rtol=0, atol=1e-9, equal_nan=True)


@every
def test_scaled_as_a_whole(name: str, spiky: Trajectories) -> None:
    despiked = quietly(METHODS[name], spiky)
    larger = replace(spiky, positions=spiky.positions * 4.0)
    settings = {"threshold": 4.0 * THRESHOLDS[name]} if name in THRESHOLDS else {}
    scaled = quietly(METHODS[name], larger, **settings)
    assert np.array_equal(marks(despiked), marks(scaled))
    assert np.allclose(scaled.positions / 4.0, despiked.positions, atol=1e-9, equal_nan=True)


@every
def test_repaired_and_filled_samples_count_as_present(name: str, spiky: Trajectories) -> None:
    despiked = quietly(METHODS[name], spiky)
    origin = spiky.origin.copy()
    origin[::2][origin[::2] == Origin.MEASURED] = Origin.FILLED
    origin[1::3][origin[1::3] == Origin.MEASURED] = Origin.REPAIRED
    other = quietly(METHODS[name], replace(spiky, origin=origin))
    assert np.array_equal(other.positions, despiked.positions, equal_nan=True)
    stays = ~np.any(despiked.positions != spiky.positions, axis=2)
    assert np.array_equal(other.origin[stays], origin[stays])
    assert np.all(other.origin[~stays & spiky.present] == Origin.REPAIRED)


@every
@pytest.mark.parametrize("frames", [1, 2, 3, 4, 5])
def test_takes_shorter_than_any_window(name: str, frames: int) -> None:
    random = np.random.default_rng(frames)
    positions = random.normal(0, 30, (frames, 3, 3))
    positions[0, 1] = np.nan
    take = Trajectories(positions=positions, markers=("a", "b", "c"), rate=60.0)
    despiked = quietly(METHODS[name], take)
    assert np.array_equal(despiked.present, take.present)
    assert np.array_equal(despiked.positions[0], positions[0], equal_nan=True)
    assert np.array_equal(despiked.positions[-1], positions[-1], equal_nan=True)


@every
def test_constant_nowhere_and_single(name: str) -> None:
    still = np.tile([[[1.5, -2.5, 3.5], [0.1, 0.2, 0.3]]], (30, 1, 1))
    nowhere = np.full((30, 2, 3), np.nan)
    for positions in (still, nowhere, still[:, :1], nowhere[:0]):
        names = ("a", "b")[: positions.shape[1]]
        take = Trajectories(positions=positions, markers=names, rate=60.0)
        assert METHODS[name](take) is take


@every
def test_other_memory_and_float32(name: str, spiky: Trajectories) -> None:
    single = spiky.positions.astype(np.float32)
    despiked = quietly(METHODS[name], replace(spiky, positions=single.astype(np.float64)))
    others: list[Any] = [np.asfortranarray(single), np.repeat(single, 2, axis=0)[::2]]
    for positions in others:
        again = quietly(METHODS[name], replace(spiky, positions=positions))
        assert np.array_equal(again.positions, despiked.positions, equal_nan=True)


@every
def test_says_how_many_and_by_how_much(name: str, spiky: Trajectories) -> None:
    with pytest.warns(UserWarning, match="samples repaired") as caught:
        despiked = METHODS[name](spiky)
    moved = np.linalg.norm(despiked.positions - spiky.positions, axis=2)[marks(despiked)]
    matched = re.match(
        r"(\d+) samples repaired \(.* by ([\d.]+) mm on average", str(caught[0].message)
    )
    assert matched is not None
    assert int(matched[1]) == len(moved) > 0
    assert float(matched[2]) == pytest.approx(moved.mean(), rel=0.01)
    assert [warning.filename for warning in caught] == [__file__]


def noted(**changes: Any) -> Trajectories:
    positions = np.zeros((5, 2, 3))
    positions[1, 0] = np.nan
    return Trajectories(positions=positions, markers=("a", "b"), rate=60.0, **changes)


def test_marks_counts_and_means() -> None:
    recording = noted(sigma=np.full((5, 2), 0.1))
    positions = recording.positions.copy()
    positions[2, 1], positions[3, 0] = [3.0, 0.0, 4.0], [0.0, 1.0, 0.0]
    text = r"2 samples repaired \(22\.2 % of those present\), moved by 3 mm on average, by 5 mm"
    with pytest.warns(UserWarning, match=text):
        despiked = repaired(recording, positions)
    assert np.argwhere(marks(despiked)).tolist() == [[2, 1], [3, 0]]
    assert despiked.origin[1, 0] == Origin.MISSING
    assert despiked.sigma is not None
    assert np.isnan(despiked.sigma[marks(despiked)]).all()
    assert np.all(despiked.sigma[~marks(despiked) & despiked.present] == 0.1)


def test_nothing_to_repair_is_no_news() -> None:
    recording = noted()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert repaired(recording, recording.positions.copy()) is recording

"""Error, lag and movement kept."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_score.smoothness import smoothness
from nodegraph_tables import info_of
from tests.plugins.recordings import make_recording

Positions = NDArray[np.float64]


def moving(late: float = 0.0, frames: int = 600) -> Positions:
    """Two markers that swing at several frequencies and drift, some frames late."""
    seconds = (np.arange(frames) - late) / 60.0
    swings = [np.sin(2 * np.pi * hertz * seconds + hertz) for hertz in (0.7, 1.3, 2.9)]
    first = np.stack([8 * swings[0] + 5 * seconds, 3 * swings[1], swings[2]], axis=1)
    second = np.stack([2 * swings[1], 4 * swings[0] * swings[2], -7 * swings[0]], axis=1)
    return np.stack([first, second], axis=1)


def rows(estimate: Positions, truth: Positions, rate: float = 60.0) -> list[dict[object, Any]]:
    return smoothness(
        make_recording(estimate, rate=rate), make_recording(truth, rate=rate)
    ).to_dict("records")


@pytest.mark.parametrize("late", [0.0, 0.25, 0.5, 1.0, 2.3, -1.7, -12.0])
def test_lag_is_found_to_a_fraction_of_a_frame(late: float) -> None:
    for row in rows(moving(late), moving()):
        assert row["lag"] == pytest.approx(late, abs=0.02)
        assert row["kept"] == pytest.approx(1.0, abs=0.1)


def test_noise_blurs_the_lag_by_as_much_as_is_said() -> None:
    random = np.random.default_rng(4)
    truth = np.repeat(0.2 * moving(frames=240)[:, :1], 200, axis=1)
    estimate = truth + random.normal(0, 0.1, truth.shape)
    lags = np.array([row["lag"] for row in rows(estimate, truth)])
    rmse = np.sqrt(3) * 0.1
    # a third of the noise lies in the direction in which the marker moves
    spread = rmse / np.sqrt(3) / np.sqrt(np.sum(np.diff(truth[:, 0], axis=0) ** 2))
    assert lags.std() == pytest.approx(spread, rel=0.2)
    assert abs(lags.mean()) < 4 * spread / np.sqrt(200)


def test_gaps_change_the_lag_little() -> None:
    truth, estimate = moving(), moving(1.5)
    truth[100:130] = truth[300:420, 0] = estimate[150:155] = np.nan
    with pytest.warns(UserWarning, match="10 samples of the truth are missing in the estimate"):
        actual = rows(estimate, truth)
    assert [row["samples"] for row in actual] == [600 - 155, 600 - 35]
    for row in actual:
        assert row["lag"] == pytest.approx(1.5, abs=0.05)
        assert row["missing"] == 5


def test_error_is_that_of_the_shared_frames() -> None:
    truth = moving(frames=20)
    away = np.random.default_rng(1).normal(0, 1, truth.shape)
    estimate = truth + away
    estimate[3, 0] = np.nan
    with pytest.warns(UserWarning, match="1 samples of the truth"):
        actual = rows(estimate, truth)
    squared = np.sum(away**2, axis=2)
    assert actual[0]["rmse"] == pytest.approx(np.sqrt(np.mean(np.delete(squared[:, 0], 3))))
    assert actual[1]["rmse"] == pytest.approx(np.sqrt(np.mean(squared[:, 1])))


@pytest.mark.parametrize(
    ("hertz", "counts"), [(2.0, True), (5.75, True), (6.0, False), (9.0, False)]
)
def test_only_what_is_slower_than_6_hz_counts_as_movement(hertz: float, counts: bool) -> None:
    frame = (np.arange(240) + 0.5) / 60.0
    slow, wave = np.cos(2 * np.pi * 1.0 * frame), np.cos(2 * np.pi * hertz * frame)
    truth = np.zeros((240, 1, 3))
    truth[:, 0, 0] = slow
    estimate = truth.copy()
    estimate[:, 0, 1] = 2.0 * wave
    assert rows(estimate, truth)[0]["kept"] == pytest.approx(5.0 if counts else 1.0)


def still(truth: Positions) -> Positions:
    return np.ones_like(truth)


def absent(truth: Positions) -> Positions:
    return np.full_like(truth, np.nan)


@pytest.mark.parametrize(
    ("make", "kept", "message"),
    [(still, 0.0, "2 of 2 markers have no lag"), (absent, np.nan, "2 of 2 markers have no error")],
)
def test_what_has_no_value_is_nan_and_reported(
    make: Callable[[Positions], Positions], kept: float, message: str
) -> None:
    truth = make_recording(moving())
    with pytest.warns(UserWarning, match="2 of 2 markers have no |1200 samples of ") as caught:
        table = smoothness(make_recording(make(truth.positions)), truth)
    assert message in [str(warning.message) for warning in caught]
    assert list(info_of(table).notes) == [f"{warning.message}." for warning in caught]
    assert table["lag"].isna().all()
    np.testing.assert_array_equal(table["kept"], kept)


@pytest.mark.filterwarnings("ignore:1 of 1 markers have no lag")
def test_truth_that_stands_still_has_no_movement_to_keep() -> None:
    truth = np.full((50, 1, 3), 0.1)
    noise = np.random.default_rng(1).normal(0, 1, truth.shape)
    with pytest.warns(UserWarning, match="1 of 1 markers have no share of power kept"):
        row = rows(truth + noise, truth)[0]
    assert np.isnan(row["kept"])
    assert np.isnan(row["lag"])


@pytest.mark.parametrize("frames", [0, 1, 2, 3, 4, 5])
@pytest.mark.filterwarnings("ignore:.* markers have no")
def test_short_takes(frames: int) -> None:
    table = smoothness(make_recording(moving(frames=frames)), make_recording(moving(frames=frames)))
    assert table["samples"].tolist() == [frames, frames]
    assert table["rmse"].isna().all() if frames == 0 else (table["rmse"] == 0).all()

"""Another rate gives the same movement at other instants, and bridges no gap."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from nodegraph_markers.resample import resample
from nodegraph_mocap import Origin, Trajectories
from nodegraph_mocap.specimens import recordings

RATE = 60.0
SPECIMENS = recordings()


def polynomial(seconds: np.ndarray) -> np.ndarray:
    curve = np.stack([seconds**3, 2 * seconds**2 - seconds, 5 - seconds], axis=-1)
    return np.stack([curve, 3 * curve[..., ::-1] + 1], axis=1)


def recording_of(frames: int, missing: tuple[tuple[int, int], ...] = ()) -> Trajectories:
    positions = polynomial(np.arange(frames) / RATE)
    for frame, marker in missing:
        positions[frame, marker] = np.nan
    return Trajectories(positions=positions, markers=("a", "b"), rate=RATE)


@pytest.mark.parametrize("name", sorted(SPECIMENS))
def test_the_same_rate_changes_nothing(name: str) -> None:
    given = SPECIMENS[name]
    again = resample(given, rate=given.rate)
    assert np.array_equal(again.positions, given.positions, equal_nan=True)
    assert np.array_equal(again.origin, given.origin)
    assert again.sigma is given.sigma


@pytest.mark.parametrize("rate", [75.0, 120.0, 100.0, 240.0])
def test_a_cubic_is_followed_exactly(rate: float) -> None:
    again = resample(recording_of(31), rate=rate)
    assert again.frames == int(30 * rate / RATE) + 1
    assert again.rate == rate
    np.testing.assert_allclose(
        again.positions, polynomial(np.arange(again.frames) / rate), atol=1e-12
    )
    assert (again.origin == Origin.MEASURED).all()


def test_a_lower_rate_is_followed_and_reported_to_fold() -> None:
    with pytest.warns(UserWarning, match="from 60 to 25 Hz .* faster than 12.5 Hz"):
        again = resample(recording_of(31), rate=25.0)
    np.testing.assert_allclose(
        again.positions, polynomial(np.arange(again.frames) / 25.0), atol=1e-12
    )


def test_source_frames_are_handed_on_bit_for_bit() -> None:
    given = SPECIMENS["filled, repaired and with sigma"]
    again = resample(given, rate=3 * given.rate)
    assert again.frames == 3 * (given.frames - 1) + 1
    assert np.array_equal(again.positions[::3], given.positions, equal_nan=True)
    assert np.array_equal(again.origin[::3], given.origin)
    assert again.sigma is not None
    assert given.sigma is not None
    assert np.array_equal(again.sigma[::3], given.sigma, equal_nan=True)


def test_a_sample_beside_a_missing_one_is_missing() -> None:
    again = resample(recording_of(12, missing=((4, 0), (6, 0))), rate=2 * RATE)
    missing = np.flatnonzero(~again.present[:, 0])
    assert missing.tolist() == [7, 8, 9, 11, 12, 13]  # frame 5, alone between them, is 10
    assert again.present[:, 1].all()


def test_runs_are_splines_of_their_own() -> None:
    whole = recording_of(24)
    gappy = recording_of(24, missing=((10, 0),))
    moved = whole.positions.copy()
    moved[10] = np.nan
    moved[11:] += 1000.0
    far = replace(whole, positions=moved, origin=np.where(np.isnan(moved[..., 0]), 0, 1))
    for given in (gappy, far):
        again = resample(given, rate=2 * RATE)
        np.testing.assert_allclose(
            again.positions[:19, 0], polynomial(np.arange(19) / (2 * RATE))[:, 0], atol=1e-12
        )


def test_short_runs_are_parabolas_and_lines() -> None:
    three = resample(recording_of(3), rate=2 * RATE).positions[:, 0, 1]
    seconds = np.arange(5) / (2 * RATE)
    np.testing.assert_allclose(three, 2 * seconds**2 - seconds, atol=1e-12)
    two = resample(recording_of(2), rate=2 * RATE).positions[1]
    np.testing.assert_allclose(two, recording_of(2).positions.mean(axis=0), atol=1e-12)


def test_a_made_sample_is_as_trusted_as_the_less_trusted_beside_it() -> None:
    given = recording_of(6)
    origin = given.origin.copy()
    origin[2, 0], origin[3, 0] = Origin.FILLED, Origin.REPAIRED
    sigma = np.tile(np.arange(6.0)[:, None], (1, 2))
    again = resample(replace(given, origin=origin, sigma=sigma), rate=2 * RATE)
    assert again.origin[:, 0].tolist() == [1, 1, 1, 2, 2, 3, 3, 3, 1, 1, 1]
    assert again.sigma is not None
    assert again.sigma[:, 0].tolist() == [step / 2 for step in range(11)]

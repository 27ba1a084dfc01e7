"""Coefficients as PyWavelets gives them, and repaired samples without any."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import pywt  # type: ignore[import-untyped]

from nodegraph_despike.wavelet import wavelet
from nodegraph_mocap import Origin, Trajectories
from tests.plugins.nodegraph_despike.impulses import hit, make_recording
from tests.plugins.recordings import quietly

WAVELETS = ["rbio2.2", "rbio2.4", "rbio2.6"]


def coefficients(track: Any, name: str) -> np.ndarray:
    """Return level 1 of the undecimated transform, (T, 3), in mm of a lone impulse.

    Where each coefficient belongs is read from the transform of one impulse.
    """
    beyond = 16
    around = np.pad(track, ((beyond, beyond), (0, 0)), mode="reflect", reflect_type="odd")
    around = around[: len(around) // 2 * 2]
    lone = np.zeros(len(around))
    lone[beyond] = 1.0
    answer = pywt.swt(lone, name, level=1)[0][1]
    peak = int(np.argmax(np.abs(answer)))
    details = pywt.swt(around, name, level=1, axis=0)[0][1] / answer[peak]
    return np.asarray(details[peak : peak + len(track)])


def repaired(despiked: Trajectories) -> list[int]:
    return sorted(set(np.nonzero(despiked.origin == Origin.REPAIRED)[0].tolist()))


@pytest.mark.parametrize("name", WAVELETS)
def test_bad_is_what_the_transform_of_pywavelets_says(wavy: Trajectories, name: str) -> None:
    recording = hit(wavy, [30, 55, 57, 80, 81], [2.0, 1.0, -1.5])
    despiked = quietly(wavelet, recording, wavelet=name, threshold=4.0)
    for marker in range(6):
        details = coefficients(recording.positions[:, marker], name)
        length = np.linalg.norm(details, axis=1)
        high = 4.0 * np.median(length) / 0.6745
        expected = [
            t
            for t in range(1, 119)
            if length[t] > high
            and length[t] >= 0.7 * max(length[t - 1], length[t + 1])
            and min(details[t] @ details[t - 1], details[t] @ details[t + 1]) < -1e-9
        ]
        actual = np.flatnonzero(despiked.origin[:, marker] == Origin.REPAIRED)
        assert actual.tolist() == expected


@pytest.mark.parametrize("name", WAVELETS)
def test_repaired_samples_have_no_coefficient_left(wavy: Trajectories, name: str) -> None:
    recording = hit(wavy, [30, 55, 57, 80, 81], [12.0, -9.0, 8.0])
    despiked = quietly(wavelet, recording, wavelet=name)
    for marker in range(6):
        details = coefficients(despiked.positions[:, marker], name)
        frames = np.flatnonzero(despiked.origin[:, marker] == Origin.REPAIRED)
        assert {30, 55, 57, 80, 81} <= set(frames.tolist())
        assert np.abs(details[frames]).max() < 1e-9


@pytest.mark.parametrize("name", WAVELETS)
@pytest.mark.parametrize("frames", [[40], [40, 41], [40, 42], [40, 50]])
def test_impulses_are_found_and_the_motion_put_back(
    wavy: Trajectories, name: str, frames: list[int]
) -> None:
    despiked = quietly(wavelet, hit(wavy, frames, [12.0, -9.0, 8.0]), wavelet=name)
    assert set(frames) <= set(repaired(despiked))
    assert np.abs(despiked.positions - wavy.positions).max() < 0.6


def test_a_lone_impulse_is_all_that_is_repaired(wavy: Trajectories) -> None:
    for name in WAVELETS:
        despiked = quietly(wavelet, hit(wavy, [40], [12.0, -9.0, 8.0]), wavelet=name)
        assert repaired(despiked) == [40]


@pytest.mark.parametrize("name", WAVELETS)
def test_motion_that_is_a_polynomial_is_not_seen(name: str) -> None:
    moments = int(name[-1])
    time = np.arange(60) / 20.0
    noise = np.random.default_rng(1).normal(0, 0.01, (60, 1, 3))
    curve = (time ** (moments - 1))[:, None, None] * np.array([1.0, -0.5, 0.2])
    despiked = quietly(wavelet, make_recording(curve + noise), wavelet=name, threshold=8.0)
    # The reflection at the ends is not a polynomial.
    assert not any(12 <= frame < 48 for frame in repaired(despiked))
    spiky = curve + noise
    spiky[30] += 0.3
    assert 30 in repaired(quietly(wavelet, make_recording(spiky), wavelet=name, threshold=8.0))


def test_a_gap_splits_the_take_into_runs(wavy: Trajectories) -> None:
    positions = wavy.positions[:, :1].copy()
    positions[[20, 90]] += 15.0
    positions[60] = np.nan
    whole = quietly(wavelet, make_recording(positions))
    # One run far from the other does not change it; only S is common, and alike in both.
    for part in (slice(0, 60), slice(61, 120)):
        alone = quietly(wavelet, make_recording(positions[part]))
        assert np.allclose(alone.positions, whole.positions[part], rtol=0, atol=1e-9)
    assert np.isnan(whole.positions[60]).all()


@pytest.mark.parametrize("name", WAVELETS)
def test_standing_still_and_straight_motion_have_no_impulse(name: str) -> None:
    for line in (np.full(50, 3.1), np.arange(50) * 0.1 + 700.3):
        recording = make_recording(line)
        assert wavelet(recording, wavelet=name) is recording


def test_where_a_marker_mostly_stands_still_nothing_is_bad() -> None:
    held = np.concatenate([np.zeros(70), np.random.default_rng(2).normal(0, 1, 50)])
    recording = make_recording(held)
    assert wavelet(recording) is recording


def test_the_ends_of_a_run_are_never_bad(wavy: Trajectories) -> None:
    despiked = quietly(wavelet, hit(wavy, [0, 119], [50.0, 0.0, 0.0]))
    assert not {0, 119} & set(repaired(despiked))


def test_a_wavelet_that_there_is_not(wavy: Trajectories) -> None:
    with pytest.raises(ValueError, match=r"one of rbio2\.2, rbio2\.4, rbio2\.6; got 'haar'"):
        wavelet(wavy, wavelet="haar")

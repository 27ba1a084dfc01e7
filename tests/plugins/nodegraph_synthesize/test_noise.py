"""Noise of the stated size on every present sample, and on nothing else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import welch

from nodegraph_mocap import Trajectories
from nodegraph_synthesize.face import synthesize_face
from nodegraph_synthesize.noise import add
from tests.plugins.recordings import make_recording


def recording(frames: int = 400, markers: int = 15, *, missing: float = 0.1) -> Trajectories:
    random = np.random.default_rng(2)
    positions = random.normal(0, 60, (frames, markers, 3))
    positions[random.random((frames, markers)) < missing] = np.nan
    return make_recording(positions)


def test_each_coordinate_is_off_by_sigma_and_independent_of_the_others() -> None:
    take = recording(3000, 12)
    noisy, truth = add(take, sigma=0.25, seed=4)
    assert truth is take
    error = (noisy.positions - take.positions)[take.present]
    np.testing.assert_allclose(error.std(axis=0), 0.25, rtol=0.02)
    np.testing.assert_allclose(error.mean(axis=0), 0.0, rtol=0, atol=0.006)
    np.testing.assert_allclose(np.corrcoef(error.T), np.eye(3), rtol=0, atol=0.02)
    # of a normal distribution 68.27 % lie within one standard deviation, 95.45 % within two
    for width, share in ((1, 0.6827), (2, 0.9545)):
        assert np.mean(np.abs(error) < 0.25 * width) == pytest.approx(share, abs=0.006)


def test_neither_frames_nor_markers_share_noise() -> None:
    take = recording(3000, 4, missing=0.0)
    error = (add(take).noisy.positions - take.positions).reshape(3000, 12)
    np.testing.assert_allclose(np.corrcoef(error.T), np.eye(12), rtol=0, atol=0.08)
    following = [np.corrcoef(column[1:], column[:-1])[0, 1] for column in error.T]
    np.testing.assert_allclose(following, 0.0, rtol=0, atol=0.08)


def test_low_passed_noise_is_what_a_filter_leaves_of_white_noise() -> None:
    """Its size is sigma; its power at the cut-off is a quarter of that at low frequencies."""
    take = recording(6000, 8, missing=0.0)
    error = (add(take, sigma=0.3, cutoff=6.0).noisy.positions - take.positions).reshape(6000, 24)
    np.testing.assert_allclose(error.std(axis=0), 0.3, rtol=0.1)
    np.testing.assert_allclose(np.corrcoef(error.T) - np.eye(24), 0.0, rtol=0, atol=0.15)
    frequencies, power = welch(error, fs=60.0, nperseg=600, axis=0)
    mean = power.mean(axis=1)
    low = mean[(frequencies > 0.5) & (frequencies < 2.5)].mean()
    for frequency in (4.5, 6.0, 9.0, 12.0):
        near = np.abs(frequencies - frequency) < 0.25
        expected = 1.0 / (1.0 + (frequency / 6.0) ** 4) ** 2
        assert mean[near].mean() / low == pytest.approx(expected, rel=0.15)


@pytest.mark.parametrize("cutoff", [30.0, 45.0])
def test_a_cutoff_at_or_above_half_the_rate_is_refused(cutoff: float) -> None:
    expected = f"cut-off of {cutoff:g} Hz is not below half the rate, 30 Hz"
    with pytest.raises(ValueError, match=expected):
        add(recording(20, 3), cutoff=cutoff)
    with pytest.raises(ValueError, match=expected):
        synthesize_face(seconds=0.5, markers=10, noise_cutoff=cutoff)


@settings(max_examples=20)
@given(sigma=st.floats(0.01, 10.0), seed=st.integers(0, 2**40))
def test_another_sigma_is_the_same_noise_at_another_scale(sigma: float, seed: int) -> None:
    take = recording(20, 3)
    unit, other = (
        add(take, sigma=size, seed=seed).noisy.positions - take.positions for size in (1.0, sigma)
    )
    np.testing.assert_allclose(other, sigma * unit, rtol=0, atol=1e-12)


def test_a_gap_changes_nothing_of_the_noise_around_it() -> None:
    whole = recording(missing=0.0)
    gappy = whole.positions.copy()
    gappy[10:30, 2] = np.nan
    take = replace(whole, positions=gappy, origin=Trajectories.origin)
    first, other = add(whole).noisy, add(take).noisy
    np.testing.assert_array_equal(
        first.positions[take.present], other.positions[take.present], strict=True
    )


def test_the_recordings_own_sigma_adds_in_quadrature() -> None:
    take = recording()
    own = np.where(take.present, 0.3, np.nan)
    noisy = add(replace(take, sigma=own), sigma=0.4).noisy
    assert noisy.sigma is not None
    np.testing.assert_allclose(noisy.sigma, np.where(take.present, 0.5, np.nan), rtol=1e-15)
    assert add(take, sigma=0.4).noisy.sigma is None


def test_seeds_and_other_nodes_have_noise_of_their_own() -> None:
    face = synthesize_face(seconds=5, markers=20, missing=0.0, impulses=0.0)
    measured = (face.captured.positions - face.truth.positions).ravel()
    first, second = (
        (add(face.truth, seed=seed).noisy.positions - face.truth.positions).ravel()
        for seed in (0, 1)
    )
    assert abs(np.corrcoef(first, measured)[0, 1]) < 0.03
    assert abs(np.corrcoef(first, second)[0, 1]) < 0.03


def test_by_default_each_coordinate_is_off_by_a_tenth_of_a_millimetre() -> None:
    take = recording()
    stated = add(take, sigma=0.1, seed=0).noisy.positions
    np.testing.assert_array_equal(add(take).noisy.positions, stated)

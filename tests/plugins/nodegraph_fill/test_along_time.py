"""The curves of the fills along time, and what they share."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import make_interp_spline

from nodegraph_fill.akima import akima
from nodegraph_fill.cubic import cubic
from nodegraph_fill.linear import linear
from nodegraph_fill.pchip import pchip
from nodegraph_mocap import Trajectories
from tests.plugins.nodegraph_fill.plain_fills import check_hermite
from tests.plugins.recordings import make_gappy, make_recording, quietly

FILLS = (linear, pchip, cubic, akima)


@given(seed=st.integers(0, 2**32 - 1), max_gap=st.sampled_from([None, 1, 4]))
def test_linear_equals_numpy_interp(seed: int, max_gap: int | None) -> None:
    recording = make_gappy(seed)
    filled = quietly(linear, recording, max_gap=max_gap)
    time = np.arange(recording.frames)
    for marker, present in enumerate(recording.present.T):
        expected = recording.positions[:, marker].copy()
        known = np.flatnonzero(present)
        for left, right in itertools.pairwise(known):
            if max_gap is None or right - left - 1 <= max_gap:
                for axis in range(3):
                    expected[left + 1 : right, axis] = np.interp(
                        time[left + 1 : right], known, recording.positions[known, marker, axis]
                    )
        np.testing.assert_allclose(filled.positions[:, marker], expected, rtol=0, atol=1e-9)


@given(seed=st.integers(0, 2**32 - 1))
def test_cubic_equals_the_interpolating_b_spline(seed: int) -> None:
    recording = make_gappy(seed)
    filled = quietly(cubic, recording)
    for marker, present in enumerate(recording.present.T):
        known = np.flatnonzero(present)
        if len(known) < 2:
            continue
        degree = min(3, len(known) - 1)
        curve = make_interp_spline(known, recording.positions[known, marker], k=degree)
        inside = np.arange(known[0], known[-1] + 1)
        np.testing.assert_allclose(
            filled.positions[inside, marker], curve(inside), rtol=1e-9, atol=1e-7
        )


def harmonic(x: list[float], y: list[float], i: int) -> float:
    """The harmonic mean of the slopes beside an inner sample, or 0 at a turning point."""
    before = (y[i] - y[i - 1]) / (x[i] - x[i - 1])
    after = (y[i + 1] - y[i]) / (x[i + 1] - x[i])
    if before * after <= 0:
        return 0.0
    near, far = x[i] - x[i - 1], x[i + 1] - x[i]
    w1, w2 = 2 * far + near, far + 2 * near
    return (w1 + w2) / (w1 / before + w2 / after)


def test_pchip_equals_the_hermite_curve_of_harmonic_slopes() -> None:
    check_hermite(pchip, harmonic)


def akimas(x: list[float], y: list[float], i: int) -> float:
    """Akima's mean of the chords beside a sample that has two others on each side."""
    m1, m2, m3, m4 = ((y[i + k + 1] - y[i + k]) / (x[i + k + 1] - x[i + k]) for k in range(-2, 2))
    after, before = abs(m4 - m3), abs(m2 - m1)
    return (m2 + m3) / 2 if after + before == 0 else (after * m2 + before * m3) / (after + before)


def test_akima_equals_the_hermite_curve_of_akimas_slopes() -> None:
    check_hermite(akima, akimas)


@pytest.mark.parametrize("fill", FILLS, ids=lambda fill: str(fill.__name__))
def test_between_two_samples_alone_the_curve_is_straight(fill: Callable[..., Trajectories]) -> None:
    line = np.arange(6.0)[:, None, None] * np.array([1.0, -2.0, 0.5])
    gappy = line.copy()
    gappy[1:5] = np.nan
    np.testing.assert_allclose(fill(make_recording(gappy)).positions, line, rtol=0, atol=1e-12)

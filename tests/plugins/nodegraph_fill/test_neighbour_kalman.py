"""A Kalman filter of each marker, which its neighbours help where it is missing."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from nodegraph_fill.neighbour_kalman import neighbour_kalman
from tests.plugins.nodegraph_fill.plain_fills import carry, plain_gaps
from tests.plugins.recordings import make_gappy, make_recording, quietly

Positions = NDArray[np.float64]
NOWHERE = np.full(3, np.nan)


def filtered(measured: list[tuple[Positions, float]], step: float, jolt: float) -> list[Positions]:
    """The textbook's filter, from measurements and their variances; NaN is not a measurement."""
    f = np.array([[1.0, step], [0.0, 1.0]])
    h = np.array([[1.0, 0.0]])
    g = np.array([[step**2 / 2], [step]])
    state = np.zeros((2, 3))
    covariance: Positions | None = None
    expected = []
    for z, variance in measured:
        if covariance is None:
            state[0], covariance = z, np.diag([variance, jolt**2])
        else:
            state, covariance = f @ state, f @ covariance @ f.T + jolt**2 * g @ g.T
            if not np.isnan(z).any():
                gain = covariance @ h.T / (h @ covariance @ h.T + variance)
                state = state + gain @ (z[None] - h @ state)
                covariance = (np.eye(2) - gain @ h) @ covariance
        expected.append(state[0].copy())
    return expected


@given(seed=st.integers(0, 2**32 - 1), neighbours=st.sampled_from([3, 5]))
def test_equals_the_textbooks_filter(seed: int, neighbours: int) -> None:
    recording = make_gappy(seed)
    expected = recording.positions.copy()
    for marker, start, stop in plain_gaps(recording.origin):
        if start == 0 and stop == recording.frames:
            continue
        seen = start - 1 if start else stop
        present = recording.present[:, marker]
        if start:
            frames = list(range(int(present.argmax()), stop))
        else:
            later = np.flatnonzero(~present[stop:])
            end = stop + int(later[0]) if len(later) else recording.frames
            frames = list(range(end - 1, -1, -1))
        measured = []
        for frame in frames:
            if present[frame]:
                measured.append((recording.positions[frame, marker], 0.2**2))
            else:
                before = max(t for t in range(frame) if present[t]) if start else seen
                measured.append((carry(recording, before, frame, marker, neighbours), 2.0**2))
        output = filtered(measured, 1 / recording.rate, 500.0)
        for frame, place, (z, _) in zip(frames, output, measured, strict=True):
            if start <= frame < stop:
                expected[frame, marker] = NOWHERE if np.isnan(z).any() else place
    filled = quietly(
        neighbour_kalman,
        recording,
        neighbours=neighbours,
        acceleration=500.0,
        noise=0.2,
        neighbour_noise=2.0,
    )
    np.testing.assert_allclose(filled.positions, expected, rtol=0, atol=1e-7)


def moved(frames: int = 40) -> Positions:
    """Markers that walk about."""
    random = np.random.default_rng(5)
    places = random.normal(0, 30, (7, 3))
    return np.asarray(places + np.cumsum(random.normal(0, 1, (frames, 7, 3)), axis=0))


def test_fewer_than_three_neighbours_are_reported() -> None:
    gappy = moved()[:, :4]
    gappy[10:20, 0] = gappy[15:, 1] = np.nan
    message = "^35 samples of 2 markers left missing: no three neighbours that span a plane 35$"
    with pytest.warns(UserWarning, match=message):
        neighbour_kalman(make_recording(gappy[:, :3]))
    with pytest.warns(UserWarning, match="^30 samples of 2 markers left missing"):
        filled = neighbour_kalman(make_recording(gappy))
    assert filled.present[10:15, 0].all()

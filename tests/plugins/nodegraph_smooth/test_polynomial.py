"""Polynomials of segments that meet in value and slope."""

from __future__ import annotations

import numpy as np
import pytest

from nodegraph import Refusal
from nodegraph_mocap import Trajectories
from nodegraph_smooth.polynomial import polynomial
from tests.plugins.recordings import make_recording


@pytest.mark.parametrize("degree", [2, 3, 5])
def test_minimizes_the_squares_among_segments_that_meet(noisy: Trajectories, degree: int) -> None:
    smoothed = polynomial(noisy, segment=0.5, degree=degree).positions.reshape(121, -1)
    width, segments = 30, 4
    columns, meetings = np.zeros((121, segments * (degree + 1))), []
    for frame in range(121):
        segment = min(frame // width, segments - 1)
        place = (frame - width * segment) / width
        first = segment * (degree + 1)
        columns[frame, first : first + degree + 1] = place ** np.arange(degree + 1)
    for segment in range(segments - 1):
        for slope in (0, 1):
            row = np.zeros(segments * (degree + 1))
            powers = np.arange(degree + 1.0)
            row[segment * (degree + 1) : (segment + 1) * (degree + 1)] = powers**slope
            row[(segment + 1) * (degree + 1) + slope] = -1.0
            meetings.append(row)
    free = np.linalg.svd(np.array(meetings))[2][len(meetings) :].T
    basis = np.linalg.qr(columns @ free)[0]
    expected = basis @ (basis.T @ noisy.positions.reshape(121, -1))
    np.testing.assert_allclose(smoothed, expected, rtol=0, atol=1e-9)


def test_one_segment_longer_than_the_take_is_one_polynomial(noisy: Trajectories) -> None:
    smoothed = polynomial(noisy, segment=1e6, degree=9).positions.reshape(121, -1)
    time = np.linspace(-1, 1, 121)
    run = noisy.positions.reshape(121, -1)
    fitted = np.polynomial.legendre.legfit(time, run, 9)
    expected = np.polynomial.legendre.legval(time, fitted).T
    np.testing.assert_allclose(smoothed, expected, rtol=0, atol=1e-9)


def test_segments_with_no_more_frames_than_coefficients_are_refused() -> None:
    take = make_recording(np.zeros((50, 1, 3)), rate=20.0)
    with pytest.raises(Refusal, match=r"a segment of 0\.1 s is 2 frames at 20 Hz, .* more than 2"):
        polynomial(take)

"""Splines on evenly spread knots, by least squares."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_smooth.knots import fit, spans_of


def truncated_powers(
    length: int, spans: int, degree: int, repeated: int
) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """The same functions of time, written without B-splines."""
    time = np.linspace(0.0, spans, length)
    columns = [(time / spans) ** power for power in range(degree + 1)]
    for knot in range(1, spans):
        for power in range(degree - repeated + 1, degree + 1):
            columns.append(np.where(time > knot, time - knot, 0.0) ** power)
    return np.column_stack(columns)


@given(
    degree=st.integers(2, 9),
    more=st.integers(0, 60),
    spacing=st.floats(0.2, 80.0),
)
def test_every_run_that_is_long_enough_has_a_least_squares_spline_of_segments(
    degree: int, more: int, spacing: float
) -> None:
    check_least_squares(degree + 2 + more, spacing, degree, degree - 1)


@given(more=st.integers(0, 400), spacing=st.floats(1.1, 80.0))
def test_every_run_that_is_long_enough_has_a_least_squares_spline_of_smooth_joints(
    more: int, spacing: float
) -> None:
    check_least_squares(5 + more, spacing, 3, 1)


def check_least_squares(length: int, spacing: float, degree: int, repeated: int) -> None:
    run = np.random.default_rng(length).normal(0, 1, (length, 2, 3))
    smoothed = fit(run, spacing, degree=degree, repeated=repeated)
    spans = spans_of(length, spacing, degree, repeated)
    assert spans >= 1
    assert degree + 1 + (spans - 1) * repeated < length
    assert smoothed.shape == run.shape
    # residuals of a least-squares fit are orthogonal to all that was fitted
    columns = truncated_powers(length, spans, degree, repeated)
    columns /= np.linalg.norm(columns, axis=0)
    assert np.abs(columns.T @ (run - smoothed).reshape(length, -1)).max() < 1e-11


def test_knots_lie_as_near_to_the_spacing_as_whole_spans_allow() -> None:
    assert spans_of(61, 3.0, 3, 1) == 20
    assert spans_of(62, 3.0, 3, 1) == 20
    assert spans_of(61, 1000.0, 3, 1) == 1
    assert spans_of(61, 1.0, 3, 1) == 57
    assert spans_of(5, 1.0, 3, 1) == 1

"""The curve is the B-spline that has the samples for control points."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from nodegraph_mocap import Trajectories
from nodegraph_smooth.bspline import bspline
from nodegraph_smooth.bspline_weights import weights
from tests.plugins.recordings import make_gappy, make_recording, quietly

Positions = NDArray[np.float64]
ORDERS = range(1, 10)
ENDS = ["vertex", "clamped", "free"]


def with_end_vertices_repeated(run: Positions, order: int) -> Positions:
    """The uniform spline with each end vertex repeated n times in all, once per frame."""
    more = order - 1
    points = np.concatenate([np.repeat(run[:1], more, 0), run, np.repeat(run[-1:], more, 0)])
    if len(run) == 1 or order == 1:
        return run
    if len(points) < order + 1:
        raise AssertionError("needs a curve")
    knots = np.arange(len(points) + order + 1, dtype=np.float64)
    curve = BSpline(knots, points, order)
    # the parameter in the middle of a control point's own B-spline
    own = np.arange(len(run)) + more + (order + 1) / 2.0
    first, last = knots[order], knots[-order - 1]
    own[0], own[-1] = first, last
    return np.asarray(curve(np.clip(own, first, last)))


def plainly(run: Positions, order: int, ends: str) -> Positions:
    """Equations 11 and 12 for one run, sample by sample."""
    reach, length = order // 2, len(run)
    expected = run.copy()
    for frame in range(length):
        window = np.arange(frame - reach, frame + reach + 1)
        whole = window[0] >= 0 and window[-1] < length
        kept = not whole if ends == "free" else frame in (0, length - 1)
        if not kept:
            shares = [float(value) for value in weights(order)]
            expected[frame] = shares @ run[np.clip(window, 0, length - 1)]
    return expected


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("length", [1, 2, 3, 5, 8, 12, 40])
def test_vertex_is_the_curve_with_end_vertices_repeated(order: int, length: int) -> None:
    run = np.random.default_rng(length).normal(0, 10, (length, 3))
    smoothed = bspline(make_recording(run[:, None]), order=order)
    expected = with_end_vertices_repeated(run, order)
    np.testing.assert_allclose(smoothed.positions[:, 0], expected, rtol=0, atol=1e-11)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("length", [2, 3, 5, 8, 12, 40])
def test_clamped_is_the_quasi_uniform_curve_at_the_greville_abscissae(
    order: int, length: int
) -> None:
    run = np.random.default_rng(length).normal(0, 10, (length, 3))
    smoothed = bspline(make_recording(run[:, None]), order=order, ends="clamped")
    degree = min(order, length - 1)
    inner = np.arange(1.0, length - degree)
    last = float(length - degree)
    knots = np.concatenate([np.zeros(degree + 1), inner, np.full(degree + 1, last)])
    greville = [knots[at + 1 : at + degree + 1].mean() for at in range(length)]
    expected = BSpline(knots, run, degree)(np.clip(greville, 0.0, last))
    np.testing.assert_allclose(smoothed.positions[:, 0], expected, rtol=0, atol=1e-11)


@given(
    seed=st.integers(0, 2**32 - 1), order=st.sampled_from(ORDERS), ends=st.sampled_from(ENDS[::2])
)
def test_each_run_is_the_weighted_mean_of_its_formula(seed: int, order: int, ends: str) -> None:
    recording = make_gappy(seed, most_frames=70, most_markers=5)
    smoothed = quietly(bspline, recording, order=order, ends=ends)
    for marker, present in enumerate(recording.present.T):
        edges = np.flatnonzero(np.diff(present.astype(int), prepend=0, append=0))
        for start, stop in list(pairwise(edges))[::2]:
            run = recording.positions[start:stop, marker]
            expected = plainly(run, order, ends)
            np.testing.assert_allclose(
                smoothed.positions[start:stop, marker], expected, rtol=1e-12, atol=1e-12
            )


@pytest.mark.parametrize("order", ORDERS)
def test_the_interior_does_not_depend_on_the_ends(noisy: Trajectories, order: int) -> None:
    smoothed = [bspline(noisy, order=order, ends=ends).positions for ends in ENDS]
    for other in smoothed[1:]:
        np.testing.assert_array_equal(
            other[2 * order : -2 * order], smoothed[0][2 * order : -2 * order]
        )


@pytest.mark.parametrize("ends", ENDS)
def test_curve_starts_and_ends_on_the_first_and_last_sample(noisy: Trajectories, ends: Any) -> None:
    for order in ORDERS:
        smoothed = bspline(noisy, order=order, ends=ends)
        np.testing.assert_array_equal(smoothed.positions[[0, -1]], noisy.positions[[0, -1]])


def test_free_leaves_half_a_window_as_it_was(noisy: Trajectories) -> None:
    smoothed = bspline(noisy, order=7, ends="free").positions
    kept = np.all(smoothed == noisy.positions, axis=(1, 2))
    assert np.flatnonzero(kept).tolist() == [0, 1, 2, 118, 119, 120]


def test_order_one_changes_nothing() -> None:
    for seed in range(5):
        recording = make_gappy(seed, most_frames=70, most_markers=5)
        smoothed = bspline(recording, order=1)
        np.testing.assert_array_equal(smoothed.positions, recording.positions)


@pytest.mark.parametrize(
    ("order", "share"), [(3, 1.0), (4, 0.716), (5, 0.556), (6, 0.451), (7, 0.377)]
)
def test_steps_of_pure_noise_lose_variance_as_the_order_rises(order: int, share: float) -> None:
    noise = make_recording(np.random.default_rng(1).normal(0, 1, (100_000, 1, 3)))
    variance = {
        value: np.diff(bspline(noise, order=value).positions, axis=0).var() for value in (3, order)
    }
    assert variance[order] / variance[3] == pytest.approx(share, abs=0.005)


@pytest.mark.parametrize("order", [0, 10, -3])
def test_other_orders_are_errors(noisy: Trajectories, order: int) -> None:
    with pytest.raises(ValueError, match=f"order must be 1 to 9, got {order}"):
        bspline(noisy, order=order)


def test_other_ends_are_errors(noisy: Trajectories) -> None:
    with pytest.raises(ValueError, match="ends must be vertex, clamped, free, got 'open'"):
        bspline(noisy, ends="open")

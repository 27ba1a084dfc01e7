"""The compiled loops do what their docstrings say."""

from __future__ import annotations

import numpy as np
import pytest

from nodegraph_smooth.weights_kernel import BLOCK, curve_into, filter_into, rows_into


@pytest.mark.parametrize("reach", [0, 1, 2, 4])
@pytest.mark.parametrize(
    ("frames", "stride"), [(1, 3), (2, 3), (3, 3), (5, 3), (6, 3), (7, 3), (9, 6), (3000, 3)]
)
def test_filter_is_its_formula(reach: int, frames: int, stride: int) -> None:
    random = np.random.default_rng(frames)
    values, weights = random.normal(0, 100, frames * stride), random.uniform(0, 0.2, reach)
    smoothed = np.full_like(values, -1.0)
    filter_into(smoothed, values, stride, weights)
    expected = values.copy()
    for i in range(reach * stride, len(values) - reach * stride):
        expected[i] = (1.0 - 2.0 * weights.sum()) * values[i] + sum(
            weight * (values[i - k * stride] + values[i + k * stride])
            for k, weight in enumerate(weights, 1)
        )
    np.testing.assert_allclose(smoothed, expected, rtol=1e-12, atol=1e-12)
    assert frames < 3000 or len(values) > 3 * BLOCK


def test_missing_samples_spread_to_what_is_made_with_them_and_no_further() -> None:
    values = np.arange(30.0)
    values[15] = np.nan
    smoothed = np.empty(30)
    filter_into(smoothed, values, 3, np.array([0.1, 0.01]))
    assert np.flatnonzero(np.isnan(smoothed)).tolist() == [9, 12, 15, 18, 21]


def test_long_runs_get_rows_at_both_ends_and_short_ones_are_counted() -> None:
    random = np.random.default_rng(2)
    values = random.normal(0, 100, (20, 2, 3))
    values[[2, 9], 0] = np.nan
    rows, weights = random.uniform(0, 1, (2, 4)), np.array([0.2, 0.05])
    rows /= rows.sum(axis=1, keepdims=True)
    marker, start, stop = np.array([[0, 0, 0, 1], [0, 3, 10, 0], [2, 9, 20, 20]])
    smoothed = np.zeros_like(values)
    assert curve_into(smoothed, values, weights, marker, start, stop, rows) == 1
    plain = np.empty_like(values)
    filter_into(plain.reshape(-1), values.reshape(-1), 6, weights)
    for item, first, after in zip(marker[1:], start[1:], stop[1:], strict=True):
        run, expected = values[first:after, item], plain[first:after, item].copy()
        expected[:2], expected[-2:] = rows @ run[:4], (rows @ run[:-5:-1])[::-1]
        np.testing.assert_allclose(smoothed[first:after, item], expected, rtol=1e-12, atol=1e-12)
    assert np.isnan(smoothed[[2, 9], 0]).all()


def test_rows_are_weighted_means_of_whole_runs() -> None:
    random = np.random.default_rng(2)
    values = random.normal(0, 100, (20, 3, 3))
    rows = random.uniform(0, 1, (4, 4))
    rows /= rows.sum(axis=1, keepdims=True)
    smoothed, expected = values.copy(), values.copy()
    rows_into(smoothed, values, np.array([2, 0]), np.array([16, 9]), rows)
    expected[16:, 2], expected[9:13, 0] = rows @ values[16:, 2], rows @ values[9:13, 0]
    np.testing.assert_allclose(smoothed, expected, rtol=1e-12, atol=1e-12)

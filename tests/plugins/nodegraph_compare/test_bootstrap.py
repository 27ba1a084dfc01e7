from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.stats import t

import nodegraph_compare.bootstrap as module
from nodegraph_compare.bootstrap import Bootstrap

STUDIES = 1000


def plainly(values: Any, seed: int) -> tuple[float, float]:
    """The studentised interval of one column, resample by resample."""
    random = np.random.default_rng(seed)
    mean, error = values.mean(), values.std(ddof=1) / np.sqrt(len(values))
    ratios = []
    for _ in range(4000):
        drawn = random.choice(values, size=len(values))
        spread = drawn.std(ddof=1) / np.sqrt(len(values))
        ratios.append(
            (drawn.mean() - mean) / spread if spread else np.sign(drawn.mean() - mean) * 1e9
        )
    low, high = np.percentile(ratios, [2.5, 97.5])
    return mean - high * error, mean - low * error


@pytest.mark.parametrize("blocks", [8, 20, 200])
def test_the_interval_is_that_of_a_plain_loop_up_to_the_draw(blocks: int) -> None:
    values = np.random.default_rng(1).lognormal(size=blocks)
    low, high = Bootstrap(0).interval(values[:, np.newaxis])
    peer = plainly(values, seed=2)
    width = peer[1] - peer[0]
    assert low[0] == pytest.approx(peer[0], abs=0.08 * width)
    assert high[0] == pytest.approx(peer[1], abs=0.12 * width)


@pytest.mark.parametrize("blocks", [3, 4])
def test_few_blocks_have_students_interval(blocks: int) -> None:
    values = np.random.default_rng(0).normal(size=(blocks, 2))
    low, high = Bootstrap(0).interval(values)
    error = values.std(axis=0, ddof=1) / np.sqrt(blocks)
    peer = t.interval(0.95, blocks - 1, values.mean(axis=0), error)
    assert low == pytest.approx(peer[0])
    assert high == pytest.approx(peer[1])


@pytest.mark.parametrize("blocks", [0, 1, 2])
def test_two_blocks_have_none(blocks: int) -> None:
    low, high = Bootstrap(0).interval(np.ones((blocks, 3)))
    assert np.isnan(low).all()
    assert np.isnan(high).all()
    assert low.shape == (3,)


@pytest.mark.parametrize("blocks", [3, 5, 30])
def test_equal_blocks_have_no_width(blocks: int) -> None:
    low, high = Bootstrap(0).interval(np.full((blocks, 1), 0.1))
    assert low[0] == pytest.approx(0.1)
    assert high[0] == pytest.approx(0.1)


def test_a_missing_number_stays_in_its_column() -> None:
    values = np.random.default_rng(0).normal(size=(8, 2))
    values[:, 1] = np.nan
    low, high = Bootstrap(0).interval(values)
    assert np.isfinite([low[0], high[0]]).all()
    assert np.isnan([low[1], high[1]]).all()


def test_columns_do_not_depend_on_each_other_and_scale() -> None:
    values = np.random.default_rng(0).gamma(2, size=(15, 3))
    low, high = Bootstrap(3).interval(values)
    alone = Bootstrap(3).interval(values[:, [1]])
    assert (low[1], high[1]) == (pytest.approx(alone[0][0]), pytest.approx(alone[1][0]))
    larger = Bootstrap(3).interval(1000 * values + 7)
    assert larger[0] == pytest.approx(1000 * low + 7)
    # a mirror image has the mirrored interval
    mirrored = Bootstrap(3).interval(-values)
    assert -mirrored[1] == pytest.approx(low, rel=0.02)


def test_equal_seeds_draw_equal_blocks_also_when_drawn_in_parts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    values = np.random.default_rng(0).normal(size=(50, 2))
    whole = Bootstrap(4).interval(values)
    monkeypatch.setattr(module, "_DRAWN_AT_ONCE", 50 * 7)
    assert np.array_equal(whole, Bootstrap(4).interval(values))
    assert not np.array_equal(whole, Bootstrap(5).interval(values))


def test_one_bootstrap_serves_groups_of_several_sizes() -> None:
    values = np.random.default_rng(0).normal(size=(30, 2))
    bootstrap = Bootstrap(0)
    first = bootstrap.interval(values)
    bootstrap.interval(values[:12])
    assert np.array_equal(first, bootstrap.interval(values))


@pytest.mark.parametrize(
    ("blocks", "least", "most"), [(5, 0.92, 0.98), (10, 0.92, 0.97), (20, 0.92, 0.97)]
)
def test_a_known_difference_is_covered_as_often_as_the_interval_says(
    blocks: int, least: float, most: float
) -> None:
    """Paired differences of a method that is better by 0.3, over blocks of uneven difficulty."""
    random = np.random.default_rng(blocks)
    difficulty = random.lognormal(size=(blocks, STUDIES))
    better = difficulty + random.normal(scale=0.5, size=difficulty.shape)
    worse = difficulty + 0.3 + random.normal(scale=0.5, size=difficulty.shape)
    low, high = Bootstrap(0).interval(worse - better)
    assert least < np.mean((low <= 0.3) & (high >= 0.3)) < most


def test_skewed_differences_are_covered_nearly_as_often_and_better_than_by_percentiles() -> None:
    random = np.random.default_rng(0)
    differences = random.lognormal(size=(20, STUDIES))
    truth = np.exp(0.5)
    low, high = Bootstrap(0).interval(differences)
    covered = np.mean((low <= truth) & (high >= truth))
    counts = random.multinomial(20, [1 / 20] * 20, size=2000)
    ends = np.percentile(counts @ differences / 20, [2.5, 97.5], axis=0)
    assert 0.90 < covered < 0.96
    assert covered > np.mean((ends[0] <= truth) & (ends[1] >= truth)) + 0.04


def test_blocks_that_are_nearly_equal_have_an_end_that_can_be_drawn() -> None:
    values = np.array([[0.0] * 7 + [0.06], [0.24] * 7 + [0.3], [0.1 + 1e-17] * 7 + [0.1 + 2e-17]]).T
    low, high = Bootstrap(0).interval(values)
    error = values.std(axis=0, ddof=1) / np.sqrt(len(values))
    reach = t.ppf(0.975, len(values) - 1)
    assert (values.mean(axis=0) - low <= 10 * reach * error + 1e-15).all()
    assert (high - values.mean(axis=0) <= 10 * reach * error + 1e-15).all()
    assert (low[2], high[2]) == (pytest.approx(0.1, abs=1e-15), pytest.approx(0.1, abs=1e-15))

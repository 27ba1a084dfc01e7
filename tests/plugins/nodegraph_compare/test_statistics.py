from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import bootstrap, wilcoxon

from nodegraph_compare.statistics import RESAMPLES, holm, interval, resampled_means, signed_rank


def test_resampled_means_are_means_of_blocks_drawn_with_replacement() -> None:
    values = np.array([[1.0], [10.0], [100.0]])
    found = resampled_means(values, seed=0)
    drawn = {
        round((a + b + c) / 3, 9) for a in (1, 10, 100) for b in (1, 10, 100) for c in (1, 10, 100)
    }
    assert found.shape == (RESAMPLES, 1)
    assert set(found[:, 0].round(9)) == drawn


def test_every_column_gets_the_same_blocks() -> None:
    values = np.random.default_rng(0).normal(size=(30, 1)) + np.array([[0.0, 5.0, -2.0]])
    found = resampled_means(values, seed=3)
    assert found[:, 1] - found[:, 0] == pytest.approx(5.0)
    assert found[:, 2] - found[:, 0] == pytest.approx(-2.0)


def test_the_interval_is_that_of_scipy_up_to_the_draw() -> None:
    values = np.random.default_rng(1).lognormal(size=200)
    low, high = interval(resampled_means(values[:, np.newaxis], seed=0))
    peer = bootstrap((values,), np.mean, method="percentile", rng=np.random.default_rng(2))
    width = peer.confidence_interval.high - peer.confidence_interval.low
    assert low[0] == pytest.approx(peer.confidence_interval.low, abs=0.05 * width)
    assert high[0] == pytest.approx(peer.confidence_interval.high, abs=0.05 * width)


def test_equal_seeds_draw_equal_blocks_also_when_drawn_in_parts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    values = np.random.default_rng(0).normal(size=(50, 2))
    whole = resampled_means(values, seed=4)
    monkeypatch.setattr("nodegraph_compare.statistics._DRAWN_AT_ONCE", 50 * 7)
    assert np.array_equal(whole, resampled_means(values, seed=4))
    assert not np.array_equal(whole, resampled_means(values, seed=5))


def test_a_missing_number_stays_in_its_column() -> None:
    found = resampled_means(np.array([[1.0, np.nan], [2.0, np.nan]]), seed=0)
    assert np.isfinite(found[:, 0]).all()
    assert np.isnan(found[:, 1]).all()


def test_the_signed_rank_p_is_scipys() -> None:
    differences = np.random.default_rng(0).normal(0.3, size=25)
    assert signed_rank(differences) == wilcoxon(differences).pvalue


def test_the_signed_rank_p_by_hand() -> None:
    assert signed_rank(np.array([1.0, 2.0, 3.0, 4.0, 5.0])) == pytest.approx(2 / 2**5)


def test_no_difference_at_all_has_p_one() -> None:
    assert signed_rank(np.zeros(10)) == 1.0


def test_ties_and_zeros_are_no_warning() -> None:
    assert 0 < signed_rank(np.array([0.0, 0.0, 1.0, 1.0, -1.0, 2.0])) <= 1


def test_holm_by_hand() -> None:
    found = holm(np.array([0.01, np.nan, 0.04, 0.03, 0.5]))
    assert found == pytest.approx([0.04, np.nan, 0.09, 0.09, 0.5], nan_ok=True)


@settings(max_examples=50, deadline=None)
@given(st.lists(st.floats(0, 1), min_size=1, max_size=12))
def test_holm_keeps_the_order_and_only_raises(values: list[float]) -> None:
    p = np.array(values)
    adjusted = holm(p)
    order = np.argsort(p, kind="stable")
    assert (adjusted >= p).all()
    assert adjusted.max() <= 1
    assert (np.diff(adjusted[order]) >= 0).all()
    assert adjusted.min() == pytest.approx(min(1.0, p.min() * len(p)))

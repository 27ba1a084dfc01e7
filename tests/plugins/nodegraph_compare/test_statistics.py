from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import binomtest, rankdata, ttest_1samp, wilcoxon

from nodegraph_compare import statistics
from nodegraph_compare.statistics import (
    holm,
    p_values,
    rank_biserial,
    sign,
    signed_rank,
    student,
)


def mixed(blocks: int = 25) -> Any:
    """Differences of which some columns have ties, zeros or nothing else."""
    random = np.random.default_rng(0)
    plain = random.normal(0.3, size=(blocks, 4))
    tied = random.integers(-3, 4, size=(blocks, 3)).astype(float)
    return np.concatenate([plain, tied, np.abs(plain[:, :1])], axis=1)


@pytest.mark.parametrize("blocks", [1, 2, 6, 9, 14, 25, 60])
def test_the_signed_rank_p_of_each_column_is_scipys(blocks: int) -> None:
    differences = mixed(blocks)
    result = signed_rank(differences)
    for p, column in zip(result, differences.T, strict=True):
        assert p == pytest.approx(wilcoxon(column).pvalue if column.any() else 1.0)


def test_the_signed_rank_p_by_hand() -> None:
    assert signed_rank(np.array([[1.0], [2.0], [3.0], [4.0], [5.0]])) == pytest.approx(2 / 2**5)


def test_ties_are_exact_for_up_to_thirteen_blocks_by_hand() -> None:
    # ranks 1.5, 1.5, 3: of eight signs, sums of at least 4.5 have (+, -, +), (-, +, +), (+, +, +)
    assert signed_rank(np.array([[-1.0], [1.0], [2.0], [0.0]])) == pytest.approx(6 / 8)


def test_no_difference_at_all_has_p_one() -> None:
    nothing = np.zeros((10, 2))
    for test in (signed_rank, student, sign):
        assert test(nothing).tolist() == [1.0, 1.0]


def test_the_paired_t_test_is_scipys() -> None:
    differences = mixed()
    assert student(differences) == pytest.approx(ttest_1samp(differences, 0.0, axis=0).pvalue)


def test_equal_differences_are_certain_and_a_single_one_is_not_known() -> None:
    assert student(np.full((5, 1), 0.25)).tolist() == [0.0]
    assert np.isnan(student(np.array([[1.0]]))).all()


def test_the_sign_test_is_scipys_without_the_zeros() -> None:
    differences = mixed()
    for p, column in zip(sign(differences), differences.T, strict=True):
        above, some = int((column > 0).sum()), int((column != 0).sum())
        assert p == pytest.approx(binomtest(above, some).pvalue)


@pytest.mark.parametrize("test", ["wilcoxon", "t", "sign", "none"])
def test_no_block_or_no_test_is_no_p(test: statistics.Test) -> None:
    assert np.isnan(p_values(np.empty((0, 3)), test)).all()
    assert np.isnan(p_values(mixed(), "none")).all()


def test_the_rank_biserial_correlation_by_hand() -> None:
    differences = np.array([[1.0, 2.0, -1.0, 0.0], [2.0, 2.0, -5.0, 0.0], [-3.0, 0.0, -2.0, 0.0]])
    assert rank_biserial(differences).tolist() == [0.0, 1.0, -1.0, 0.0]


def test_the_rank_biserial_correlation_is_that_of_plain_rank_sums() -> None:
    for effect, column in zip(rank_biserial(mixed()), mixed().T, strict=True):
        some = column[column != 0]
        ranks = rankdata(np.abs(some))
        plus, minus = ranks[some > 0].sum(), ranks[some < 0].sum()
        assert effect == pytest.approx((plus - minus) / (plus + minus))


def test_holm_by_hand() -> None:
    result = holm(np.array([0.01, np.nan, 0.04, 0.03, 0.5]))
    assert result == pytest.approx([0.04, np.nan, 0.09, 0.09, 0.5], nan_ok=True)


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

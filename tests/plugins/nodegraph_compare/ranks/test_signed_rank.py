from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.stats import rankdata, wilcoxon

from nodegraph_compare.ranks.signed_rank import holm, rank_biserial, signed_rank


def mixed(blocks: int = 25) -> NDArray[np.float64]:
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
    assert signed_rank(np.zeros((10, 2))).tolist() == [1.0, 1.0]


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


@given(st.lists(st.floats(0, 1), min_size=1, max_size=12))
def test_holm_keeps_the_order_and_only_raises(values: list[float]) -> None:
    p = np.array(values)
    adjusted = holm(p)
    order = np.argsort(p, kind="stable")
    assert (adjusted >= p).all()
    assert adjusted.max() <= 1
    assert (np.diff(adjusted[order]) >= 0).all()
    assert adjusted.min() == pytest.approx(min(1.0, p.min() * len(p)))

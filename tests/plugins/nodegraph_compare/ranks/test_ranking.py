from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import binom, friedmanchisquare, rankdata, studentized_range, wilcoxon

from nodegraph_compare.blocks import Group
from nodegraph_compare.ranks.ranking import PairTest, critical_difference, rank, runs
from nodegraph_compare.ranks.signed_rank import holm
from tests.plugins.nodegraph_compare.scores import group_of

scikit_posthocs: Any = import_module("scikit_posthocs")
STUDIES = 1000
NAN = np.nan


def group(values: object) -> Group:
    array = np.asarray(values, dtype=float)
    return group_of((), tuple(f"m{place}" for place in range(array.shape[1])), array)


def scores(blocks: int = 12, methods: int = 5, *, tied: bool = False) -> NDArray[np.float64]:
    random = np.random.default_rng(7)
    result = random.gamma(2, size=(blocks, 1)) + random.normal(size=(blocks, methods))
    result = result + 0.4 * np.arange(methods)
    return np.round(result) if tied else result


@pytest.mark.parametrize("tied", [False, True])
def test_friedman_is_scipys(tied: bool) -> None:
    values = scores(tied=tied)
    overall = rank(group(values), "lower", "nemenyi").overall
    peer = friedmanchisquare(*values.T)
    assert overall.chi2 == pytest.approx(peer.statistic)
    assert overall.p == pytest.approx(peer.pvalue)
    assert overall.w == pytest.approx(peer.statistic / (12 * 4))


def test_iman_and_davenports_f_is_that_of_an_analysis_of_variance_of_the_ranks() -> None:
    values = scores(tied=True)
    overall = rank(group(values), "lower", "nemenyi").overall
    ranks = rankdata(values, axis=1)
    treatments = len(ranks) * np.square(ranks.mean(axis=0) - 3).sum() / 4
    error = np.square(ranks - ranks.mean(axis=0)).sum() / (4 * 11)
    assert overall.f == pytest.approx(treatments / error)


@pytest.mark.parametrize("tied", [False, True])
def test_nemenyi_is_that_of_scikit_posthocs(tied: bool) -> None:
    values = scores(tied=tied)
    ranking = rank(group(values), "lower", "nemenyi").pairs
    peer = scikit_posthocs.posthoc_nemenyi_friedman(values).to_numpy()
    assert ranking.p == pytest.approx(peer[ranking.first, ranking.second], abs=1e-9)


def test_wilcoxon_with_holm_is_that_of_scikit_posthocs() -> None:
    values = scores()
    ranking = rank(group(values), "lower", "wilcoxon_holm").pairs
    p = np.array(
        [
            wilcoxon(values[:, a], values[:, b]).pvalue
            for a, b in zip(ranking.first, ranking.second, strict=True)
        ]
    )
    assert ranking.p == pytest.approx(holm(p))
    peer = scikit_posthocs.posthoc_wilcoxon(list(values.T), p_adjust="holm").to_numpy()
    assert ranking.p == pytest.approx(peer[ranking.first, ranking.second])


@pytest.mark.parametrize(
    ("methods", "quantile"),
    [(2, 1.960), (3, 2.343), (4, 2.569), (5, 2.728), (6, 2.850), (7, 2.949), (10, 3.164)],
)
def test_critical_differences_are_those_of_demsars_table_5(methods: int, quantile: float) -> None:
    # q / sqrt(2) at 5 %, as printed
    expected = quantile * np.sqrt(methods * (methods + 1) / (6 * 30))
    assert critical_difference(30, methods) == pytest.approx(expected, abs=6e-4)


def test_two_methods_are_apart_from_the_critical_difference_on() -> None:
    values = scores(40)
    ranking = rank(group(values), "lower", "nemenyi")
    apart = np.abs(ranking.ranks[ranking.pairs.first] - ranking.ranks[ranking.pairs.second])
    assert ((apart >= ranking.overall.critical) == (ranking.pairs.p <= 0.05)).all()
    at = studentized_range.sf(ranking.overall.critical * np.sqrt(2 * 6 * 40 / (5 * 6)), 5, np.inf)
    assert at == pytest.approx(0.05)


def test_mean_ranks_by_hand_with_ties_and_either_end() -> None:
    values = [[1.0, 2.0, 3.0], [5.0, 5.0, 9.0], [4.0, 4.0, 4.0]]
    assert rank(group(values), "lower", "nemenyi").ranks == pytest.approx([4.5 / 3, 5.5 / 3, 8 / 3])
    higher = rank(group(values), "higher", "nemenyi")
    assert higher.ranks == pytest.approx([7.5 / 3, 6.5 / 3, 4 / 3])
    assert rank(group(values), "none", "nemenyi").ranks[0] == 1.5


def test_the_effect_is_positive_where_the_first_is_better() -> None:
    values = [[1.0, 2.0, 2.0], [1.0, 3.0, 0.0], [2.0, 5.0, 4.0]]
    lower = rank(group(values), "lower", "nemenyi").pairs
    assert (lower.first.tolist(), lower.second.tolist()) == ([0, 0, 1], [1, 2, 2])
    assert lower.effect[0] == 1.0
    assert rank(group(values), "higher", "nemenyi").pairs.effect == pytest.approx(-lower.effect)


def test_incomplete_blocks_and_methods_without_a_number_do_not_count() -> None:
    values = scores(6, 4)
    values[0, 1] = NAN
    values[:, 2] = NAN
    ranking = rank(group(values), "lower", "nemenyi")
    assert ranking.methods == ("m0", "m1", "m3")
    assert ranking.values.shape == (5, 3)
    assert ranking.ranks == pytest.approx(rankdata(values[1:, [0, 1, 3]], axis=1).mean(axis=0))


def test_two_methods_are_compared_by_wilcoxon_alone() -> None:
    values = scores(15, 2)
    tests: tuple[PairTest, ...] = ("nemenyi", "wilcoxon_holm")
    for test in tests:
        ranking = rank(group(values), "lower", test)
        assert ranking.pairs.p == pytest.approx(wilcoxon(values[:, 0], values[:, 1]).pvalue)
        assert np.isnan(ranking.overall.chi2)


def test_one_method_has_no_pairs_and_ranks_first() -> None:
    ranking = rank(group([[1.0], [2.0]]), "lower", "nemenyi")
    assert ranking.ranks.tolist() == [1.0]
    assert len(ranking.pairs.p) == 0
    assert runs(ranking) == []


@pytest.mark.parametrize("test", ["nemenyi", "wilcoxon_holm"])
def test_ties_everywhere_are_no_difference(test: PairTest) -> None:
    ranking = rank(group(np.ones((8, 4))), "lower", test)
    assert (ranking.overall.chi2, ranking.overall.p, ranking.overall.p_f, ranking.overall.w) == (
        0,
        1,
        1,
        0,
    )
    assert ranking.ranks.tolist() == [2.5] * 4
    assert ranking.pairs.p == pytest.approx(1.0)
    assert ranking.pairs.effect.tolist() == [0.0] * 6
    assert runs(ranking) == [(0, 3)]


@pytest.mark.parametrize("blocks", range(5, 40))
@pytest.mark.parametrize("row", [[1.0, 2.0, 3.0, 4.0], [1.0, 1.0, 3.0], [1.0, 2.0, 2.0, 2.0, 3.0]])
def test_blocks_that_all_rank_alike(blocks: int, row: list[float]) -> None:
    ranking = rank(group([row] * blocks), "lower", "nemenyi")
    assert ranking.overall.w == 1.0
    assert ranking.overall.p_f == 0.0
    assert ranking.overall.f == np.inf


@pytest.mark.parametrize("blocks", [0, 1])
def test_too_few_blocks(blocks: int) -> None:
    ranking = rank(group(np.full((2, 3), NAN) if not blocks else scores(1, 3)), "lower", "nemenyi")
    assert np.isnan(ranking.overall.p)
    assert len(ranking.values) == blocks


def test_bars_join_methods_of_which_no_two_are_apart() -> None:
    ranking = rank(group(scores(60, 6)), "lower", "nemenyi")
    order = np.argsort(ranking.ranks)
    apart = np.zeros((6, 6), dtype=bool)
    apart[ranking.pairs.first, ranking.pairs.second] = ranking.pairs.p < 0.05
    apart = (apart | apart.T)[np.ix_(order, order)]
    joined = {
        (a, b)
        for first, last in runs(ranking)
        for a in range(first, last)
        for b in range(a + 1, last + 1)
    }
    assert apart.any()
    assert joined == {(a, b) for a in range(6) for b in range(a + 1, 6) if not apart[a, b]}


def bounds() -> tuple[float, float]:
    """Between which the share of rejections lies in 999 of 1000 such tests, at a true 5 %."""
    low, high = binom.interval(0.999, STUDIES, 0.05)
    return low / STUDIES, high / STUDIES


def equal_methods(blocks: int, methods: int) -> NDArray[np.float64]:
    """Studies in which all methods are equal: (STUDIES, blocks, methods), uneven blocks."""
    random = np.random.default_rng(2024)
    difficulty = random.lognormal(size=(STUDIES, blocks, 1))
    return difficulty * random.gamma(4, size=(STUDIES, blocks, methods))


def test_where_all_are_equal_one_study_in_twenty_rejects() -> None:
    low, high = bounds()
    studies = [rank(group(value), "lower", "nemenyi") for value in equal_methods(20, 5)]
    shares = {
        "chi2": np.mean([value.overall.p < 0.05 for value in studies]),
        "F": np.mean([value.overall.p_f < 0.05 for value in studies]),
        "Nemenyi": np.mean([value.pairs.p.min() < 0.05 for value in studies]),
    }
    assert low < shares["F"] < high
    # these two are known to be somewhat conservative, never liberal
    assert 0.02 < shares["chi2"] < high
    assert 0.02 < shares["Nemenyi"] < high


def test_where_all_are_equal_wilcoxon_with_holm_claims_a_difference_in_one_study_in_twenty() -> (
    None
):
    studies = [rank(group(value), "lower", "wilcoxon_holm") for value in equal_methods(20, 4)]
    assert 0.015 < np.mean([value.pairs.p.min() < 0.05 for value in studies]) < bounds()[1]

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.stats import tukey_hsd

from nodegraph_compare.blocks import Group
from nodegraph_compare.bootstrap import Bootstrap
from nodegraph_compare.statistics import range_quantile
from nodegraph_compare.table.summary import Summary, summarise

NAN = np.nan


def summary(values: Any, end: Any = "lower", *, against: Any = None) -> Summary:
    array = np.asarray(values, dtype=float)
    nothing = np.zeros(array.shape[1])
    methods = tuple(f"m{place}" for place in range(array.shape[1]))
    group = Group((), methods, array, nothing, nothing)
    return summarise(group, end, Bootstrap(0), against=against, test="wilcoxon")


@pytest.mark.parametrize(("end", "bests"), [("lower", [1, 3]), ("higher", [2]), ("none", [])])
def test_the_best_means_are_at_the_better_end(end: str, bests: list[int]) -> None:
    result = summary([[2.0, 1.0, 5.0, 1.0], [2.0, 1.0, 6.0, 1.0]], end)
    assert np.flatnonzero(result.bests).tolist() == bests
    assert result.best == (bests[0] if bests else None)


def test_better_in_counts_blocks_on_the_better_side() -> None:
    values = [[1.0, 2.0], [1.0, 0.5], [3.0, 4.0], [5.0, 5.0]]
    lower, higher, none = (
        summary(values, end, against="m0").paired for end in ("lower", "higher", "none")
    )
    assert lower is not None
    assert higher is not None
    assert none is not None
    assert (lower.better[1], higher.better[1]) == (0.25, 0.5)
    assert np.isnan([lower.better[0], none.better[1]]).all()
    assert lower.mean[1] == higher.mean[1] == 0.375


def test_the_range_of_two_is_students_and_that_of_more_is_tukeys() -> None:
    assert range_quantile(2, 19) == pytest.approx(2.093024, abs=1e-5)
    samples = np.random.default_rng(0).normal(size=(3, 8))
    interval = tukey_hsd(*samples).confidence_interval(0.95)
    error = np.sqrt(2 * samples.var(axis=1, ddof=1).mean() / 8)
    half = (np.asarray(interval.high) - np.asarray(interval.low))[0, 1] / 2
    assert range_quantile(3, 21) == pytest.approx(half / error, rel=1e-5)


@pytest.mark.parametrize(("methods", "blocks"), [(2, 20), (5, 10), (17, 20)])
def test_of_equal_methods_any_is_behind_in_about_one_study_in_twenty(
    methods: int, blocks: int
) -> None:
    random = np.random.default_rng(methods)
    studies = random.normal(size=(1000, blocks, methods)) + random.normal(size=(1000, blocks, 1))
    share = np.mean([_any_behind(value) for value in studies])
    assert 0.025 < share < 0.085


def _any_behind(values: Any) -> bool:
    from nodegraph_compare.table.summary import behind_best

    return bool(behind_best(values, values.mean(axis=0), "lower").any())


def test_a_method_that_is_far_off_is_behind_at_either_end() -> None:
    random = np.random.default_rng(0)
    values = random.normal(size=(20, 3)) + np.array([0.0, 0.1, 9.0])
    assert summary(values).behind.tolist() == [False, False, True]
    assert summary(values, "higher").behind.tolist() == [True, True, False]
    assert not summary(values, "none").behind.any()


def test_equal_differences_are_behind_and_no_difference_is_not() -> None:
    assert summary([[1.0, 1.0, 2.0]] * 4).behind.tolist() == [False, False, True]


def test_two_blocks_leave_nobody_behind() -> None:
    assert not summary([[1.0, 9.0], [1.5, 9.0]]).behind.any()


def test_nothing_complete_is_nan() -> None:
    result = summary([[1.0, NAN], [NAN, 2.0]])
    assert np.isnan([result.mean, result.rms, result.median, result.sd, result.low]).all()
    assert result.best is None
    assert result.blocks.tolist() == [0, 0]

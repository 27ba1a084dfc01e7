from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray
from scipy.stats import studentized_range, t, ttest_rel, tukey_hsd

from nodegraph_compare.inference import (
    contrasts,
    mean_interval,
    posterior,
    range_quantile,
)

Y = np.array([[1, 1.2, 1.9], [0.5, 0.9, 1.1], [0.8, 0.7, 1.6], [1.1, 1.3, 2.4], [0.6, 1.1, 1.2]])


def test_the_floored_tukey_rule_by_a_worked_example() -> None:
    result = contrasts(Y, 0, in_steps=False)
    q = studentized_range.ppf(0.95, 3, 8) / np.sqrt(2)
    error = (result.high - result.mean)[1:] / q
    assert error == pytest.approx([0.14742, 0.14742], abs=5e-6)
    assert result.mean[1:] / error == pytest.approx([1.6280, 5.6979], abs=5e-5)
    assert result.p == pytest.approx([1.0, 0.28933, 0.00117], abs=5e-6)


def test_what_is_behind_is_set_aside_and_the_rest_judged_again() -> None:
    result, rest = contrasts(Y, 0), contrasts(Y[:, :2], 0, in_steps=False)
    assert result.p[2] == contrasts(Y, 0, in_steps=False).p[2]
    for name in ("p", "low", "high"):
        assert getattr(result, name)[1] == getattr(rest, name)[1]
    assert rest.p[1] == pytest.approx(ttest_rel(Y[:, 1], Y[:, 0]).pvalue)


@given(arrays(np.float64, (5, 6), elements=st.sampled_from([0.0, 0.1, 0.5, 2.0, 30.0])))
def test_steps_agree_with_a_search_for_the_rest_that_stands(y: NDArray[np.float64]) -> None:
    """What is left is the largest set around the best in which nothing is apart by itself."""
    y = y + np.linspace(0.0, 0.3, 6) * np.arange(1, 6)[:, np.newaxis]
    best = int(y.mean(axis=0).argmin())
    left, least = list(range(6)), 0.0
    result = contrasts(y, best)
    while len(left) > 1:
        stage = contrasts(y[:, left], left.index(best), in_steps=False)
        falls = [at for at, p in enumerate(stage.p) if p <= 0.05]
        for at in falls or range(len(left)):
            assert result.p[left[at]] == pytest.approx(max(least, stage.p[at]), rel=1e-9)
            assert result.low[left[at]] == pytest.approx(stage.low[at])
        if not falls:
            break
        least = max(least, *(float(stage.p[at]) for at in falls))
        left = [method for at, method in enumerate(left) if at not in falls]
    assert (result.p <= 0.05).tolist() == [method not in left for method in range(6)]
    assert ((result.low > 0) | (result.high < 0)).tolist() == (result.p <= 0.05).tolist()


def test_each_pair_has_one_p() -> None:
    forth, back = contrasts(Y, 0, in_steps=False), contrasts(Y, 2, in_steps=False)
    assert forth.p[2] == pytest.approx(back.p[0])


def test_two_methods_are_compared_by_the_paired_t_test() -> None:
    pair = contrasts(Y[:, :2], 0)
    peer = ttest_rel(Y[:, 1], Y[:, 0])
    assert [pair.p[1], pair.p_alone[1]] == pytest.approx([peer.pvalue] * 2, rel=1e-6)
    assert pair.low[1] == pytest.approx(peer.confidence_interval().low)


def test_the_smallest_margin_shown_is_where_two_one_sided_tests_reach_five_percent() -> None:
    pair = contrasts(Y[:, :2], 0)
    assert 1 - t.cdf((pair.margin[1] - pair.mean[1]) / pair.own[1], 4) == pytest.approx(0.05)


def test_of_five_units_no_flip_of_signs_is_below_one_in_sixteen() -> None:
    assert contrasts(Y, 0).p_of_flips.tolist() == [1.0, 0.125, 0.0625]
    many = np.random.default_rng(0).normal(size=(20, 1)) + np.array([0.0, 5.0])
    assert contrasts(many, 0).p_of_flips[1] == pytest.approx(1 / 4096, abs=1e-3)


def test_means_of_recordings_are_removed_from_their_parts() -> None:
    random = np.random.default_rng(0)
    y = random.normal(size=(20, 3)) * 0.1 + np.repeat(random.normal(size=(2, 3)), 10, axis=0)
    strata = np.repeat([0, 1], 10)
    parts, whole = contrasts(y, 0, strata), contrasts(y, 0)
    assert (parts.freedom, whole.freedom) == (18, 19)
    assert (parts.own[1:] < whole.own[1:]).all()
    pooled = np.sqrt(np.mean([y[:10, 1].var(ddof=1), y[10:, 1].var(ddof=1)]) / 20)
    low, high = mean_interval(y, strata)
    assert (high - low)[1] / 2 == pytest.approx(t.ppf(0.975, 18) * pooled)


@pytest.mark.parametrize("y", [np.ones((6, 3)), np.log([[0.3, 0.1 + 0.2, 0.3]] * 4)])
def test_equal_methods_are_never_apart(y: NDArray[np.float64]) -> None:
    result = contrasts(y, 0)
    assert result.p.tolist() == [1.0] * 3
    assert result.effect.tolist() == [0.0] * 3


def test_a_constant_difference_is_certain() -> None:
    result = contrasts(np.array([[0.3, 0.2], [0.2, 0.1], [0.7, 0.6], [1.1, 1.0]]), 1)
    assert result.p.tolist() == [0.0, 1.0]


def test_probabilities_by_a_worked_example() -> None:
    d, margin = np.array([0.05, 0.20, -0.02, 0.15, 0.10]), np.log(1.1)
    assert posterior(d, 0.002, margin) == pytest.approx([0.0017, 0.4909, 0.5074], abs=5e-5)
    new = posterior(d, 0.002, margin, new=True)
    assert new == pytest.approx([0.0332, 0.4630, 0.5039], abs=5e-5)


def test_the_range_of_two_is_students_and_that_of_more_is_tukeys() -> None:
    assert range_quantile(2, 19) == pytest.approx(2.093024, abs=1e-5)
    samples = np.random.default_rng(0).normal(size=(3, 8))
    interval = tukey_hsd(*samples).confidence_interval(0.95)
    error = np.sqrt(2 * samples.var(axis=1, ddof=1).mean() / 8)
    half = (np.asarray(interval.high) - np.asarray(interval.low))[0, 1] / 2
    assert range_quantile(3, 21) == pytest.approx(half / error, rel=1e-5)

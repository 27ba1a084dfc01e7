from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import linregress, t, ttest_1samp

from nodegraph_compare.agreement.limits import REACH, limits

STUDIES = 1000


def test_bias_and_limits_by_hand() -> None:
    result = limits(np.array([1.0, 2.0, 4.0]), np.array([0.0, 2.0, 1.0]))
    sd = np.std([1, 0, 3], ddof=1)
    assert result.bias == pytest.approx(4 / 3)
    assert result.lower == pytest.approx(4 / 3 - 1.959964 * sd)
    assert result.upper == pytest.approx(4 / 3 + 1.959964 * sd)
    assert result.middle.tolist() == [0.5, 2.0, 2.5]
    assert result.of_bias == pytest.approx(t.interval(0.95, 2, 4 / 3, sd / np.sqrt(3)))


def test_the_slope_is_that_of_scipy() -> None:
    random = np.random.default_rng(0)
    truth = random.uniform(1, 10, size=40)
    first, second = truth * 1.1 + random.normal(size=40), truth + random.normal(size=40)
    result = limits(first, second)
    peer = linregress((first + second) / 2, first - second)
    reach = t.ppf(0.975, 38) * peer.stderr
    assert result.slope == pytest.approx(peer.slope)
    assert result.of_slope == pytest.approx((peer.slope - reach, peer.slope + reach))


def test_the_ends_of_a_limits_interval_are_passed_as_rarely_as_they_say() -> None:
    random = np.random.default_rng(0)
    differences = random.normal(size=(30, 200_000))
    mean, sd = differences.mean(axis=0), differences.std(axis=0, ddof=1)
    result = limits(differences[:, 0], np.zeros(30))
    for end, share in zip(result.of_upper, (0.975, 0.025), strict=True):
        factor = (end - result.bias) / result.sd
        assert np.mean(mean + factor * sd < REACH) == pytest.approx(share, abs=0.003)


@pytest.mark.parametrize("blocks", [5, 20])
def test_intervals_cover_as_often_as_they_say(blocks: int) -> None:
    random = np.random.default_rng(blocks)
    covered = np.zeros(3)
    for _ in range(STUDIES):
        truth = random.lognormal(size=blocks)
        result = limits(truth + random.normal(0.3, 1.2, size=blocks), truth)
        ends = (result.of_bias, result.of_lower, result.of_upper)
        true = (0.3, 0.3 - REACH * 1.2, 0.3 + REACH * 1.2)
        covered += [low <= value <= high for value, (low, high) in zip(true, ends, strict=True)]
    assert (covered / STUDIES > 0.93).all()
    assert (covered / STUDIES < 0.97).all()


def test_equal_methods_agree_exactly() -> None:
    values = np.array([1.0, 2.0, 3.0])
    result = limits(values, values)
    assert (result.bias, result.sd, result.lower, result.slope) == (0, 0, 0, 0)
    assert result.of_upper == (0, 0)


@pytest.mark.parametrize("blocks", [0, 1, 2])
def test_few_blocks(blocks: int) -> None:
    values = np.arange(float(blocks))
    result = limits(values, 2 * values)
    assert np.isnan(result.bias) == (blocks == 0)
    assert np.isnan(result.sd) == (blocks < 2)
    assert np.isnan(result.of_bias[0]) == (blocks < 2)
    assert np.isnan(result.of_slope[0])


def test_a_constant_has_no_slope() -> None:
    assert np.isnan(limits(np.ones(5), np.zeros(5)).slope)


def test_ten_thousand_blocks_have_intervals() -> None:
    random = np.random.default_rng(0)
    result = limits(random.normal(size=10_000), np.zeros(10_000))
    assert result.of_upper[0] < result.upper < result.of_upper[1]
    assert result.of_upper[1] - result.of_upper[0] < 0.08


def test_over_clusters_the_bias_is_that_of_their_means_and_the_limits_those_of_a_block() -> None:
    random = np.random.default_rng(0)
    cluster = np.repeat(np.arange(6), 30)
    d = random.normal(size=6)[cluster] + 0.5 * random.normal(size=180)
    agreement = limits(d + 5.0, np.full(180, 5.0), cluster)
    means = d.reshape(6, 30).mean(axis=1)
    within = d.reshape(6, 30).var(axis=1, ddof=1).mean()
    assert agreement.bias == pytest.approx(means.mean())
    assert agreement.sd == pytest.approx(np.sqrt(means.var(ddof=1) - within / 30 + within))
    peer = ttest_1samp(means, 0.0).confidence_interval()
    assert agreement.of_bias == pytest.approx((peer.low, peer.high))

"""The distribution of the studentised range, against scipy's."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import studentized_range, t

from nodegraph_compare.studentised_range import quantile, survival

Q = np.array([0.0, 0.01, 1.0, 3.5, 5.0, 8.0, 30.0, np.inf])


@pytest.mark.parametrize("means", [2, 3, 17, 120])
@pytest.mark.parametrize("freedom", [4, 119, 900, np.inf])
def test_probabilities_are_those_of_scipy(means: int, freedom: float) -> None:
    expected = studentized_range.sf(Q, means, freedom)
    np.testing.assert_allclose(survival(Q, means, freedom), expected, rtol=0, atol=1e-11)


@pytest.mark.parametrize("freedom", [1, 7, 900])
def test_the_range_of_two_means_is_students(freedom: int) -> None:
    expected = np.sqrt(2) * t.ppf(0.975, freedom)
    assert quantile(0.05, 2, freedom) == pytest.approx(expected, rel=1e-12)


def test_a_quantile_is_exceeded_with_its_probability() -> None:
    q = np.full(150, quantile(0.05, 17, 40))
    np.testing.assert_allclose(survival(q, 17, 40), 0.05, rtol=1e-12)

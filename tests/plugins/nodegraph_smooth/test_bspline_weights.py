"""The weights are those of the B-splines, exactly."""

from __future__ import annotations

from fractions import Fraction
from math import lcm

import numpy as np
import pytest
from scipy.interpolate import BSpline

from nodegraph_smooth.bspline_weights import all_rows, basis, first_rows, middle, weights

TABLE = {
    3: [1, 4, 1],
    4: [1, 76, 230, 76, 1],
    5: [1, 26, 66, 26, 1],
    6: [1, 722, 10543, 23548, 10543, 722, 1],
    7: [1, 120, 1191, 2416, 1191, 120, 1],
}
DIVISORS = {3: 6, 4: 384, 5: 120, 6: 46080, 7: 5040}
NOISE = {3: 0.5000, 4: 0.4371, 5: 0.3965, 6: 0.3663, 7: 0.3426}
STEPS = {3: 0.5556, 4: 0.3980, 5: 0.3092, 6: 0.2506, 7: 0.2096}
HALF_POWER = {3: 13.839, 4: 12.248, 5: 11.181, 6: 10.358, 7: 9.695}
ORDERS = range(1, 10)


def floats(order: int) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return np.array([float(value) for value in weights(order)])


@pytest.mark.parametrize("order", TABLE)
def test_weights_are_the_whole_numbers_of_the_table(order: int) -> None:
    actual = weights(order)
    divisor = lcm(*(value.denominator for value in actual))
    assert divisor == DIVISORS[order]
    assert [int(value * divisor) for value in actual] == TABLE[order]


@pytest.mark.parametrize("order", TABLE)
def test_gain_of_noise_of_its_steps_and_of_a_frequency(order: int) -> None:
    smoothed = floats(order)
    assert round(float(np.sum(smoothed**2)), 4) == NOISE[order]
    assert round(float(np.sum(np.diff(smoothed, prepend=0, append=0) ** 2)), 4) == STEPS[order]
    reach = np.arange(len(smoothed)) - len(smoothed) // 2
    hertz = np.arange(0.0, 30.0, 0.001)
    gain = np.cos(2 * np.pi * np.outer(hertz / 60.0, reach)) @ smoothed
    assert hertz[np.argmax(gain < np.sqrt(0.5))] == pytest.approx(HALF_POWER[order], abs=0.0011)


@pytest.mark.parametrize("order", ORDERS)
def test_weights_sum_to_one_and_are_even(order: int) -> None:
    actual = weights(order)
    assert sum(actual) == 1
    assert actual == actual[::-1]
    np.testing.assert_array_equal(middle(order), floats(order)[order // 2 + 1 :])


@pytest.mark.parametrize("order", ORDERS)
def test_basis_is_the_uniform_b_spline(order: int) -> None:
    knots = np.arange(-order, order + 2.0)
    for t in (Fraction(0), Fraction(1, 3), Fraction(1, 2)):
        values = [float(basis(order, k, t)) for k in range(order + 1)]
        spline = BSpline.design_matrix([float(t)], knots, order).toarray()[0]
        np.testing.assert_allclose(values, spline, rtol=1e-12, atol=1e-15)


def quasi_uniform(length: int, degree: int) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    spans = length - degree
    return np.array([0.0] * degree + list(range(spans + 1)) + [spans] * degree, dtype=np.float64)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("length", [1, 2, 3, 4, 5, 9, 11, 24])
def test_clamped_is_the_quasi_uniform_spline_at_the_greville_abscissae(
    order: int, length: int
) -> None:
    degree = min(order, length - 1)
    if degree == 0:
        expected = np.ones((1, 1))
    else:
        knots = quasi_uniform(length, degree)
        places = [knots[at + 1 : at + degree + 1].mean() for at in range(length)]
        expected = BSpline(knots, np.eye(length), degree)(np.clip(places, 0, knots[-1]))
    np.testing.assert_allclose(all_rows(order, "clamped", length), expected, rtol=0, atol=1e-13)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("ends", ["vertex", "clamped", "free"])
def test_first_rows_are_those_of_any_long_run(order: int, ends: str) -> None:
    first = first_rows(order, ends)
    count, width = first.shape
    assert width <= 2 * count
    for length in (2 * count, 2 * count + 1, 2 * count + 9):
        if length:
            rows = all_rows(order, ends, length)
            np.testing.assert_array_equal(rows[:count, :width], first)
            np.testing.assert_array_equal(rows[:count, width:], 0)
            np.testing.assert_allclose(rows[::-1, ::-1], rows, rtol=0, atol=1e-16)
            inner = rows[count : length - count]
            middle_one = np.zeros(length)
            for offset, row in enumerate(inner, count):
                middle_one[:] = 0
                middle_one[offset - order // 2 : offset + order // 2 + 1] = floats(order)
                np.testing.assert_allclose(row, middle_one, rtol=0, atol=1e-16)

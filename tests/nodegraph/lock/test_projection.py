"""A few numbers tell how far two arrays are apart, the same ones everywhere."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph.lock.sketch import COUNT, LARGE, along_one, as_text, distance, from_text, project

LONG = 70_000  # more than one block of weights
VALUES = np.random.default_rng(0).normal(size=LONG)


def test_the_weights_are_the_same_with_every_version_of_numpy() -> None:
    found = project("a", np.arange(5.0))
    expected = [-1.6126162774348376, -3.7942897331732093, 0.8727923041300673, 1.2437798568362393]
    assert np.allclose(found, expected, rtol=1e-14)


def test_the_weights_have_mean_0_and_variance_1_and_do_not_depend_on_each_other() -> None:
    weights = np.array([along_one(name, np.ones(LONG)) for name in ("a", "b")])
    assert np.allclose(weights.mean(axis=1), 0.0, atol=0.02)
    assert np.allclose(np.cov(weights), np.eye(2), atol=0.02)


def test_blocks_have_weights_of_their_own() -> None:
    weights = along_one("a", np.ones(LONG))
    assert not np.array_equal(weights[: LONG - 65_536], weights[65_536:])


def test_projections_are_linear() -> None:
    other = VALUES[::-1]
    both = project("a", 2.0 * VALUES + other)
    assert np.allclose(both, 2.0 * project("a", VALUES) + project("a", other), atol=1e-12)


def test_their_distance_is_about_the_root_mean_square_difference() -> None:
    ratios = []
    for seed in range(200):
        off = np.random.default_rng(seed).normal(size=VALUES[:500].size)
        here = project(f"name {seed}", VALUES[:500])
        there = project(f"name {seed}", VALUES[:500] + 1e-6 * off)
        ratios.append(distance(here, there) / (1e-6 * np.sqrt(np.mean(off**2))))
    assert np.sqrt(np.mean(np.square(ratios))) == pytest.approx(1.0, abs=0.1)
    assert min(ratios) > 0.1


def test_two_values_that_change_places_show() -> None:
    swapped = VALUES.copy()
    swapped[[3, 4]] = swapped[[4, 3]]
    assert distance(project("a", VALUES), project("a", swapped)) > 1e-5


def test_nothing_projects_to_zeros() -> None:
    assert np.array_equal(project("a", np.zeros(0)), np.zeros(COUNT))


@given(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=4, max_size=4))
def test_a_word_holds_eleven_digits(numbers: list[float]) -> None:
    found = from_text(as_text(np.array(numbers)))
    assert np.allclose(found, numbers, rtol=2e-11, atol=1e-300)


@pytest.mark.filterwarnings("error")
def test_no_square_and_no_sum_overflows() -> None:
    here, there = project("a", np.full(LONG, 0.9 * LARGE)), project("a", np.full(LONG, 0.8 * LARGE))
    assert np.isfinite([here, there]).all()
    assert distance(here, there) / LARGE == pytest.approx(
        distance(here / LARGE, there / LARGE), rel=1e-12
    )
    assert distance(here, here) == 0.0


def test_what_is_no_number_is_no_projection() -> None:
    with pytest.raises(ValueError, match="no finite number"):
        from_text(as_text(np.array([1.0, np.inf, 0.0, 0.0])))


@pytest.mark.parametrize("text", ["", "abc", "?" * 32, "A" * 28])
def test_a_word_that_is_none_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"\w"):
        from_text(text)

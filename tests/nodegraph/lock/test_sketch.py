"""Sketches of values, and the distances between them."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph import Value
from nodegraph.lock.sketch import (
    COUNT,
    LARGE,
    Sketch,
    distance,
    project,
    sketch,
)
from nodegraph.store import Packer


@dataclass(frozen=True)
class Sheet(Value):
    cells: np.ndarray[Any, np.dtype[np.float64]]
    names: tuple[str, ...] = ("a", "b")
    count: int = 3
    rate: float = 60.0


CELLS = np.arange(1.0, 13.0).reshape(6, 2)
CELLS[2, 1] = np.nan
SHEET = Sheet(CELLS)
LONG = 70_000  # more than one block of weights
VALUES = np.random.default_rng(0).normal(size=LONG)


def sketch_of(value: object) -> Sketch:
    return sketch({"output": Packer().pack(value)})


def apart(value: object, other: object) -> float:
    first, second = sketch_of(value), sketch_of(other)
    scales = {place: leaf.size for place, leaf in first.leaves.items()}
    return first.against(scales).apart(second.against(scales).projections)


def other_cells(place: tuple[int, int], value: float) -> Sheet:
    cells = CELLS.copy()
    cells[place] = value
    return replace(SHEET, cells=cells)


@pytest.mark.parametrize(
    "other",
    [
        replace(SHEET, names=("a", "c")),
        replace(SHEET, count=4),
        other_cells((0, 0), np.nan),
        other_cells((2, 1), np.inf),
        other_cells((2, 1), 1.0),
        replace(SHEET, cells=CELLS[:5]),
        replace(SHEET, cells=CELLS.reshape(2, 6)),
        replace(SHEET, cells=CELLS.astype(np.float32)),
    ],
)
def test_everything_but_finite_floats_must_be_equal(other: Sheet) -> None:
    assert sketch_of(other).exact != sketch_of(SHEET).exact


@pytest.mark.parametrize(
    "other",
    [
        replace(SHEET, cells=np.asfortranarray(CELLS)),
        other_cells((0, 0), 1.5),
        replace(SHEET, rate=61.0),
    ],
)
def test_finite_floats_and_the_layout_in_memory_may_differ(other: Sheet) -> None:
    assert sketch_of(other).exact == sketch_of(SHEET).exact


def test_the_order_of_a_mapping_does_not_count() -> None:
    value, other = {"x": 1.0, "y": [2.0, "z"]}, {"y": [2.0, "z"], "x": 1.0}
    assert sketch_of(value).exact == sketch_of(other).exact
    assert apart(value, other) == 0.0
    assert sketch_of({"x": 2.0, "y": [1.0, "z"]}).exact == sketch_of(value).exact
    assert apart(value, {"x": 2.0, "y": [1.0, "z"]}) > 0.1


@pytest.mark.parametrize("size", [1e-12, 1e-6, 0.1])
def test_the_distance_is_relative_to_the_size(size: float) -> None:
    off = np.where(np.isnan(CELLS), np.nan, CELLS * (1.0 + size))
    for factor in (1.0, 1e-200, 1e200):
        value, other = (Sheet(cells * factor) for cells in (CELLS, off))
        assert 0.1 * size < apart(value, other) < 3.0 * size


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("largest", [1.0, 1e155, 5.2e269, 5.3e269, 1.797e308])
@pytest.mark.parametrize("usual", [1.0, 0.0])
def test_the_largest_numbers_are_measured_like_small_ones(largest: float, usual: float) -> None:
    numbers = np.linspace(0.5, 1.0, 2000) * largest
    scales = {"output": usual or largest}
    was = sketch_of(numbers).against(scales)
    for size in (1e-15, 1e-6, 0.5):
        now = sketch_of(numbers * (1.0 - size)).against(scales)
        assert 0.1 * size < was.apart(now.projections) < 10.0 * size


def test_a_place_is_measured_by_its_own_size() -> None:
    assert 0.01 < apart({"large": 1e9, "small": 1e-3}, {"large": 1e9, "small": 1.1e-3}) < 0.5


def test_single_precision_may_drift_by_its_own_rounding() -> None:
    cells = np.linspace(1.0, 2.0, 50, dtype=np.float32)
    assert apart(cells, np.nextafter(cells, np.float32(np.inf))) < 1e-9
    assert apart(cells, cells * np.float32(1.001)) > 1e-9


def test_complex_numbers_are_two() -> None:
    assert sketch_of(np.array([1 + 2j])).leaves["output"].size == pytest.approx(np.sqrt(2.5))


def test_long_lists_are_measured_together() -> None:
    numbers = [float(number) for number in range(100)]
    assert list(sketch_of(numbers).leaves) == ["output[]"]
    assert apart(numbers, [*numbers[:50], 50.5, *numbers[51:]]) > 1e-4
    assert sketch_of([*numbers[:99], "x"]).exact != sketch_of(numbers).exact


def test_bytes_and_texts_count() -> None:
    assert sketch_of(b"one").exact != sketch_of(b"two").exact
    assert sketch_of("one").exact != sketch_of("two").exact


def test_the_weights_are_the_same_with_every_version_of_numpy() -> None:
    projections = project("a", np.arange(5.0))
    expected = [-1.6126162774348376, -3.7942897331732093, 0.8727923041300673, 1.2437798568362393]
    assert np.allclose(projections, expected, rtol=1e-14)


def test_blocks_have_weights_of_their_own() -> None:
    first, second = np.zeros(LONG), np.zeros(LONG)
    first[0], second[65_536] = 1.0, 1.0
    assert not np.array_equal(project("a", first), project("a", second))


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


def test_an_exchange_of_two_values_has_a_distance() -> None:
    swapped = VALUES.copy()
    swapped[[3, 4]] = swapped[[4, 3]]
    assert distance(project("a", VALUES), project("a", swapped)) > 1e-5


def test_an_empty_array_projects_to_zeros() -> None:
    assert np.array_equal(project("a", np.zeros(0)), np.zeros(COUNT))


@given(st.lists(st.floats(-1e300, 1e300), min_size=4, max_size=40))
def test_a_word_holds_enough_to_compare_with(numbers: list[float]) -> None:
    summary = sketch_of(np.array(numbers))
    scales = {place: leaf.size for place, leaf in summary.leaves.items()}
    text = summary.text(scales)
    same, distance = summary.compared(text, scales)
    assert re.fullmatch("[0-9a-f]{8}-[A-Za-z0-9+/]{32}", text)
    assert same
    assert distance < 1e-10
    assert not sketch_of(numbers[:3]).compared(text, scales)[0]


@pytest.mark.filterwarnings("error")
def test_no_square_and_no_sum_overflows() -> None:
    here, there = project("a", np.full(LONG, 0.9 * LARGE)), project("a", np.full(LONG, 0.8 * LARGE))
    assert np.isfinite([here, there]).all()
    assert distance(here, there) / LARGE == pytest.approx(
        distance(here / LARGE, there / LARGE), rel=1e-12
    )
    assert distance(here, here) == 0.0

"""A sketch tells what must be equal from what may drift, and how far it has."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from nodegraph import Value
from nodegraph.lock.sketch import Sketch, sketch
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


def taken(value: object) -> Sketch:
    return sketch({"output": Packer().pack(value)})


def apart(one: object, other: object) -> float:
    first, second = taken(one), taken(other)
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
def test_what_must_be_equal_is_exact(other: Sheet) -> None:
    assert taken(other).exact != taken(SHEET).exact


@pytest.mark.parametrize(
    "other",
    [
        replace(SHEET, cells=np.asfortranarray(CELLS)),
        other_cells((0, 0), 1.5),
        replace(SHEET, rate=61.0),
    ],
)
def test_floats_and_their_order_in_memory_are_not(other: Sheet) -> None:
    assert taken(other).exact == taken(SHEET).exact


def test_the_order_of_a_mapping_does_not_count() -> None:
    one, other = {"x": 1.0, "y": [2.0, "z"]}, {"y": [2.0, "z"], "x": 1.0}
    assert taken(one).exact == taken(other).exact
    assert apart(one, other) == 0.0
    assert taken({"x": 2.0, "y": [1.0, "z"]}).exact == taken(one).exact
    assert apart(one, {"x": 2.0, "y": [1.0, "z"]}) > 0.1


@pytest.mark.parametrize("size", [1e-12, 1e-6, 0.1])
def test_the_distance_is_relative_to_the_size(size: float) -> None:
    off = np.where(np.isnan(CELLS), np.nan, CELLS * (1.0 + size))
    for factor in (1.0, 1e-200, 1e200):
        one, other = (Sheet(cells * factor) for cells in (CELLS, off))
        assert 0.1 * size < apart(one, other) < 3.0 * size


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("largest", [1.0, 1e155, 5.2e269, 5.3e269, 1.797e308])
@pytest.mark.parametrize("usual", [1.0, 0.0])
def test_the_largest_numbers_are_measured_as_others_are(largest: float, usual: float) -> None:
    numbers = np.linspace(0.5, 1.0, 2000) * largest
    scales = {"output": usual or largest}
    was = taken(numbers).against(scales)
    for size in (1e-15, 1e-6, 0.5):
        now = taken(numbers * (1.0 - size)).against(scales)
        assert 0.1 * size < was.apart(now.projections) < 10.0 * size


def test_a_place_is_measured_by_its_own_size() -> None:
    assert 0.01 < apart({"large": 1e9, "small": 1e-3}, {"large": 1e9, "small": 1.1e-3}) < 0.5


def test_single_precision_may_drift_by_its_own_rounding() -> None:
    cells = np.linspace(1.0, 2.0, 50, dtype=np.float32)
    assert apart(cells, np.nextafter(cells, np.float32(np.inf))) < 1e-9
    assert apart(cells, cells * np.float32(1.001)) > 1e-9


def test_complex_numbers_are_two() -> None:
    assert taken(np.array([1 + 2j])).leaves["output"].size == pytest.approx(np.sqrt(2.5))


def test_long_lists_are_measured_together() -> None:
    numbers = [float(one) for one in range(100)]
    assert list(taken(numbers).leaves) == ["output[]"]
    assert apart(numbers, [*numbers[:50], 50.5, *numbers[51:]]) > 1e-4
    assert taken([*numbers[:99], "x"]).exact != taken(numbers).exact


def test_bytes_and_texts_count() -> None:
    assert taken(b"one").exact != taken(b"two").exact
    assert taken("one").exact != taken("two").exact

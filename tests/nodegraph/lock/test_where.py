"""The parts that differ are named by what a plugin says the axes are."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from nodegraph.execute import Run
from nodegraph.lock.compare import where
from nodegraph.lock.lockfile import Lock
from nodegraph.lock.results import Axes, Results, cells_of
from nodegraph.lock.sketch import Parts, parts_of

Frozen = tuple[Run, Lock]
Array = np.ndarray[tuple[int, ...], np.dtype[np.float64]]
AXES = (("row", ()), ("column", ("left", "middle", "right")))
VALUES = np.random.default_rng(0).normal(size=(20, 3))


class Known(Results):
    """Results of which one array is known to have rows and columns."""

    def __init__(self, run: Run, values: Array) -> None:
        super().__init__(run)
        self._values = values

    def parts(self, index: int, most: int) -> dict[str, tuple[Parts, Axes]]:
        found = parts_of("a", self._values, 2, most)
        return {} if found is None else {"a": (found, AXES)}


def told(frozen: Frozen, was: Array, now: Array, most: int = 64) -> list[str]:
    """Return how one array is said to differ from another, of which only a lock is left."""
    run, lock = frozen
    cell = next(one for one in cells_of(run) if one.group == "cut")
    parts = parts_of("a", was, 2, most)
    kept = {cell.group: {"a": {cell.at: parts}}} if parts is not None else {}
    return list(where(replace(lock, parts=kept), cell, Known(run, now)))


def changed(rows: slice, column: int, by: float = 1.0) -> Array:
    other = VALUES.copy()
    other[rows, column] += by
    return other


@pytest.mark.parametrize(
    ("rows", "column", "said"),
    [
        (slice(4, 5), 0, "row 4, of column left"),
        (slice(4, 7), 2, "rows 4 to 6, of column right"),
        (slice(2, 19, 4), 1, "rows 2, 6, 10, 14, 18, of column middle"),
        (slice(0, 18, 3), 1, "6 rows between 0 and 15, of column middle"),
        (slice(None), 1, "all 20 rows, of column middle"),
    ],
)
def test_what_differs_is_named(frozen: Frozen, rows: slice, column: int, said: str) -> None:
    [found] = told(frozen, VALUES, changed(rows, column))
    assert re.sub(r" \(most in .*\)", "", found) == f"a: differs in {said}"


def test_what_differs_most_is_told_apart(frozen: Frozen) -> None:
    other = changed(slice(3, 6), 0, 0.001)
    other[9, 0] += 1.0
    assert told(frozen, VALUES, other) == [
        "a: differs in rows 3 to 5, 9 (most in row 9), of column left"
    ]


def test_what_does_not_differ_is_not_told(frozen: Frozen) -> None:
    assert told(frozen, VALUES, VALUES * (1.0 + 1e-13)) == []
    assert told(frozen, VALUES, VALUES * 1e40) == []  # too large to be told by parts


def test_another_shape_is_told_as_such(frozen: Frozen) -> None:
    assert told(frozen, VALUES, VALUES[:7]) == ["a: had the shape 20 x 3, now 7 x 3"]
    assert told(frozen, VALUES[:0], VALUES) == ["a: had the shape 0 x 3, now 20 x 3"]


def test_a_lock_that_knows_no_parts_tells_nothing(frozen: Frozen) -> None:
    assert told(frozen, VALUES * 1e40, VALUES) == []

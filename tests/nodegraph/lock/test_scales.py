"""Differences are measured by how large the numbers of a node usually are."""

from __future__ import annotations

import sys
from collections.abc import Callable

import numpy as np
import pytest

from nodegraph import node
from nodegraph.execute import Run
from nodegraph.lock.results import Results, cells_of, scales

RunOf = Callable[..., Run]
PAIR = "nodes: {{a: {{use: read.number, with: {{start: {0}}}}}, b: {{use: strict.less, in: a}}}}"


@node("strict.less")
def less(x: float) -> float:
    return x - 0.999999 * x


@node("strict.numbers")
def numbers(*, size: float = 1.0) -> np.ndarray:
    return np.full(2000, size)


def usual(run: Run) -> dict[str, dict[str, float]]:
    return scales(list(cells_of(run)), Results(run), run)


def test_what_is_smaller_than_the_rounding_of_what_feeds_it_is_measured_by_that(
    run_of: RunOf,
) -> None:
    assert usual(run_of(PAIR.format(100.0), more=[less])) == {
        "a": {"output": 100.0},
        "b": {"output": 0.1},
    }


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("size", [1.5e308, sys.float_info.max])
def test_the_usual_size_of_the_largest_numbers_is_a_number(run_of: RunOf, size: float) -> None:
    text = f"""
    axes: {{size: [{size!r}, {-0.9 * size!r}]}}
    nodes: {{a: {{use: strict.numbers, with: {{size: $size}}}}}}
    """
    found = usual(run_of(text, more=[numbers]))["a"]["output"]
    assert found == pytest.approx(0.95 * size, rel=1e-3)

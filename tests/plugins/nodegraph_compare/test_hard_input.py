"""Input on which little can be said: each has a sentence that says what."""

from __future__ import annotations

import re

import numpy as np
import pytest
from numpy.typing import NDArray
from pandas import DataFrame

from nodegraph import Across
from nodegraph_compare.table.node import table
from nodegraph_compare.verdict import Verdict
from nodegraph_tables import info_of

RANDOM = np.random.default_rng(3)
NEAR = RANDOM.lognormal(sigma=0.1, size=9)


def say(values: dict[str, NDArray[np.float64]]) -> tuple[str, Verdict]:
    """Compare methods by the errors of units; return the sentence and the verdict."""
    tables = {
        name: DataFrame({"actor": np.arange(len(each)), "error": each})
        for name, each in values.items()
    }
    compared = table(
        Across.of(tables, axis="method"), metric="error", blocks=("actor",), clusters=("actor",)
    )
    answer = info_of(compared.table).answer
    return " ".join(answer.lines[:2]), compared.overview.verdicts.groups[0]


@pytest.mark.parametrize(
    ("units", "expected"),
    [
        (2, "The data cannot tell which is best: one repetition where 3 are needed"),
        (3, "The data cannot tell which is best: 3 actors describe the methods and decide nothing"),
        (4, "The data cannot tell which is best: 4 actors describe the methods and decide nothing"),
        (
            5,
            "5 actors: holds for further actors. Provisional, as of 5 actors",
        ),
    ],
)
def test_few_units(units: int, expected: str) -> None:
    sentence, verdict = say({"a": NEAR[:units], "b": 2 * NEAR[:units]})
    assert expected in sentence
    assert np.isfinite(verdict.low).all() == (units > 2)
    assert bool(verdict.marks) == (units > 4)


def test_one_unit() -> None:
    tables = {
        name: DataFrame({"gap": [0], "error": [error]}) for name, error in (("a", 1), ("b", 2))
    }
    compared = table(Across.of(tables, axis="method", sources=()), metric="error")
    sentence, scope, _ = info_of(compared.table).answer.lines
    assert sentence.startswith("Lowest mean error: a (1.00), then b (2.00). The data cannot tell")
    assert scope.startswith("One recording: nothing is said for further gaps in it.")


def test_equal_methods_and_ties_to_the_last_bit_share_what_is_best() -> None:
    other = NEAR * (1 + 2e-16 * RANDOM.integers(-1, 2, 9))
    sentence, verdict = say({"a": NEAR, "b": other, "c": NEAR})
    assert sentence.startswith("a, b and c have the same mean error")
    assert not verdict.behind
    assert verdict.to_best is not None
    assert verdict.to_best.p[1:].tolist() == [1.0, 1.0]


def test_zeros_are_compared_by_differences_of_arithmetic_means() -> None:
    zero = np.where(np.arange(9) < 3, 0.0, NEAR)
    sentence, verdict = say({"a": zero, "b": NEAR + 3.0})
    assert verdict.mean == pytest.approx([zero.mean(), NEAR.mean() + 3.0])
    assert "; the other is clearly behind, by 3.34." in sentence
    nothing, all_zero = say({"a": 0 * NEAR, "b": 0 * NEAR})
    assert nothing.startswith("a and b have the same mean error (0")
    assert all_zero.mean.tolist() == [0.0, 0.0]


def test_one_unit_with_all_the_variance_decides_nothing() -> None:
    wild = NEAR.copy()
    wild[4] *= 1e6
    sentence, verdict = say({"a": NEAR, "wild": wild})
    assert "The data cannot tell which is best: no difference is clear." in sentence
    assert not verdict.marks
    assert verdict.mean[1] / verdict.mean[0] == pytest.approx(1e6 ** (1 / 9))


def test_forty_methods_have_a_verdict() -> None:
    values = {f"m{at}": NEAR * RANDOM.uniform(0.97, 1.03, 9) for at in range(30)}
    values |= {f"far{at}": NEAR * RANDOM.uniform(5, 50, 9) for at in range(10)}
    sentence, verdict = say(values)
    assert {f"far{at - 30}" for at in verdict.behind if at >= 30} == {
        f"far{at}" for at in range(10)
    }
    assert re.search(r"; \d+ more; the other \d+ clearly behind", sentence)


def test_a_method_that_lacks_half_its_blocks_narrows_the_others() -> None:
    half = np.where(np.arange(9) % 2, np.nan, NEAR)
    with pytest.warns(UserWarning, match="4 of 9 blocks left out"):
        sentence, verdict = say({"a": NEAR, "b": 2 * NEAR, "half": 3 * half})
    assert "5 actors: holds for further actors. Provisional" in sentence
    assert "Provisional, as of 5 actors" in sentence
    assert verdict.lacking.tolist() == [0, 0, 4]

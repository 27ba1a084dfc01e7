"""Frequencies and the three ways to call a selection stable, as fractions."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from nodegraph_select.pfa import Stability, stabilities

SELECTIONS = st.integers(1, 6).flatmap(
    lambda pairs: st.lists(
        st.frozensets(st.integers(0, pairs - 1), min_size=1), min_size=1, max_size=25
    ).map(lambda chosen: (pairs, chosen))
)


def matrix(pairs: int, chosen: list[frozenset[int]]) -> NDArray[np.bool_]:
    matrix_ = np.zeros((len(chosen), pairs), dtype=np.bool_)
    for run, some in enumerate(chosen):
        matrix_[run, list(some)] = True
    return matrix_


@given(SELECTIONS)
def test_every_number_and_the_best_as_they_are_defined(
    case: tuple[int, list[frozenset[int]]],
) -> None:
    pairs, chosen = case
    runs = len(chosen)
    frequency = [Fraction(sum(pair in value for value in chosen), runs) for pair in range(pairs)]
    sums = [sum(frequency[pair] for pair in value) for value in chosen]
    expected: dict[Stability, list[Any]] = {
        "sum": sums,
        "mean": [total / len(value) for total, value in zip(sums, chosen, strict=True)],
        "medoid": [
            sum(Fraction(len(value & other), len(value | other)) for other in chosen) / runs
            for value in chosen
        ],
    }
    size = [1 + pair % 2 for pair in range(pairs)]
    markers = [sum(size[pair] for pair in value) for value in chosen]
    output = stabilities(matrix(pairs, chosen))
    assert output.frequencies == pytest.approx([float(value) for value in frequency])
    for stability, scores in expected.items():
        assert getattr(output, stability) == pytest.approx([float(name) for name in scores])
        best = min(range(runs), key=lambda run: (-scores[run], markers[run], run))
        assert output.best(stability, np.array(markers)) == best
    first = list(dict.fromkeys(chosen))
    assert output.same.tolist() == [first.index(value) for value in chosen]
    assert output.distinct == len(first)


def test_more_selections_and_pairs_than_are_compared_at_once() -> None:
    chosen = np.random.default_rng(2).random((700, 37)) < 0.4
    chosen[:, 0] = True
    stability = stabilities(chosen)
    shared = (chosen[:, None] & chosen).sum(axis=2)
    either = (chosen[:, None] | chosen).sum(axis=2)
    assert stability.medoid == pytest.approx((shared / either).mean(axis=1), abs=1e-12)
    assert stability.distinct == len(np.unique(chosen, axis=0))

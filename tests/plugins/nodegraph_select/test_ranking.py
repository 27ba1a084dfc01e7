"""The first pairs of an order that together have enough markers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph import Refusal
from nodegraph_mocap import Selection, Trajectories
from nodegraph_select.ranking import (
    Count,
    Wanted,
    by_variance,
    first_pairs,
    pairs_chosen,
    warn_spanned,
)

PAIRS = (("a", "b"), ("c",), ("d", "e"), ("f",))
SIX = Trajectories(positions=np.zeros((1, 6, 3)), markers=tuple("fedcba"), rate=60.0)


@given(st.permutations([0, 1, 2, 3]), st.lists(st.integers(0, 3), max_size=4), st.integers(1, 6))
def test_as_many_as_it_takes(order: list[int], again: list[int], k: int) -> None:
    places = [*order[:2], *again, *order]
    values = np.arange(len(places), dtype=np.float64)
    selection = first_pairs(SIX, PAIRS, np.array(places), Count(k, exact=False), values, "place")
    chosen: list[str] = []
    steps = []
    for place, number in enumerate(places):
        if len(chosen) < k and PAIRS[number][0] not in chosen:
            chosen += PAIRS[number]
            steps.append([len(chosen), place])
    assert set(selection.chosen) == set(chosen)
    assert list(selection.chosen) == sorted(chosen, reverse=True)
    assert selection.history is not None
    assert selection.history.tolist() == steps


def test_without_values_there_is_no_history() -> None:
    selection = first_pairs(SIX, PAIRS, np.arange(4), Count(3, exact=False))
    assert (selection.columns, selection.history) == ((), None)


def test_variances_from_the_largest_down() -> None:
    assert by_variance(np.array([1.0, 3.0, 3.0, 0.0])).tolist() == [1, 2, 0, 3]


def test_no_more_than_there_are() -> None:
    assert Wanted(SIX, k=6).count() == Count(6, exact=False)
    with pytest.raises(Refusal, match="k = 7 markers cannot be chosen of 6"):
        Wanted(SIX, k=7).count()


@pytest.mark.parametrize("k", [0, -1, 2.0, "3"])
def test_no_number_of_markers(k: Any) -> None:
    with pytest.raises(ValueError, match=f"k must be a whole number from 1 on, got {k!r}"):
        Wanted(SIX, k=k).count()


@given(st.permutations([0, 1, 2, 3]), st.integers(1, 6))
def test_as_many_as_another_selection_has(order: list[int], k: int) -> None:
    """Exactly as many wherever a lone marker is left for the last place."""
    like = Selection(chosen=SIX.markers[:k])
    count = Wanted(SIX, like).count()
    chosen = first_pairs(SIX, PAIRS, np.array(order), count).chosen
    lone = {"c", "f"} - set(chosen)
    assert len(chosen) == k or (len(chosen) == k - 1 and not lone)


def test_a_number_or_another_selection_but_not_both() -> None:
    for k, like, what in ((None, None, "neither"), (3, Selection(chosen=("a",)), "both")):
        with pytest.raises(ValueError, match=f"k or a selection `like`, got {what}"):
            Wanted(SIX, like, k=k).count()


def test_how_many_pairs_are_chosen() -> None:
    for pairs, k in ((1, 1), (2, 3), (3, 4), (4, 6)):
        selection = first_pairs(SIX, PAIRS, np.arange(4), Count(k, exact=False))
        assert pairs_chosen(selection) == pairs


def test_it_tells_what_is_determined_only_if_more_was_chosen() -> None:
    warn_spanned(3, first_pairs(SIX, PAIRS, np.arange(4), Count(5, exact=False)))
    with pytest.warns(UserWarning, match="^2 of the 3 pairs chosen determine"):
        warn_spanned(2, first_pairs(SIX, PAIRS, np.arange(4), Count(5, exact=False)))

"""Random pairs are whole, as many as asked for, and every order is equally likely."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.stats import chisquare

from nodegraph import Refusal
from nodegraph_mocap import Trajectories
from nodegraph_select.random import random
from tests.plugins.recordings import quietly


def test_at_least_k_markers_and_at_most_one_more(face: Trajectories) -> None:
    for seed in range(30):
        for k in range(1, 12):
            selection = random(face, k=k, seed=seed)
            assert k <= len(selection.chosen) <= min(k + 1, 11)
            for pair in selection.pairs:
                assert len(set(pair) & set(selection.chosen)) in (0, len(pair))


def test_a_larger_k_adds_to_the_same(face: Trajectories) -> None:
    chosen = [set(random(face, k=k, seed=5).chosen) for k in range(1, 12)]
    assert all(first <= second for first, second in pairwise(chosen))


def test_every_pair_comes_first_equally_often(face: Trajectories) -> None:
    first = Counter(random(face, k=1, seed=seed).chosen for seed in range(2100))
    assert len(first) == 7
    assert chisquare(list(first.values())).pvalue > 0.001


def test_samples_may_be_missing(face: Trajectories) -> None:
    nowhere = replace(face, positions=np.full_like(face.positions, np.nan), origin=None)  # type: ignore[arg-type]
    assert random(nowhere, k=5, seed=2).chosen == random(face, k=5, seed=2).chosen


def test_more_markers_than_there_are(face: Trajectories) -> None:
    with pytest.raises(Refusal, match="k = 12 markers cannot be chosen of 11"):
        random(face, k=12)


def test_choices_are_checked_in_plain_calls(face: Trajectories) -> None:
    with pytest.raises(ValueError, match="k must be a whole number from 1 on, got 0"):
        random(face, k=0)


def test_without_a_marker_set_all_are_alone(face: Trajectories) -> None:
    bare = replace(face, marker_set=None)
    assert {len(quietly(random, bare, k=k).chosen) - k for k in range(1, 12)} == {0}
    with pytest.warns(UserWarning, match="11 of 11 markers are chosen or left each by itself"):
        random(bare, k=3)

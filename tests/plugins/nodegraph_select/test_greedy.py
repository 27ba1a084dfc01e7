"""Greedy selection beside least squares that are solved anew for every candidate."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from nodegraph_mocap import Trajectories
from nodegraph_select.greedy import greedy
from nodegraph_select.random import random
from nodegraph_select.variance import variance
from tests.plugins.nodegraph_select.faces import make_face


def unexplained(face: Trajectories, chosen: set[str]) -> float:
    """Return the share that a linear regression from some markers does not predict."""
    centred = face.positions - face.positions.mean(axis=0)
    every = centred.reshape(len(centred), -1)
    some = centred[:, [name in chosen for name in face.markers]].reshape(len(centred), -1)
    left = every - some @ np.linalg.lstsq(some, every, rcond=1e-8)[0]
    return float((left**2).sum() / (every**2).sum())


@pytest.mark.parametrize("seed", range(3))
def test_each_step_is_the_best_one(seed: int) -> None:
    face = make_face(seed, frames=150, noise=0.4)
    assert face.marker_set is not None
    chosen: set[str] = set()
    steps = []
    while len(chosen) < 11:
        candidates = sorted(set(face.markers) - chosen)
        best = min(candidates, key=lambda name: unexplained(face, chosen | {name}))
        chosen |= set(next((value for value in face.marker_set.pairs if best in value), (best,)))
        steps.append((len(chosen), unexplained(face, chosen)))
        selection = greedy(face, k=len(chosen))
        assert set(selection.chosen) == chosen
        assert selection.columns == ("markers", "unexplained")
        assert selection.history == pytest.approx(np.array(steps), rel=1e-6, abs=1e-9)


def test_it_leaves_less_than_the_largest_variance_and_than_chance() -> None:
    face = make_face(3, frames=200, movements=9)
    ours = unexplained(face, set(greedy(face, k=4).chosen))
    assert ours < unexplained(face, set(variance(face, k=4).chosen))
    assert ours < min(unexplained(face, set(random(face, k=4, seed=i).chosen)) for i in range(5))


def test_what_is_determined_by_others_comes_last_by_variance() -> None:
    face = make_face(2, movements=3, noise=0.0)
    with pytest.warns(UserWarning, match=r"\d of the 7 pairs chosen determine all markers"):
        selection = greedy(face, k=11)
    assert selection.chosen == face.markers
    assert selection.history is not None
    assert selection.history[-1, 1] == 0.0


def test_a_marker_that_stands_still_does_no_harm() -> None:
    face = make_face(1)
    positions = face.positions.copy()
    positions[:, face.markers.index("nose")] = 17.3
    still = replace(face, positions=positions)
    assert "nose" not in greedy(still, k=4).chosen

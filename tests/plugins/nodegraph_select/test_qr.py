"""Pivots are the features farthest from the span of those before, by plain projection."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from nodegraph import Refusal
from nodegraph_mocap import Trajectories
from nodegraph_select.qr import qr
from tests.plugins.nodegraph_select.faces import make_face, make_rigid
from tests.plugins.recordings import quietly


def plain(face: Trajectories, k: int) -> tuple[set[str], list[tuple[int, float]]]:
    """Take the longest column, take its direction out of all, and so on."""
    left = {
        (name, axis): column - column.mean()
        for place, name in enumerate(face.markers)
        for axis, column in enumerate(face.positions[:, place].T)
    }
    chosen: set[str] = set()
    steps = []
    while len(chosen) < k:
        (name, _), column = max(left.items(), key=lambda item: np.linalg.norm(item[1]))
        along = column / np.linalg.norm(column)
        left = {first: second - (second @ along) * along for first, second in left.items()}
        assert face.marker_set is not None
        pair = next((pair for pair in face.marker_set.pairs if name in pair), (name,))
        if not chosen.issuperset(pair):
            chosen |= set(pair)
            steps.append((len(chosen), float(np.linalg.norm(column) / np.sqrt(len(column)))))
    return chosen, steps


@pytest.mark.parametrize("seed", range(4))
def test_every_size_by_plain_projection(seed: int) -> None:
    face = make_face(seed)
    for k in range(1, 12):
        selection = qr(face, k=k)
        chosen, steps = plain(face, k)
        assert set(selection.chosen) == chosen
        assert selection.columns == ("markers", "residual")
        assert selection.history == pytest.approx(np.array(steps), rel=1e-6)


def test_what_is_determined_by_others_comes_last_by_variance() -> None:
    face = make_face(2, movements=2, noise=0.0)
    with pytest.warns(UserWarning, match=r"\d of the 7 pairs chosen determine all markers"):
        selection = qr(face, k=11)
    assert selection.chosen == face.markers
    assert selection.history is not None
    assert selection.history[0, 1] > 0
    assert selection.history[-1, 1] == 0.0


def test_fewer_frames_than_features(face: Trajectories) -> None:
    short = replace(face, positions=face.positions[:3], origin=face.origin[:3])
    assert quietly(qr, short, k=11).chosen == face.markers


def test_bad_input(face: Trajectories) -> None:
    with pytest.raises(Refusal, match="k = 12 markers cannot be chosen of 11"):
        qr(face, k=12)
    with pytest.raises(ValueError, match="k must be a whole number from 1 on, got 0"):
        qr(face, k=0)
    with pytest.raises(Refusal, match="no marker moves in 90 frames"):
        qr(make_rigid(face), k=2)


def test_rounding_chooses_no_marker(face: Trajectories) -> None:
    """Of what does not move, none is ahead of the others but by its name."""
    positions = make_rigid(face).positions.copy()
    positions[:, face.markers.index("nose")] += 1e-4 * face.positions[:, 3]
    positions[:, face.markers.index("lip_left")] += 1e-4 * face.positions[:, 5]
    with pytest.warns(UserWarning, match="2 of the 3 pairs chosen determine all markers"):
        selection = qr(replace(face, positions=positions), k=5)
    assert selection.chosen == ("lip_left", "lip_right", "brow_left", "brow_right", "nose")

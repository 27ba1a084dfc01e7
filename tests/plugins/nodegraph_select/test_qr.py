"""Pivots are the features farthest from the span of those before, by plain projection."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from nodegraph_mocap import Trajectories
from nodegraph_select.qr import qr
from tests.plugins.nodegraph_select.faces import make_face
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

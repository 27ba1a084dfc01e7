"""A track that goes over to another marker is cut; a face that moves is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_markers.label import cut, nearest_samples
from nodegraph_markers.tracks import UNNAMED, Tracks

FRAMES = 40
ACROSS, UP = np.meshgrid(np.arange(5) * 20.0, np.arange(4) * 20.0)
SHAPE = np.stack([ACROSS.ravel(), UP.ravel(), 0.01 * (ACROSS * UP).ravel()], axis=1)
NAMED = np.arange(20)


def of(positions: NDArray[np.float64]) -> Tracks:
    return Tracks(positions, ~np.isnan(positions[..., 0]), SHAPE, 15.0)


@pytest.fixture
def still() -> NDArray[np.float64]:
    """Give the positions of a shape at rest."""
    return np.tile(SHAPE, (FRAMES, 1, 1))


def test_two_that_exchange_their_markers_are_cut_there(still: NDArray[np.float64]) -> None:
    still[25:, [6, 7]] = still[25:, [7, 6]]
    pieces, owner = cut(of(still), NAMED)
    assert sorted(owner.tolist()) == sorted([*NAMED, 6, 7])
    frames = [pieces.frames[piece] for piece in np.flatnonzero(owner == 6)]
    assert [number.tolist() for number in frames] == [[*range(25)], [*range(25, 40)]]


def test_a_marker_that_comes_near_another_which_is_there_stays(
    still: NDArray[np.float64],
) -> None:
    still[10:20, 6] = still[10:20, 7] + [0.0, 1.0, 1.0]
    assert len(cut(of(still), NAMED)[1]) == 20


def test_a_marker_that_comes_where_one_is_never_seen_stays(still: NDArray[np.float64]) -> None:
    still[10:20, 6] = SHAPE[7]
    still[:, 7] = np.nan
    assert len(cut(of(still), NAMED)[1]) == 20


def test_two_samples_are_no_switch_and_a_track_without_a_name_is_left(
    still: NDArray[np.float64],
) -> None:
    still[20:22, 6] = SHAPE[7]
    still[20:, 7] = np.nan
    assert len(cut(of(still), NAMED)[1]) == 20
    still[20:, 6] = SHAPE[7]
    assert len(cut(of(still), NAMED)[1]) == 21
    assert len(cut(of(still), np.where(NAMED == 6, UNNAMED, NAMED))[1]) == 20


def test_of_two_tracks_the_nearer_keeps_its_sample(still: NDArray[np.float64]) -> None:
    shadow = np.full((FRAMES, 1, 3), np.nan)
    shadow[10:30, 0] = SHAPE[6] + [0.0, 0.0, 2.0]
    both = np.concatenate([still, shadow], axis=1)
    both[15:20, 6] += [0.0, 0.0, 5.0]
    both[35:, 6] = np.nan
    tracks = of(both)
    stays = nearest_samples(tracks, np.append(NAMED, 6))
    assert np.array_equal(np.flatnonzero(stays[:, 20]), np.arange(15, 20))
    assert np.array_equal(stays[:, 6], tracks.present[:, 6] & ~stays[:, 20])
    assert np.array_equal(np.delete(stays, [6, 20], axis=1), np.ones((FRAMES, 19), dtype=bool))
    assert not nearest_samples(replace(tracks), np.append(NAMED, UNNAMED))[:, 20].any()

"""Names are found from any start, across expression, and where the take begins again."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nodegraph_markers.naming import assign, names
from nodegraph_markers.rigid import spacing
from nodegraph_markers.tracks import Tracks
from nodegraph_mocap import Trajectories
from tests.plugins.nodegraph_markers.takes import face

GATE = 10.0


def of(positions: NDArray[np.float64], reference: Trajectories) -> Tracks:
    shape = reference.positions[0]
    return Tracks(positions, ~np.isnan(positions[..., 0]), shape, spacing(shape))


def test_fragments_are_reached_from_frame_to_frame() -> None:
    synthetic = face(seed=6, seconds=6.0)
    whole = synthetic.captured.positions
    pieces = []
    for marker in range(60):
        for start in range(-(marker % 7) * 10, 360, 70):
            piece = np.full((360, 3), np.nan)
            piece[max(start, 0) : start + 70] = whole[max(start, 0) : start + 70, marker]
            if np.isfinite(piece).any():
                pieces.append((marker, piece))
    given_names = names(of(np.stack([value for _, value in pieces], axis=1), synthetic.neutral))
    assert np.mean(given_names == [marker for marker, _ in pieces]) > 0.99


def test_a_take_in_which_nothing_is_seen_for_a_while_is_begun_again() -> None:
    synthetic = face(seed=7, seconds=4.0)
    positions = np.full((240, 120, 3), np.nan)
    positions[:100, :60] = synthetic.captured.positions[:100]
    positions[130:, 60:] = synthetic.captured.positions[130:]
    given_names = names(of(positions, synthetic.neutral))
    assert np.array_equal(given_names, np.tile(np.arange(60), 2))


def spans(*ends: tuple[int, int]) -> NDArray[np.bool_]:
    frame = np.arange(100)[:, None]
    first, stop = np.transpose(ends)
    return np.asarray((frame >= first) & (frame < stop))


def test_the_sum_counts_and_not_the_nearest() -> None:
    distances = np.array([[1.0, 4.0], [2.0, 9.5]])
    assert assign(distances, spans((0, 100), (0, 100)), GATE).tolist() == [1, 0]


def test_long_tracks_count_more() -> None:
    distances = np.array([[5.0], [1.0]])
    assert assign(distances, spans((0, 100), (20, 30)), GATE).tolist() == [0, -1]


def test_a_track_may_share_less_than_half_of_its_frames() -> None:
    distances = np.array([[1.0], [1.0]])
    assert assign(distances, spans((0, 60), (50, 100)), GATE).tolist() == [0, 0]
    assert assign(distances, spans((0, 60), (30, 80)), GATE).tolist() == [0, -1]


def test_nothing_is_farther_than_the_gate() -> None:
    distances = np.array([[10.0, 11.0], [9.9, 50.0], [np.inf, np.inf]])
    present = spans((0, 100), (0, 100), (0, 100))
    assert assign(distances, present, GATE).tolist() == [-1, 0, -1]

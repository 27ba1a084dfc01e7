"""Whole tracks are assigned as a whole, and follow one another as one marker."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nodegraph_markers.assigning import assign

GATE = 10.0


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


def test_tracks_without_a_common_frame_are_one_marker_one_after_the_other() -> None:
    distances = np.array([[2.0, 30], [3.0, 9.0], [1.0, 30], [40.0, 40.0]])
    present = spans((0, 40), (45, 80), (80, 100), (0, 100))
    assert assign(distances, present, GATE).tolist() == [0, 0, 0, -1]


def test_a_track_may_share_less_than_half_of_its_frames() -> None:
    distances = np.array([[1.0], [1.0]])
    assert assign(distances, spans((0, 60), (50, 100)), GATE).tolist() == [0, 0]
    assert assign(distances, spans((0, 60), (30, 80)), GATE).tolist() == [0, -1]


def test_nothing_is_farther_than_the_gate() -> None:
    distances = np.array([[10.0, 11.0], [9.9, 50.0], [np.inf, np.inf]])
    present = spans((0, 100), (0, 100), (0, 100))
    assert assign(distances, present, GATE).tolist() == [-1, 0, -1]

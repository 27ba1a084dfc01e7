"""Tracks are born, wait, are linked again, end and are named as they should be."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from nodegraph import Refusal
from nodegraph_mocap import Detections, Trajectories
from nodegraph_track.follow import default_gate
from nodegraph_track.linking_kernel import spaces
from nodegraph_track.nearest import nearest


def detections(*frames: list[float]) -> Detections:
    """Return points on the x axis, given frame by frame."""
    points = [[x, 0.0, 0.0] for frame in frames for x in frame]
    offsets = np.cumsum([0, *map(len, frames)])
    return Detections(points=np.array(points).reshape(-1, 3), offsets=offsets, rate=30.0)


def along(points: Detections, *, patience: int = 1, shortest: int = 1) -> list[list[float]]:
    tracks = nearest(points, gate=1.0, patience=patience, shortest=shortest)
    assert tracks.markers == tuple(f"t{index:03d}" for index in range(len(tracks.markers)))
    assert tracks.rate == points.rate
    return [np.nan_to_num(track, nan=-1.0).tolist() for track in tracks.positions[..., 0].T]


def test_tracks_are_named_by_their_first_points_then_by_x() -> None:
    assert along(detections([9, 5], [5, 1, 9])) == [[5, 5], [9, 9], [-1, 1]]


def test_a_track_waits_for_as_many_frames_as_it_has_patience() -> None:
    points = detections([5], [], [], [5])
    assert along(points, patience=2) == [[5, -1, -1, 5]]
    assert along(points, patience=1) == [[5, -1, -1, -1], [-1, -1, -1, 5]]


def test_short_tracks_are_dropped_and_counted() -> None:
    points = detections([5], [5, 8], [5], [5, 1], [5, 1])
    with pytest.warns(UserWarning, match=r"2 of 3 tracks .* fewer than 3 points .* 3 of 8 points"):
        assert along(points, shortest=3) == [[5, 5, 5, 5, 5]]


def test_a_ghost_does_not_wait() -> None:
    points = detections([5, 8], [5], [5, 8], [5, 8], [5, 8])
    with pytest.warns(UserWarning, match="1 of 3 tracks"):
        assert along(points, patience=9, shortest=2)[1] == [-1, -1, 8, 8, 8]


def test_a_take_of_one_frame_is_not_all_ghosts() -> None:
    assert along(detections([5, 8]), shortest=3) == [[5], [8]]


def test_no_point_at_all_is_refused() -> None:
    with pytest.raises(Refusal, match="needs at least one point"):
        nearest(detections([], []))


def gate_of(*frames: list[float]) -> float:
    tracks = detections(*frames)
    return default_gate(tracks.points, tracks.offsets)


def test_the_gate_is_half_the_spacing() -> None:
    assert gate_of([0, 4, 8], [0, 4], [1]) == 2.0
    assert gate_of([0, 0, 6]) == 3.0
    assert gate_of([3], [3], [9]) == np.inf


@given(
    arrays(np.float64, (12, 3), elements=st.integers(-5, 5)),
    st.lists(st.integers(0, 12), min_size=2, max_size=2),
)
def test_spaces_are_those_to_the_nearest_one_of_the_frame(
    points: NDArray[np.float64], cuts: list[int]
) -> None:
    offsets = np.array([0, *sorted(cuts), 12])
    expected: list[float] = []
    for first, end in itertools.pairwise(offsets):
        points[first:end] = points[first:end][np.argsort(points[first:end, 0])]
        apart = np.linalg.norm(points[first:end, None] - points[first:end], axis=2)
        np.fill_diagonal(apart, np.inf)
        expected += apart.min(axis=1).tolist() if end - first > 1 else []
    assert spaces(points, offsets, np.arange(3)).tolist() == pytest.approx(expected)


def reference(*places: float) -> Trajectories:
    positions = np.array([[[x, 0.0, 0.0] for x in places]])
    names = tuple(f"m{x:g}" for x in places)
    return Trajectories(positions=positions, markers=names, rate=30.0)


def test_markers_of_a_reference_are_followed_under_their_names() -> None:
    points = detections([5, 9, 1], [5.5, 9.5], [], [20], [5.5, 9.5])
    with pytest.warns(UserWarning, match="2 of 8 points are none of the reference's markers"):
        tracks = nearest(points, reference(9, 5), gate=1.0, patience=0, shortest=3)
    assert tracks.markers == ("m9", "m5")
    places = np.nan_to_num(tracks.positions[..., 0], nan=-1.0).tolist()
    assert places == [[9, 5], [9.5, 5.5], [-1, -1], [-1, -1], [9.5, 5.5]]


def test_a_reference_must_have_a_frame_with_all_markers() -> None:
    lacking = reference(9, 5)
    positions = np.where([[[False], [True]]], np.nan, lacking.positions)
    lacking = Trajectories(positions=positions, markers=lacking.markers, rate=30.0)
    with pytest.raises(Refusal, match="all 2 markers; the fullest, frame 0, lacks m5"):
        nearest(detections([5]), lacking, gate=1.0)

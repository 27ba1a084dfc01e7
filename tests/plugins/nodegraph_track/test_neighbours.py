"""Neighbours carry a track, whatever it did itself; and where that fails is known, too."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_track.assignment import assignment
from nodegraph_track.linking_kernel import carried_by_neighbours
from nodegraph_track.neighbours import neighbours
from tests.plugins.nodegraph_track.points import detections, same


def face() -> NDArray[np.float64]:
    """Return (12, 3), a plate of markers 20 mm apart, by x, then y."""
    x, y = np.meshgrid(np.arange(4) * 20.0, np.arange(3) * 20.0, indexing="ij")
    return np.column_stack([x.ravel(), y.ravel(), 0.01 * (x * y).ravel()])


def turning(frames: int = 60) -> NDArray[np.float64]:
    """Return a plate that turns to the side and half back, 60 mm in front of the axis."""
    angle = np.radians(25.0) * np.sin(np.linspace(0.0, 0.8 * np.pi, frames))
    cos, sin, zero, first = np.cos(angle), np.sin(angle), 0 * angle, 1 + 0 * angle
    turns = np.array([[cos, zero, sin], [zero, first, zero], [-sin, zero, cos]])
    corner = np.array([-30.0, -20.0, 60.0])
    return np.asarray(np.einsum("ijt,mj->tmi", turns, face() + corner))


def plain(
    place: NDArray[np.float64],
    moved: NDArray[np.intp],
    motion: NDArray[np.float64],
    neighbours: int,
    otherwise: NDArray[np.float64],
) -> NDArray[np.float64]:
    rows = []
    for row, here in enumerate(place):
        others = [link for link in range(len(moved)) if moved[link] != row]
        others.sort(key=lambda link: float(np.linalg.norm(place[moved[link]] - here)))
        near = others[:neighbours]
        rows.append(here + np.median(motion[near], axis=0) if near else otherwise[row])
    return np.array(rows).reshape(-1, 3)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("count", [1, 2, 3, 8])
def test_a_place_is_moved_by_the_median_motion_of_the_nearest_others(seed: int, count: int) -> None:
    random = np.random.default_rng(seed)
    place, otherwise = random.normal(size=(2, random.integers(1, 15), 3))
    moved = np.flatnonzero(random.random(len(place)) < 0.7)
    motion = random.normal(size=(len(moved), 3))
    expected = plain(place, moved, motion, count, otherwise)
    near = np.repeat(np.arange(len(place))[:, None], count, axis=1)
    for _ in range(2):  # the second time, by the neighbours of the first
        result = carried_by_neighbours(place, moved, motion, near, otherwise)
        assert result == pytest.approx(expected)
    # and by those of other places
    again = place[::-1].copy()
    result = carried_by_neighbours(again, moved, motion, near, otherwise)
    assert result == pytest.approx(plain(again, moved, motion, count, otherwise))


def test_one_that_is_hidden_while_the_head_turns_is_found_where_its_neighbours_are() -> None:
    positions = turning()
    positions[12:45, 5] = np.nan
    assert same(neighbours(detections(positions), gate=4.0), positions)
    # its own velocity leads it astray, and it is not where it was
    assert len(assignment(detections(positions), gate=4.0).markers) == 13


def test_a_jerk_of_the_whole_head_breaks_no_track() -> None:
    positions = np.tile(face(), (20, 1, 1))
    positions[10:] += [7.0, 5.0, 0.0]
    positions[10:, :2] -= [0.0, 4.0, 0.0]
    assert not same(assignment(detections(positions), gate=8.0, shortest=1), positions)
    assert same(neighbours(detections(positions), gate=8.0, shortest=1), positions)


def test_a_neighbour_gone_astray_leads_nobody_away() -> None:
    positions = turning()
    positions[12:45, 5] = np.nan
    positions[20, 4] += [0.0, 3.5, 0.0]
    positions[30, 9] -= [0.0, 3.5, 0.0]
    assert same(neighbours(detections(positions), gate=4.0), positions)


def test_after_an_impulse_as_wide_as_the_gate_a_track_goes_on() -> None:
    positions = turning()
    positions[30, 5] += [-1.4, 3.7, 0.0]
    for tracker in (neighbours, assignment):
        assert same(tracker(detections(positions), gate=4.0), positions)


def against(frames: int = 30) -> NDArray[np.float64]:
    """Return a plate that stays, and one marker, the first by x, that slides over it."""
    positions = np.tile(face(), (frames, 1, 1))
    sliding = np.tile([-9.0, 10.0, 8.0], (frames, 1))
    sliding[6:, 0] += np.cumsum(np.minimum(np.arange(frames - 6.0) / 4.0, 2.0))
    return np.concatenate([sliding[:, None], positions], axis=1)


def test_one_that_moves_against_its_neighbours_is_followed_while_it_is_seen() -> None:
    assert same(neighbours(detections(against()), gate=1.5), against())


def test_one_that_moves_against_its_neighbours_while_it_is_hidden_is_lost() -> None:
    positions = against()
    positions[19:23, 0] = np.nan
    assert same(assignment(detections(positions), gate=4.0), positions)
    assert len(neighbours(detections(positions), gate=4.0).markers) == 14

"""Unnamed points are brought onto a shape from any pose, with points missing and too many."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from nodegraph_markers.registration import Match, register
from tests.plugins.nodegraph_markers.takes import face


def posed(
    shape: NDArray[np.float64], seed: int, noise: float = 0.5
) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Return a shape's points shuffled, turned and shaken, and the place of each."""
    random = np.random.default_rng(seed)
    order = random.permutation(len(shape))
    turn = Rotation.random(random_state=seed).as_matrix()
    points = shape[order] @ turn.T + random.normal(0.0, 300.0, 3)
    return points + random.normal(0.0, noise, points.shape), order


def share_right(match: Match | None, place: NDArray[np.intp]) -> float:
    assert match is not None
    return float(np.mean(place[match.point] == match.place))


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("markers", [10, 60])
def test_any_pose(seed: int, markers: int) -> None:
    shape = face(seed=seed % 3, seconds=1.0, markers=markers).neutral.positions[0]
    points, place = posed(shape, seed)
    match = register(points, shape, 12.0)
    assert match is not None
    assert len(match.point) == markers
    assert share_right(match, place) == 1.0
    moved = points @ match.rotation.T + match.translation
    assert np.linalg.norm(moved - shape[place], axis=1).max() < 3.0
    assert np.linalg.det(match.rotation) == pytest.approx(1.0)


@pytest.mark.parametrize("seed", range(2))
def test_points_that_are_no_place_and_places_without_a_point(seed: int) -> None:
    shape = face(seed=seed, seconds=1.0).neutral.positions[0]
    points, place = posed(shape, seed)
    half = points[place >= 30], place[place >= 30]  # one half of the pairs
    assert share_right(register(half[0], shape, 12.0), half[1]) == 1.0
    back = register(points, shape[30:], 12.0)
    assert share_right(back, place - 30) == 1.0
    random = np.random.default_rng(seed)
    ghosts = random.uniform(points.min(axis=0) - 20, points.max(axis=0) + 20, (6, 3))
    crowd = np.concatenate([points[:50], ghosts])
    fit = register(crowd, shape, 12.0)
    assert fit is not None
    own = fit.point < 50
    assert np.mean(place[fit.point[own]] == fit.place[own]) == 1.0


def test_the_other_half_of_a_face_is_reported_by_its_depth() -> None:
    synthetic = face(seed=1, seconds=1.0)
    shape, names = synthetic.neutral.positions[0], list(synthetic.neutral.markers)
    mirrored, _ = posed(shape * [-1.0, 1.0, 1.0], 4)
    other = {left: right for left, right in synthetic.marker_set.pairs}
    other |= {right: left for left, right in synthetic.marker_set.pairs}
    _, order = posed(shape, 4)
    expected = np.array([names.index(other.get(names[at], names[at])) for at in order])
    assert share_right(register(mirrored, shape, 12.0), expected) == 1.0

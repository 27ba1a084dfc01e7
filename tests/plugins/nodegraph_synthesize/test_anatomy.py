from __future__ import annotations

import numpy as np
import pytest

from nodegraph_synthesize.anatomy import Anatomy, make_anatomy
from nodegraph_synthesize.muscles import CHANNELS
from nodegraph_synthesize.proportions import Proportions
from nodegraph_synthesize.surface import on_face

_PLACES = np.array([[0.0, -74.0], [0.0, -29.0], [0.0, -44.0], [27.0, -36.0], [24.0, 48.0]])
_CHIN, _UPPER_LIP, _LOWER_LIP, _CORNER, _BROW = range(5)


def _anatomy() -> Anatomy:
    strengths = dict.fromkeys(CHANNELS, 1.0)
    return make_anatomy(on_face(_PLACES, Proportions()), Proportions(), strengths)


def _offsets(**levels: float) -> np.ndarray:
    return np.asarray(_anatomy().offsets(_activations(**levels))[0])


def _activations(**levels: float) -> np.ndarray:
    return np.array([[levels.get(name, 0.0) for name in CHANNELS]])


def test_the_jaw_lowers_the_chin_and_the_lower_lip_only() -> None:
    offsets = _offsets(jawOpen=1.0)
    # In one of the takes of AnimFace the chin goes 28 mm down and 20 mm back.
    assert -38.0 < offsets[_CHIN, 1] < -28.0
    assert -28.0 < offsets[_CHIN, 2] < -18.0
    assert -38.0 < offsets[_LOWER_LIP, 1] < -28.0
    np.testing.assert_allclose(offsets[[_UPPER_LIP, _BROW]], 0.0, rtol=0, atol=0.1)


def test_the_mouth_opens_in_the_middle_and_less_towards_its_corners() -> None:
    places = np.array([[u, v] for u in (0.0, 10.0, 20.0, 27.0) for v in (-35.9, -36.1)])
    points = on_face(places, Proportions())
    anatomy = make_anatomy(points, Proportions(), dict.fromkeys(CHANNELS, 1.0))
    upper, lower = anatomy.offsets(_activations(jawOpen=1.0))[0, :, 1].reshape(-1, 2).T
    opened = upper - lower
    assert opened[0] > 25.0
    assert (np.diff(opened) < -3.0).all()
    assert abs(opened[-1]) < 0.5
    assert upper[-1] == pytest.approx(-0.5 * opened[0], rel=0.2)


@pytest.mark.parametrize(
    ("muscle", "point", "direction"),
    [
        ("zygomaticMajorLeft", _CORNER, (1, 1)),
        ("depressorAnguliOrisLeft", _CORNER, (0, -1)),
        ("platysmaLeft", _CORNER, (1, 0)),
        ("frontalisInnerLeft", _BROW, (0, 1)),
        ("corrugatorLeft", _BROW, (-1, -1)),
    ],
)
def test_muscles_pull_where_they_should(
    muscle: str, point: int, direction: tuple[int, int]
) -> None:
    x, y, _ = _offsets(**{muscle: 1.0})[point]
    assert 2.0 < np.hypot(x, y) < 15.0
    for moved, sign in zip((x, y), direction, strict=True):
        assert sign == 0 or moved * sign > 0.5


def test_muscles_of_the_left_leave_the_right_alone() -> None:
    mirrored = on_face(_PLACES * [-1.0, 1.0], Proportions())
    anatomy = make_anatomy(mirrored, Proportions(), dict.fromkeys(CHANNELS, 1.0))
    offsets = anatomy.offsets(_activations(frontalisInnerLeft=1.0))
    np.testing.assert_allclose(offsets[0, _BROW], 0.0, rtol=0, atol=1e-9)

from __future__ import annotations

import numpy as np
import pytest

from nodegraph_synthesize.muscles import (
    LinearMuscle,
    puff_offsets,
    pull_of,
    sphincter_offsets,
)
from nodegraph_synthesize.proportions import MOUTH_HEIGHT, Proportions
from nodegraph_synthesize.surface import on_face

_MUSCLE = LinearMuscle((0.0, 0.0), (0.0, -40.0), 0.5, 1.5, 40.0, 6.0)


def _line() -> tuple[np.ndarray, np.ndarray]:
    attachment, insertion = on_face(np.array([[0.0, 0.0], [0.0, -40.0]]), Proportions())
    return attachment, insertion - attachment


@pytest.mark.parametrize(
    ("lengths", "share"),
    # Waters' r(D) with Rs = 1/2 and Rf = 3/2: cos((1 - D/Rs) pi/2), then cos((D - Rs) pi/2).
    [
        (0.25, np.cos(np.pi / 4)),
        (0.5, 1.0),
        (1.0, np.cos(np.pi / 4)),
        (1.49, np.cos(0.495 * np.pi)),
    ],
)
def test_pull_along_the_muscle_follows_waters(lengths: float, share: float) -> None:
    attachment, line = _line()
    pull = pull_of(_MUSCLE, (attachment + lengths * line)[None], Proportions())
    assert pull.amounts[0] == pytest.approx(6.0 * share)
    np.testing.assert_array_equal(pull.attachment, attachment)


def test_nothing_moves_beyond_the_end_nor_outside_the_zone() -> None:
    attachment, line = _line()
    sideways = np.array([np.linalg.norm(line), 0.0, 0.0])
    points = np.stack([attachment + 1.6 * line, attachment - 0.5 * line, attachment + sideways])
    assert pull_of(_MUSCLE, points, Proportions()).points.size == 0


def test_pull_fades_to_the_side() -> None:
    attachment, line = _line()
    sideways = np.array([np.linalg.norm(line), 0.0, 0.0])
    angle = np.radians(20.0)
    point = attachment + 0.5 * (np.cos(angle) * line + np.sin(angle) * sideways)
    pull = pull_of(_MUSCLE, point[None], Proportions())
    assert pull.amounts[0] == pytest.approx(6.0 * np.cos(np.pi / 4))


def test_the_sphincter_narrows_the_mouth_and_pushes_it_forward() -> None:
    places = np.array([[27.0, MOUTH_HEIGHT], [-27.0, MOUTH_HEIGHT], [0.0, -29.0], [0.0, 60.0]])
    left, right, upper, forehead = sphincter_offsets(on_face(places, Proportions()), Proportions())
    assert left[0] == pytest.approx(-10.0, abs=0.2)
    assert right[0] == pytest.approx(10.0, abs=0.2)
    assert upper[1] < 0
    assert upper[2] > 2.0
    np.testing.assert_allclose(forehead, 0.0, rtol=0, atol=1e-12)


def test_cheeks_are_blown_up_outwards_and_nothing_else_is() -> None:
    places = np.array([[45.0, -26.0], [-45.0, -26.0], [0.0, -29.0], [0.0, 30.0], [31.0, 34.0]])
    points = on_face(places, Proportions())
    left, right, *rest = puff_offsets(points, Proportions())
    assert left[0] > 8.0
    assert left[2] > 8.0
    np.testing.assert_array_equal(right, left * [-1.0, 1.0, 1.0])
    np.testing.assert_allclose(rest, 0.0, rtol=0, atol=0.05)

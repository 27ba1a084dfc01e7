"""An eye closes as far as markers on its lids let one see, and its skin does not fold."""

from __future__ import annotations

import numpy as np
import pytest

from nodegraph_synthesize.eyelids import eyelid_offsets
from nodegraph_synthesize.proportions import Proportions, draw_proportions
from nodegraph_synthesize.surface import make_surface, on_face

_FACES = [Proportions(), *(draw_proportions(np.random.default_rng(seed)) for seed in range(4))]
_UPPER, _LOWER = [26.0, 33.5], [31.0, 18.0]


@pytest.mark.parametrize("face", _FACES)
def test_closed_lids_lie_on_the_surface(face: Proportions) -> None:
    points = make_surface(face).vertices
    closed = points + eyelid_offsets(points, face)["orbicularisOculiRight"]
    moved = np.abs(closed - points).max(axis=1) > 0.01
    places = closed[moved, :2] / [face.width, face.height]
    np.testing.assert_allclose(on_face(places, face)[:, 2], closed[moved, 2], rtol=0, atol=0.2)


def test_the_skin_is_not_folded() -> None:
    heights = np.linspace(0.0, 60.0, 601)
    for u in (20.0, 31.0, 44.0):
        points = on_face(np.stack([np.full(601, u), heights], axis=1), Proportions())
        closed = points + eyelid_offsets(points, Proportions())["orbicularisOculiLeft"]
        assert (np.diff(closed[:, 1]) > 0.0).all()


def test_each_eye_closes_alone_and_they_mirror_each_other() -> None:
    points = make_surface(Proportions()).vertices
    offsets = eyelid_offsets(points, Proportions())
    mirrored = eyelid_offsets(points * [-1.0, 1.0, 1.0], Proportions())
    np.testing.assert_allclose(
        mirrored["orbicularisOculiRight"] * [-1.0, 1.0, 1.0],
        offsets["orbicularisOculiLeft"],
        rtol=0,
        atol=1e-12,
    )
    np.testing.assert_array_equal(offsets["orbicularisOculiLeft"][points[:, 0] <= 0.0], 0.0)

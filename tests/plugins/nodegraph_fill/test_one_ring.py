"""Delaunay neighbours of a face seen from the front."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from nodegraph_fill.lin_ouhyoung import one_ring
from tests.plugins.recordings import make_recording


def hexagon() -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """A centre in front of six markers around it, wider than high, and one far to the side."""
    angles = np.arange(6) * np.pi / 3
    around = np.stack([50 * np.cos(angles), 40 * np.sin(angles), np.zeros(6)], axis=1)
    return np.concatenate([[[0.0, 0.0, 10.0]], around, [[200.0, 0.0, 0.0]]])


def test_the_centre_is_joined_to_those_around_it() -> None:
    joined = one_ring(make_recording(hexagon()[None]))
    assert np.flatnonzero(joined[0]).tolist() == [1, 2, 3, 4, 5, 6]
    np.testing.assert_array_equal(joined, joined.T)
    assert not joined.diagonal().any()


def test_a_turned_head_has_the_same_rings() -> None:
    turned = Rotation.from_rotvec([0.3, -1.0, 2.0]).apply(hexagon()) + np.array([5, 6, 7])
    np.testing.assert_array_equal(
        one_ring(make_recording(turned[None])), one_ring(make_recording(hexagon()[None]))
    )


def test_a_marker_in_the_place_of_another_shares_its_ring() -> None:
    shape = np.concatenate([hexagon(), hexagon()[:1]])
    joined = one_ring(make_recording(shape[None]))
    assert joined[0, 8]
    assert joined[8, 0]
    np.testing.assert_array_equal(joined[0, 1:8], joined[8, 1:8])
    np.testing.assert_array_equal(joined, joined.T)


def test_without_triangles_all_are_joined() -> None:
    line = np.arange(5.0)[:, None] * [1.0, 2.0, 3.0]
    for shape in (line, line[:2], line[:1], np.zeros((4, 3))):
        np.testing.assert_array_equal(
            one_ring(make_recording(shape[None])), ~np.eye(len(shape), dtype=bool)
        )


def test_a_marker_that_is_never_there_has_no_ring() -> None:
    shape = hexagon()
    shape[3] = np.nan
    joined = one_ring(make_recording(shape[None]))
    assert not joined[3].any()
    assert not joined[:, 3].any()
    assert joined[0, 1]
    assert not one_ring(make_recording(np.full((2, 3, 3), np.nan))).any()

"""Parts of a take are those parts."""

from __future__ import annotations

import numpy as np
import pytest

from nodegraph_markers.crop import crop
from nodegraph_mocap.specimens import recordings

FACE = recordings()["filled, repaired and with sigma"]


def test_both_ends_are_kept() -> None:
    result = crop(FACE, frames=((5, 12),))
    assert result.frames == 8
    assert np.array_equal(result.positions, FACE.positions[5:13], equal_nan=True)
    assert np.array_equal(result.origin, FACE.origin[5:13])
    assert FACE.sigma is not None
    assert result.sigma is not None
    assert np.array_equal(result.sigma, FACE.sigma[5:13], equal_nan=True)
    assert (result.markers, result.rate, result.marker_set) == (
        FACE.markers,
        FACE.rate,
        FACE.marker_set,
    )


def test_parts_follow_each_other_in_the_order_that_is_asked_for() -> None:
    result = crop(FACE, frames=((30, None), (5, 12), (10, 14)))
    order = [*range(30, FACE.frames), *range(5, 13), *range(10, 15)]
    assert np.array_equal(result.positions, FACE.positions[order], equal_nan=True)
    assert np.array_equal(result.origin, FACE.origin[order])


@pytest.mark.parametrize(
    ("first", "last", "what"),
    [
        (0, 40, "frames 0 to 40 do not exist; the take has 40 frames, 0 to 39"),
        (40, None, "the take has 40 frames"),
        (12, 11, "the last frame, 11, comes before the first, 12"),
    ],
)
def test_frames_that_are_not_there(first: int, last: int | None, what: str) -> None:
    with pytest.raises(ValueError, match=what):
        crop(FACE, frames=((0, 3), (first, last)))

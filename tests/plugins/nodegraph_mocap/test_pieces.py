from __future__ import annotations

import pytest

from nodegraph_mocap.pieces import pieces


@pytest.mark.parametrize("frames", [0, 1, 2, 1000, 54_321])
@pytest.mark.parametrize("frame_bytes", [0, 1, 24, 2400, 2**20])
def test_the_pieces_are_all_frames_and_small(frames: int, frame_bytes: int) -> None:
    found = list(pieces(frames, frame_bytes))
    assert [frame for piece in found for frame in range(piece.start, piece.stop)] == [
        *range(frames)
    ]
    assert all(
        0 < piece.stop - piece.start <= max(1, 2**20 // max(1, frame_bytes)) for piece in found
    )

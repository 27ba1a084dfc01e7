"""Names are found from any start, across expression, and where the take begins anew."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from nodegraph_markers.naming import names, track_distances
from nodegraph_markers.rigid import spacing
from nodegraph_markers.tracks import UNNAMED, Tracks
from nodegraph_mocap import Trajectories
from nodegraph_synthesize.face import SyntheticFace

Face = Callable[..., SyntheticFace]


def of(positions: NDArray[np.float64], reference: Trajectories) -> Tracks:
    shape = reference.positions[0]
    return Tracks(positions, ~np.isnan(positions[..., 0]), shape, spacing(shape))


def test_every_track_of_a_take_that_moves(face: Face) -> None:
    made = face(seed=5, seconds=4.0)
    order = np.random.default_rng(0).permutation(60)
    tracks = of(made.captured.positions[:, order], made.neutral)
    assert np.array_equal(names(tracks), order)
    assert track_distances(tracks, order)[np.arange(60), order].max() < 0.5 * tracks.gate


def test_fragments_are_reached_from_frame_to_frame(face: Face) -> None:
    made = face(seed=6, seconds=6.0)
    whole = made.captured.positions
    pieces = []
    for marker in range(60):
        for start in range(-(marker % 7) * 10, 360, 70):
            piece = np.full((360, 3), np.nan)
            piece[max(start, 0) : start + 70] = whole[max(start, 0) : start + 70, marker]
            if np.isfinite(piece).any():
                pieces.append((marker, piece))
    found = names(of(np.stack([one for _, one in pieces], axis=1), made.neutral))
    assert np.mean(found == [marker for marker, _ in pieces]) > 0.99


def test_a_take_in_which_nothing_is_seen_for_a_while_is_begun_again(face: Face) -> None:
    made = face(seed=7, seconds=4.0)
    positions = np.full((240, 120, 3), np.nan)
    positions[:100, :60] = made.captured.positions[:100]
    positions[130:, 60:] = made.captured.positions[130:]
    found = names(of(positions, made.neutral))
    assert np.array_equal(found, np.tile(np.arange(60), 2))


def test_frames_of_too_few_points_are_no_start(face: Face) -> None:
    made = face(seed=7, seconds=1.0)
    positions = np.full_like(made.captured.positions, np.nan)
    positions[:, :14] = made.truth.positions[:, :14]
    assert (names(of(positions, made.neutral)) == UNNAMED).all()

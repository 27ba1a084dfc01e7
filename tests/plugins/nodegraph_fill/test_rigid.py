"""The nearest markers' motion as a rigid body, from both ends of the gap."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from nodegraph_fill.rigid import rigid
from nodegraph_mocap import Origin
from tests.plugins.nodegraph_fill.plain_fills import carry, plain_gaps
from tests.plugins.recordings import make_gappy, make_recording, quietly

Positions = NDArray[np.float64]


def moved_body(frames: int, markers: int, seed: int) -> Positions:
    """A rigid body that turns and moves."""
    random = np.random.default_rng(seed)
    body = random.normal(0, 30, (markers, 3))
    turns = Rotation.from_rotvec(np.cumsum(random.normal(0, 0.05, (frames, 3)), axis=0))
    shifts = np.cumsum(random.normal(0, 2, (frames, 1, 3)), axis=0)
    return np.stack([turn.apply(body) for turn in turns]) + shifts


@given(seed=st.integers(0, 2**32 - 1), neighbours=st.sampled_from([3, 4, 6]))
def test_equals_scipys_fit_from_both_ends(seed: int, neighbours: int) -> None:
    recording = make_gappy(seed)
    expected = recording.positions.copy()
    for marker, start, stop in plain_gaps(recording.origin):
        for frame in range(start, stop):
            ahead = carry(recording, start - 1, frame, marker, neighbours)
            back = carry(recording, stop, frame, marker, neighbours)
            share = (frame - start + 1) / (stop - start + 1)
            mixed = (1 - share) * ahead + share * back
            mixed = back if np.isnan(ahead).any() else ahead if np.isnan(back).any() else mixed
            expected[frame, marker] = mixed
    filled = quietly(rigid, recording, neighbours=neighbours)
    np.testing.assert_allclose(filled.positions, expected, rtol=0, atol=1e-7)


def test_neighbours_on_a_line_tell_nothing() -> None:
    positions = np.zeros((6, 4, 3))
    positions[:, 1:, 0] = [10.0, 20.0, 30.0]
    positions[:, 1:, 1] = [0.0, 0.1, 0.0]
    positions[2:4, 0] = np.nan
    message = "^2 samples of 1 marker left missing: no three neighbours that span a plane 2$"
    with pytest.warns(UserWarning, match=message):
        filled = rigid(make_recording(positions))
    assert not np.any(filled.origin == Origin.FILLED)


def test_long_takes_are_computed_piece_by_piece() -> None:
    truth = np.tile(moved_body(50, 5, 1), (100, 1, 1))
    gappy = truth.copy()
    gappy[1:4999, 0] = np.nan
    filled = rigid(make_recording(gappy))
    np.testing.assert_allclose(filled.positions, truth, rtol=0, atol=1e-8)

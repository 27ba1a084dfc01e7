"""Guenter et al.: the mean of the nearest neighbours, in a greedy order."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_fill.guenter import guenter
from nodegraph_mocap import Origin, Trajectories
from tests.plugins.nodegraph_fill.plain_fills import run_plainly
from tests.plugins.recordings import make_gappy, make_recording, quietly


def weigh(distances: list[float]) -> list[float]:
    return [1 / len(distances)] * len(distances)


@given(
    seed=st.integers(0, 2**32 - 1),
    neighbours=st.sampled_from([1, 3, 20]),
    ring=st.sampled_from([1, 3, 8]),
    use_filled=st.booleans(),
    close_gap=st.sampled_from(["none", "ramp", "blend"]),
)
def test_equals_the_plain_statement(
    seed: int, neighbours: int, ring: int, use_filled: bool, close_gap: str
) -> None:
    recording = make_gappy(seed)
    shared: dict[str, Any] = {
        "neighbours": neighbours,
        "ring": ring,
        "use_filled": use_filled,
        "close_gap": close_gap,
    }
    filled = quietly(guenter, recording, **shared)
    plain = run_plainly(recording, weigh, **shared)
    np.testing.assert_allclose(filled.positions, plain, rtol=0, atol=1e-9)


def on_a_line(places: list[float], moves: list[float]) -> Trajectories:
    """Markers a, b, ... of which those that move by NaN are missing in the second frame.

    The others were filled in the first frame, so that all help equally and order decides.
    """
    positions = np.zeros((2, len(places), 3))
    positions[:, :, 0] = places
    positions[1, :, 2] = moves
    positions[np.isnan(positions).any(axis=2)] = np.nan
    origin = np.full((2, len(places)), Origin.MEASURED, dtype=np.uint8)
    origin[0, ~np.isnan(moves)] = Origin.FILLED
    origin[1, np.isnan(moves)] = Origin.MISSING
    names = tuple("abcdefg"[: len(places)])
    return Trajectories(positions=positions, markers=names, rate=60.0, origin=origin)


def test_of_equally_many_usable_the_nearer_ring_goes_first() -> None:
    """b goes first and follows d; a follows b, and would have followed c in marker order."""
    recording = on_a_line([9.5, 11, 0, 20], [np.nan, np.nan, 1, 5])
    filled = guenter(recording, neighbours=1, ring=2)
    assert filled.positions[1, :2, 2].tolist() == [5, 5]


def test_more_usable_in_the_ring_goes_before_a_nearer_ring() -> None:
    """The ring of b is nearest, but only that of a has a usable marker: all follow c."""
    recording = on_a_line([0, 1.5, -2.6, 5.45, 2.7], [np.nan, np.nan, 1, 5, np.nan])
    filled = guenter(recording, neighbours=1, ring=2)
    assert filled.positions[1, [0, 1, 4], 2].tolist() == [1, 1, 1]


def test_equal_rings_go_in_marker_order() -> None:
    """Mirror images: a goes first and follows c, b follows a."""
    recording = on_a_line([10, 11, 0, 21], [np.nan, np.nan, 1, 5])
    filled = guenter(recording, neighbours=1, ring=2)
    assert filled.positions[1, :2, 2].tolist() == [1, 1]


def test_no_neighbour_to_use_is_refused() -> None:
    with pytest.raises(ValueError, match="neighbours must be at least 1, got 0"):
        guenter(make_recording(np.zeros((2, 2, 3))), neighbours=0)

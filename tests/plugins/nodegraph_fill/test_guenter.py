"""Guenter et al.: the mean of the nearest neighbours, in a greedy order."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nodegraph_fill.guenter import guenter
from nodegraph_mocap import Trajectories


def weigh(distances: list[float]) -> list[float]:
    return [1 / len(distances)] * len(distances)


@settings(deadline=None, max_examples=150, derandomize=True)
@given(
    seed=st.integers(0, 2**32 - 1),
    neighbours=st.sampled_from([1, 3, 20]),
    ring=st.sampled_from([1, 3, 8]),
    use_filled=st.booleans(),
    close_gap=st.sampled_from(["none", "ramp", "blend"]),
)
def test_equals_the_plain_statement(
    gappy: Callable[[int], Trajectories],
    quietly: Callable[..., Trajectories],
    plainly: Callable[..., Any],
    seed: int,
    neighbours: int,
    ring: int,
    use_filled: bool,
    close_gap: str,
) -> None:
    recording = gappy(seed)
    shared = {
        "neighbours": neighbours,
        "ring": ring,
        "use_filled": use_filled,
        "close_gap": close_gap,
    }
    filled = quietly(guenter, recording, **shared)
    plain = plainly(recording, weigh, **shared)
    np.testing.assert_allclose(filled.positions, plain, rtol=0, atol=1e-9)


def test_the_better_surrounded_marker_goes_first(recorded: Callable[..., Trajectories]) -> None:
    """On a line, b is near two measured markers and a is near b: b must be filled before a."""
    places = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]], dtype=float)
    positions = np.stack([places, places + [0, 0, 1]])
    positions[1, 3, 2] += 6
    positions[1, :2] = np.nan
    filled = guenter(recorded(positions), neighbours=1, ring=2)
    # In marker order a would follow c, the nearest that is measured; it does so in this order
    # too, because a filled neighbour comes after a measured one.
    assert filled.positions[1, 1, 2] == filled.positions[1, 0, 2] == 1
    followers = guenter(recorded(positions), neighbours=3, ring=2)
    # b: the mean of c (1) and d (7). a: the mean of c, d and, last, b itself.
    assert followers.positions[1, 1, 2] == 4
    assert followers.positions[1, 0, 2] == 4
    assert guenter(recorded(positions[:, ::-1]), neighbours=3, ring=2).positions[1, 3, 2] == 4


def test_greedy_order_changes_the_answer(recorded: Callable[..., Trajectories]) -> None:
    """With one neighbour by ring, c is filled first and then is the only help to no one else."""
    places = np.array([[0, 0, 0], [10, 0, 0], [11, 0, 0]], dtype=float)
    positions = np.stack([places, places + [0, 0, 2]])
    positions[1, :2] = np.nan
    filled = guenter(recorded(positions), neighbours=2, ring=1)
    # b, whose one ring neighbour c is usable, goes first: by c alone. Then a: by c and b.
    np.testing.assert_array_equal(filled.positions[1, :2, 2], [2, 2])
    unaided = guenter(recorded(positions), neighbours=2, ring=1, use_filled=False)
    np.testing.assert_array_equal(unaided.positions[1, :2, 2], [2, 2])


def test_no_neighbour_to_use_is_refused(recorded: Callable[..., Trajectories]) -> None:
    with pytest.raises(ValueError, match="neighbours must be at least 1, got 0"):
        guenter(recorded(np.zeros((2, 2, 3))), neighbours=0)

"""Waters' single muscle: the nearest neighbour, scaled by its distance."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_fill.waters import waters
from nodegraph_mocap import Trajectories
from tests.plugins.nodegraph_fill.plain_fills import run_plainly
from tests.plugins.recordings import make_gappy, make_recording, quietly


def weigh(distances: list[float], full: float = 15.0, end: float = 45.0) -> list[float]:
    (distance,) = distances
    if distance <= full:
        return [math.cos((1 - distance / full) * math.pi / 2)]
    if distance <= end:
        return [math.cos((distance - full) / (end - full) * math.pi / 2)]
    return [0.0]


@given(
    seed=st.integers(0, 2**32 - 1),
    radii=st.sampled_from([(15.0, 45.0), (2.0, 20.0), (40.0, 60.0)]),
    use_filled=st.booleans(),
    close_gap=st.sampled_from(["none", "ramp", "blend"]),
)
def test_equals_the_plain_statement(
    seed: int, radii: tuple[float, float], use_filled: bool, close_gap: str
) -> None:
    recording = make_gappy(seed)
    full, end = radii
    shared: dict[str, Any] = {"use_filled": use_filled, "close_gap": close_gap}
    filled = quietly(waters, recording, full_radius=full, falloff_radius=end, **shared)
    plain = run_plainly(
        recording, lambda distances: weigh(distances, full, end), neighbours=1, **shared
    )
    np.testing.assert_allclose(filled.positions, plain, rtol=0, atol=1e-9)


def follow(distance: float) -> float:
    """How far a marker goes with a neighbour that goes by 1 mm."""
    positions = np.zeros((2, 2, 3))
    positions[:, 1, 0] = distance
    positions[1, 1, 1] = 1
    positions[1, 0] = np.nan
    recording = Trajectories(positions=positions, markers=("a", "b"), rate=60.0)
    return float(waters(recording).positions[1, 0, 1])


@pytest.mark.parametrize(
    ("distance", "share"), [(15.0, 1.0), (5.0, 0.5), (10.0, math.sqrt(0.75)), (35.0, 0.5)]
)
def test_the_share_of_the_displacement(distance: float, share: float) -> None:
    assert follow(distance) == pytest.approx(share, abs=1e-12)


@pytest.mark.parametrize("distance", [0.0, 45.0, 46.0, 500.0])
def test_a_marker_that_stays_where_it_was_is_counted(distance: float) -> None:
    with pytest.warns(UserWarning, match="1 predictions left a marker where it was"):
        assert follow(distance) == pytest.approx(0, abs=1e-15)


@pytest.mark.parametrize("falloff", [15.0, 10.0])
def test_radii_in_the_wrong_order_are_refused(falloff: float) -> None:
    with pytest.raises(
        ValueError, match=rf"smaller than falloff_radius, got 15.0 and {falloff} mm"
    ):
        waters(make_recording(np.zeros((2, 2, 3))), falloff_radius=falloff)

"""Lin and Ouhyoung as formulated by Zhang et al.: a cosine of the distance."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_fill.lin_ouhyoung import lin_ouhyoung, one_ring
from tests.plugins.nodegraph_fill.plain_fills import run_plainly
from tests.plugins.recordings import make_gappy, make_recording, quietly


def weigh(distances: list[float]) -> list[float]:
    near, far = min(distances), max(distances)
    if far == near:
        return [1 / len(distances)] * len(distances)
    weights = [math.cos((d - near) / (far - near) * math.pi / 2.5) for d in distances]
    return [weight / sum(weights) for weight in weights]


@given(
    seed=st.integers(0, 2**32 - 1),
    neighbours=st.sampled_from([1, 2, 8, "one_ring"]),
    use_filled=st.booleans(),
    close_gap=st.sampled_from(["none", "ramp", "blend"]),
)
def test_equals_the_plain_statement(
    seed: int, neighbours: int | str, use_filled: bool, close_gap: str
) -> None:
    recording = make_gappy(seed)
    shared: dict[str, Any] = {"use_filled": use_filled, "close_gap": close_gap}
    filled = quietly(lin_ouhyoung, recording, neighbours=neighbours, **shared)
    ringed = neighbours == "one_ring"
    rule = (
        {"neighbours": 99, "joined": one_ring(recording)} if ringed else {"neighbours": neighbours}
    )
    plain = run_plainly(recording, weigh, **rule, **shared)
    np.testing.assert_allclose(filled.positions, plain, rtol=0, atol=1e-9)


def test_equal_distances_weigh_the_same() -> None:
    positions = np.zeros((2, 5, 3))
    positions[:, 1:, :2] = [[1, 0], [-1, 0], [0, 1], [0, -1]]
    positions[1, 1:, 2] = [1, 2, 3, 6]
    positions[1, 0] = np.nan
    np.testing.assert_allclose(lin_ouhyoung(make_recording(positions)).positions[1, 0], [0, 0, 3])

"""What may be said of bounds, and what it means."""

from __future__ import annotations

import math
from typing import Any

import pytest

from nodegraph_blendshapes.solve_bounds import limits


@pytest.mark.parametrize(
    ("bounds", "low", "high"),
    [
        ((0.0, 1.0), 0.0, 1.0),
        ([-1, 2], -1.0, 2.0),
        ((-0.5, 0.0), -0.5, 0.0),
        ("nonnegative", 0.0, math.inf),
        ("none", -math.inf, math.inf),
    ],
)
def test_bounds(bounds: Any, low: float, high: float) -> None:
    assert limits(bounds) == (low, high)


@pytest.mark.parametrize(
    "bounds",
    [(1.0, 0.0), (0.0, 0.0), (0.1, 1.0), (-1.0, -0.5), (0.0, math.inf), (math.nan, 1.0),
     (0.0, 0.5, 1.0), (), "positive", ""],
)  # fmt: skip
def test_nonsense_is_named(bounds: Any) -> None:
    with pytest.raises(ValueError, match="two numbers, the lower first and 0, the face at rest"):
        limits(bounds)

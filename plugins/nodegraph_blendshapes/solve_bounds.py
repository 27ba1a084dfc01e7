"""The setting ``bounds``: between what a weight may lie."""

from __future__ import annotations

import math
from typing import Literal

Bounds = tuple[float, float] | Literal["nonnegative", "none"]


def limits(bounds: Bounds) -> tuple[float, float]:
    """Return the lower and the upper bound, infinite where there is none.

    Raises
    ------
    ValueError
        If they are none of the words and no two numbers with 0 between them.
    """
    if isinstance(bounds, str):
        words = {"nonnegative": (0.0, math.inf), "none": (-math.inf, math.inf)}
        if bounds in words:
            return words[bounds]
    elif len(bounds) == 2:
        low, high = bounds
        if math.isfinite(low) and math.isfinite(high) and low <= 0.0 <= high and low < high:
            return float(low), float(high)
    raise ValueError(
        f"bounds must be two numbers, the lower first and 0, the face at rest, not outside of "
        f"them, or nonnegative or none; got {bounds}"
    )

"""The setting ``bounds``: between what a weight may lie."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import AfterValidator
from pydantic_core import PydanticCustomError

_Written = tuple[float, float] | Literal["nonnegative", "none"]
_RULE = (
    "two numbers, the lower first and 0, the face at rest, not outside of them, or nonnegative or "
    "none"
)
_WORDS = {"nonnegative": (0.0, math.inf), "none": (-math.inf, math.inf)}


def limits(bounds: Bounds) -> tuple[float, float]:
    """Return the lower and the upper bound, infinite where there is none.

    Raises
    ------
    ValueError
        If they are none of the words and no two numbers with 0 between them.
    """
    found = _limits(bounds)
    if found is None:
        raise ValueError(f"bounds must be {_RULE}; got {bounds}")
    return found


def _limits(bounds: _Written) -> tuple[float, float] | None:
    if isinstance(bounds, str):
        return _WORDS.get(bounds)
    if len(bounds) != 2:
        return None
    low, high = bounds
    finite = math.isfinite(low) and math.isfinite(high)
    return (float(low), float(high)) if finite and low <= 0.0 <= high and low < high else None


def _as_pydantic_says_it(bounds: _Written) -> _Written:
    if _limits(bounds) is None:
        raise PydanticCustomError("bounds", f"Input must be {_RULE}")
    return bounds


Bounds = Annotated[_Written, AfterValidator(_as_pydantic_says_it)]

"""The work that every engine is given, and what an engine makes of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

ARRAY_BYTES = 10_000_000
LARGE_BYTES = 50_000_000


def zero() -> float:
    return 0.0


def plus_one(value: float) -> float:
    return value + 1.0


def zeros() -> np.ndarray:
    return np.zeros(ARRAY_BYTES // 8)


def large_zeros() -> np.ndarray:
    return np.zeros(LARGE_BYTES // 8)


def next_array(value: np.ndarray) -> np.ndarray:
    return value + 1.0


@dataclass(frozen=True)
class Work:
    """A first value, and the step that each node of a chain makes of the one before.

    The argument of `step` is called ``value``. A chain of `count` steps has `count` + 1 nodes,
    because the first value comes from a node of its own.
    """

    kind: type
    first: Callable[[], object]
    step: Callable[..., object]


NUMBERS = Work(float, zero, plus_one)
ARRAYS = Work(np.ndarray, zeros, next_array)
LARGE_ARRAYS = Work(np.ndarray, large_zeros, next_array)

Run = Callable[[], object]
"""Runs what was built and returns the last value."""

Build = Callable[[], Run]
"""Builds the chain from what an author writes down for that engine."""

Engine = Callable[[Work, int], Build]
"""Prepares a chain of so many steps: what it writes before a build is timed is not timed."""

"""Elements of all strategies: names, seeds, places of markers, runs of samples."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hypothesis.strategies import DrawFn, SearchStrategy
    from numpy.typing import NDArray

NAMES = (
    "nose", "brow_left", "brow_right", "cheek_left", "cheek_right", "lip_left", "lip_right",
    "chin", "forehead", "temple_left", "temple_right", "eye_left", "eye_right", "ear_left",
    "ear_right", "throat",
)  # fmt: skip
RATES = (60.0, 120.0, 30.0, 100.0, 59.94)
RADIUS = 80.0
MOST_EVENTS = 4


def seeds() -> SearchStrategy[int]:
    """Return a strategy for seeds."""
    from hypothesis import strategies as st

    return st.integers(0, 2**32 - 1)


def names_of(draw: DrawFn, markers: tuple[int, int]) -> tuple[str, ...]:
    """Return as many names of markers, in any order."""
    from hypothesis import strategies as st

    count = draw(st.integers(*markers))
    return tuple(draw(st.permutations(NAMES[:count])))


def at_rest(count: int) -> NDArray[np.float64]:
    """Return (M, 3) positions on a sphere, none near another."""
    index = np.arange(count) + 0.5
    height = 1.0 - 2.0 * index / len(NAMES)
    angle = np.pi * (1.0 + np.sqrt(5.0)) * index
    around = np.sqrt(1.0 - height**2)
    return RADIUS * np.column_stack([around * np.cos(angle), height, around * np.sin(angle)])


def runs(draw: DrawFn, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """Return (T, M): some runs of members of the second axis."""
    from hypothesis import strategies as st

    frames, members = shape
    events = st.tuples(
        st.integers(0, members - 1), st.integers(0, frames - 1), st.integers(1, frames)
    )
    where = np.zeros(shape, dtype=np.bool_)
    for member, start, length in draw(st.lists(events, max_size=MOST_EVENTS)):
        where[start : start + length, member] = True
    return where

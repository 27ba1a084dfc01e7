"""Columns of a table that count its rows: frame numbers, and times in their units."""

from __future__ import annotations

import re
import warnings
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import quoted

if TYPE_CHECKING:
    from numpy.typing import NDArray

_FRAME = re.compile(r"frames?(?:[ _]*(?:number|index|no\.?|id|#))?|index", re.IGNORECASE)
_TIME = re.compile(
    r"time(?P<stamp>[ _]?stamp)?s?[ _]*+[\[(]?+\s*+(?P<unit>[a-zµ]*+)\s*+[\])]?", re.IGNORECASE
)
_SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
_SPELLINGS = {
    "s": ("sec", "second", "seconds"),
    "ms": ("msec", "millis", "millisecond", "milliseconds"),
    "us": ("µs", "usec", "micros", "microsecond", "microseconds"),
    "ns": ("nsec", "nanos", "nanosecond", "nanoseconds"),
}
_SYMBOLS = {"": ""} | {name: unit for unit, names in _SPELLINGS.items() for name in (unit, *names)}
_SLOWEST, _FASTEST = 2.0, 1000.0
"""Hz, of motion capture: a range in which a step of time has one unit only."""


def is_frame(name: str) -> bool:
    """Return whether a column of that name holds frame numbers."""
    return _FRAME.fullmatch(name.strip()) is not None


def is_time(name: str) -> bool:
    """Return whether a column of that name holds times: ``time``, ``timestamp (ms)``."""
    match = _TIME.fullmatch(name.strip())
    return match is not None and match["unit"].lower() in _SYMBOLS


def is_counter(name: str) -> bool:
    """Return whether a column of that name holds frame numbers or times."""
    return is_frame(name) or is_time(name)


def in_seconds(name: str, values: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Return times in seconds; None for a column of something else, or of an unknown unit.

    Where the name of the column states no unit, times are in seconds. Time stamps are in that of
    seconds, milliseconds, microseconds and nanoseconds in which their median step is a rate of
    motion capture, 2 to 1000 Hz; a warning says in which, or that it is none. Another warning
    says that times in seconds would be more than one apart, and in which unit they are usual.
    """
    match = _TIME.fullmatch(name.strip())
    unit = _SYMBOLS.get(match["unit"].lower()) if match else None
    if match is None or unit is None:
        return None
    if unit:
        return values * _SECONDS[unit]
    step = float(np.median(np.diff(values))) if len(values) > 1 else np.nan
    likely = next(
        (each for each, size in _SECONDS.items() if 1 / _FASTEST <= step * size <= 1 / _SLOWEST), ""
    )
    taken = likely if match["stamp"] else "s"
    if match["stamp"] or (likely not in ("", taken) and step > 1.0):
        warnings.warn(_assumed(name, taken, likely, step), stacklevel=4)
    return values * _SECONDS[taken] if taken else None


def _assumed(name: str, taken: str, likely: str, step: float) -> str:
    if not taken:
        return (
            f"the column {quoted(name)} states no unit, and steps of {step:g} are no usual rate "
            "in s, ms, us or ns: its times do not count"
        )
    text = (
        f"the column {quoted(name)} states no unit; {taken} is assumed, that is "
        f"{1 / (step * _SECONDS[taken]):.4g} frames per second"
    )
    return text if taken == likely else f"{text}; if it is in {likely}, name it '{name} ({likely})'"

"""The rate of a recording, and whether its frames are evenly spaced, by what a table says."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_DIGITS = 9


def is_number(said: str) -> bool:
    """Return whether a text says a number."""
    try:
        float(said.replace("_", "?").replace(",", "."))
    except ValueError:
        return False
    return True


def positive_number(said: str) -> float | None:
    """Return the number that a text says, or None if it says no positive, finite one."""
    try:
        number = float(said.replace("_", "?"))
    except ValueError:
        return None
    return number if 0 < number < float("inf") else None


def whole_steps(values: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Return how many usual steps each step is, or None if it is not close to a whole number.

    Parameters
    ----------
    values
        (N,) frame numbers or times; the usual step is the median one, of two the smaller.
    """
    steps = np.diff(values)
    usual = np.sort(steps)[(len(steps) - 1) // 2] if len(steps) else np.nan
    if not usual > 0:
        return None
    counts = np.rint(steps / usual)
    close = (np.abs(steps / usual - counts) <= 0.3) & (counts >= 1)
    return counts if close.all() else None


def rate_of_times(times: NDArray[np.float64]) -> float | None:
    """Return the rate of frames taken at these times in seconds, or None if they tell none.

    It is the number of steps over the time they last, so that times written with few digits do
    no harm, to as few digits as fit the times. Where steps are irregular, it is one over the
    median step.
    """
    steps = np.diff(times)
    usual = float(np.median(steps)) if len(steps) else np.nan
    if not 0 < usual < np.inf:
        return None
    counts = whole_steps(times)
    if counts is None:
        return float(f"{1.0 / usual:.{_DIGITS}g}")
    lasts = float(times[-1] - times[0])
    rate = float(counts.sum()) / lasts
    unsure = max(float(np.abs(steps - counts * lasts / counts.sum()).max()) / lasts, 10.0**-_DIGITS)
    rounded = (float(f"{rate:.{digits}g}") for digits in range(1, 17))
    return next((one for one in rounded if abs(one - rate) <= unsure * rate), rate)


def tell_irregular(name: str, values: NDArray[np.float64]) -> None:
    """Warn of steps of a column of frame numbers or times that are not as the others."""
    steps = np.diff(values)
    if not len(steps):
        return
    usual = np.median(steps)
    irregular = int(np.count_nonzero(~(np.abs(steps - usual) <= np.median(np.abs(steps)) / 2)))
    if irregular:
        warnings.warn(
            f"{irregular} of {len(steps)} steps of the column {name!r} are irregular: frames were "
            "dropped or repeated; the rows count as evenly spaced",
            stacklevel=4,
        )


def tell_skipped(name: str, numbers: NDArray[np.float64]) -> None:
    """Warn of frame numbers that do not go up by one."""
    uneven = int(np.count_nonzero(np.diff(numbers) != 1))
    if uneven:
        warnings.warn(
            f"{uneven} of {len(numbers) - 1} steps of {name} are not 1: frames were dropped or "
            "repeated; the rows count as evenly spaced",
            stacklevel=4,
        )


def tell_other_rate(times: NDArray[np.float64], rate: float, fact: str) -> None:
    """Warn of times that contradict the rate, which the file says under the name `fact`.

    Frames that were dropped do not.
    """
    counts = whole_steps(times)
    lasts, steps = times[-1] - times[0], len(times) - 1 if counts is None else counts.sum()
    # Times are often rounded to hundredths of a second.
    if abs(lasts - steps / rate) > 0.01 * (steps / rate + 1):
        warnings.warn(
            f"by the column Time the recording lasts {lasts:g} s, by {fact} {steps / rate:g} s; "
            f"{fact} counts",
            stacklevel=4,
        )


def tell_count(what: str, said: str, there: int) -> None:
    """Warn of a number in a file's header that is not what the file holds."""
    if said not in (str(there), f"{there}.0"):
        warnings.warn(
            f"the header says {said or 'no number of'} {what}, the file holds {there}; what it "
            "holds counts",
            stacklevel=4,
        )

"""A recording from what a table holds: numbers, labels, rate and unit."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import listed, quoted
from nodegraph_files.marker_names import unique_names
from nodegraph_files.missing import mark_missing
from nodegraph_files.rates import rate_from
from nodegraph_files.text.counters import in_seconds
from nodegraph_files.text.table import Table
from nodegraph_files.units import AUTO, MILLIMETRES, LengthUnit, unit_from, unit_named
from nodegraph_mocap.checks import possible_rate
from nodegraph_mocap.recording import Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray


_DIGITS = 9


def is_number(text: str) -> bool:
    """Return whether a text says a number."""
    try:
        float(text.replace("_", "?").replace(",", "."))
    except ValueError:
        return False
    return True


def positive_number(text: str) -> float | None:
    """Return the number that a text says, or None if it says no positive, finite one."""
    try:
        number = float(text.replace("_", "?"))
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
    """Return the rate of frames taken at these times in seconds, or None if they give none.

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
    return next(
        (candidate for candidate in rounded if abs(candidate - rate) <= unsure * rate), rate
    )


def warn_irregular(name: str, values: NDArray[np.float64]) -> None:
    """Warn of steps of a column of frame numbers or times that are not as the others."""
    steps = np.diff(values)
    if not len(steps):
        return
    usual = np.median(steps)
    irregular = int(np.count_nonzero(~(np.abs(steps - usual) <= np.median(np.abs(steps)) / 2)))
    if irregular:
        warnings.warn(
            f"{irregular} of {len(steps)} steps of the column {quoted(name)} are irregular: "
            "frames were dropped or repeated; the rows count as evenly spaced",
            stacklevel=4,
        )


def warn_skipped(name: str, numbers: NDArray[np.float64]) -> None:
    """Warn of frame numbers that do not go up by one."""
    uneven = int(np.count_nonzero(np.diff(numbers) != 1))
    if uneven:
        warnings.warn(
            f"{uneven} of {len(numbers) - 1} steps of {name} are not 1: frames were dropped or "
            "repeated; the rows count as evenly spaced",
            stacklevel=4,
        )


def warn_other_rate(times: NDArray[np.float64], rate: float, fact: str) -> None:
    """Warn of times that contradict the rate, which stands under the name `fact`.

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


def warn_count(what: str, stated: str, there: int) -> None:
    """Warn of a number in a file's header that is not what the file holds."""
    if stated not in (str(there), f"{there}.0"):
        warnings.warn(
            f"the header says {listed([stated or 'no number of'])} {what}, the file holds {there}; "
            "what it holds counts",
            stacklevel=4,
        )


def recording_of(
    coordinates: NDArray[np.float64],
    labels: Sequence[str],
    *,
    rate: float,
    unit: LengthUnit,
    zeros_missing: bool,
) -> Trajectories:
    """Return a recording of (T, 3 M) coordinates, which are x, y, z of each marker in turn.

    Parameters
    ----------
    coordinates
        In the table's unit of length.
    labels
        Labels of the markers, as the file gives them; see `unique_names`.
    rate
        Hz.
    unit
        The table's unit of length.
    zeros_missing
        Whether a sample at exactly (0, 0, 0) counts as missing.
    """
    count = coordinates.shape[1] // 3
    positions = np.array(coordinates, order="C").reshape(len(coordinates), count, 3)
    x, y, z = (coordinates[:, axis::3] for axis in range(3))
    empty = np.ascontiguousarray(np.isnan(x) & np.isnan(y) & np.isnan(z))
    markers = unique_names(labels, count)
    positions = mark_missing(positions, empty, markers, zeros_missing=zeros_missing)
    unit.convert(positions)
    return Trajectories(
        positions=positions,
        markers=markers,
        rate=rate,
    )


def unit_of_table(table: Table, setting: str, of_columns: str = "") -> LengthUnit:
    """Return the unit of length that the user sets, or a table states, or mm.

    Parameters
    ----------
    table
        A comment ``# unit: m`` in it states the unit.
    setting
        The user's, or "auto".
    of_columns
        The unit that the names of columns state, which counts before a comment's.

    Raises
    ------
    ValueError
        If the comment's unit is unknown, or another than that of the columns.
    """
    comment = table.comments.get("unit") or table.comments.get("units")
    if setting != AUTO or comment is None:
        return unit_from(setting, of_columns)
    name = unit_named(comment.value)
    if name is None or (of_columns and unit_named(of_columns) != name):
        known = f"there is {', '.join(MILLIMETRES)}"
        instead = f"the columns are in {quoted(of_columns)}" if name else known
        raise ValueError(f"{table.path}:{comment.line}: unit {quoted(comment.value)}; {instead}")
    return LengthUnit(name)


def stated_rate(table: Table) -> float | None:
    """Return the rate of a comment ``# rate: 60``, or None if there is none.

    Raises
    ------
    ValueError
        If it is not a positive number.
    """
    comment = table.comments.get("rate")
    if comment is None:
        return None
    rate = positive_number(comment.value)
    if rate is None:
        raise ValueError(
            f"{table.path}:{comment.line}: rate {quoted(comment.value)} is not a positive number"
        )
    return rate


def rate_of_header(setting: float | None, written: str, place: str, fact: str) -> float:
    """Return the rate that the user sets, or else what a header states under the name `fact`.

    Raises
    ------
    ValueError
        With the place, if neither is a positive number.
    """
    rate = rate_from(setting, positive_number(written))
    if rate is None:
        raise ValueError(
            f"{place}: {fact} must be a positive number of frames per second, the header says "
            f"{quoted(written) if written else 'none'}; set `rate` in Hz"
        )
    return _possible(rate, place)


def rate_of_counters(
    table: Table,
    counters: Sequence[tuple[str, NDArray[np.float64]]],
    setting: float | None,
) -> float:
    """Return the rate as `known_rate` does, by the first of some columns that holds times.

    Warnings count irregular steps of each, of frame numbers too.

    Parameters
    ----------
    table
    counters
        Name and numbers of each column of frame numbers or times.
    setting
        The user's rate, Hz.
    """
    times = None
    for name, values in counters:
        warn_irregular(name, values)
        times = in_seconds(name, values) if times is None else times
    return known_rate(table, times, setting)


def known_rate(
    table: Table, times: NDArray[np.float64] | None, setting: float | None = None
) -> float:
    """Return the rate that the user sets, or of a comment, or of a column of times in seconds.

    Raises
    ------
    ValueError
        If none of them states one.
    """
    stated = stated_rate(table)
    even = times is not None and whole_steps(times) is not None
    if stated is not None and times is not None and even:
        warn_other_rate(times, stated, "the line '# rate'")
    if stated is None and times is not None and (even or setting is None):
        stated = rate_of_times(times)
        if stated is not None and not even:
            warnings.warn(
                f"times are not whole steps apart; by the median step the rate is {stated:g} Hz, "
                "which `rate` or a line '# rate: 60' would say",
                stacklevel=4,
            )
    rate = rate_from(setting, stated)
    if rate is None:
        raise ValueError(
            f"{table.path}: no rate; set `rate` in Hz, or add a line '# rate: 60' above the head "
            "or a column 'time' in seconds"
        )
    return _possible(rate, str(table.path))


def _possible(rate: float, place: str) -> float:
    try:
        return possible_rate(rate)
    except ValueError as error:
        raise ValueError(f"{place}: {error}") from None

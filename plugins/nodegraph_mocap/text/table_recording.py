"""A recording from what a table holds: numbers, labels, rate and unit."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap.marker_names import unique_names
from nodegraph_mocap.recording import Trajectories
from nodegraph_mocap.samples_missing import mark_missing
from nodegraph_mocap.text.frame_times import (
    positive_number,
    rate_of_times,
    tell_other_rate,
    whole_steps,
)
from nodegraph_mocap.text.table_text import Table
from nodegraph_mocap.units import MILLIMETRES, millimetres_in

if TYPE_CHECKING:
    from numpy.typing import NDArray


def recording_of(
    coordinates: NDArray[np.float64],
    labels: Sequence[str],
    *,
    rate: float,
    millimetres: float,
    zeros_missing: bool,
) -> Trajectories:
    """Return a recording of (T, 3 M) coordinates, which are x, y, z of each marker in turn.

    Parameters
    ----------
    coordinates
        In the table's unit of length.
    labels
        Of the markers, as the file gives them; see `unique_names`.
    rate
        Hz.
    millimetres
        How many the table's unit of length is.
    zeros_missing
        Whether a sample at exactly (0, 0, 0) counts as missing.
    """
    count = coordinates.shape[1] // 3
    positions = np.array(coordinates, order="C").reshape(len(coordinates), count, 3)
    if millimetres != 1.0:
        positions *= millimetres
    x, y, z = (coordinates[:, axis::3] for axis in range(3))
    empty = np.ascontiguousarray(np.isnan(x) & np.isnan(y) & np.isnan(z))
    return Trajectories(
        positions=mark_missing(positions, empty, zeros_missing=zeros_missing),
        markers=unique_names(labels, count),
        rate=rate,
    )


def told_scale(table: Table) -> float:
    """Return how many millimetres the unit of a comment ``# unit: m`` is, by default 1.

    Raises
    ------
    ValueError
        If the unit is unknown.
    """
    told = table.comments.get("unit") or table.comments.get("units")
    if told is None:
        return 1.0
    factor = millimetres_in(told.value)
    if factor is None:
        raise ValueError(
            f"{table.path}:{told.line}: unit {told.value!r}; there is {', '.join(MILLIMETRES)}"
        )
    return factor


def told_rate(table: Table) -> float | None:
    """Return the rate of a comment ``# rate: 60``, or None if there is none.

    Raises
    ------
    ValueError
        If it is no positive number.
    """
    told = table.comments.get("rate")
    if told is None:
        return None
    rate = positive_number(told.value)
    if rate is None:
        raise ValueError(f"{table.path}:{told.line}: rate {told.value!r} is not a positive number")
    return rate


def known_rate(table: Table, times: NDArray[np.float64] | None) -> float:
    """Return the rate of a comment, or of a column of times in seconds.

    Raises
    ------
    ValueError
        If neither tells one.
    """
    rate = told_rate(table)
    even = times is not None and whole_steps(times) is not None
    if rate is not None and times is not None and even:
        tell_other_rate(times, rate, "the line '# rate'")
    if rate is None and times is not None:
        rate = rate_of_times(times)
        if rate is not None and not even:
            warnings.warn(
                f"times are no whole steps apart; by the median step the rate is {rate:g} Hz, "
                "a line '# rate: 60' would say it",
                stacklevel=4,
            )
    if rate is None:
        raise ValueError(
            f"{table.path}: no rate; add a line '# rate: 60' or a column 'time' in seconds"
        )
    return rate

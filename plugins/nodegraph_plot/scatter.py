"""One number against another, a point per row."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Across, Label, listed, node
from nodegraph_mocap import Figure, Table
from nodegraph_tables import info_of
from nodegraph_tables.style import looks

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray


@node("plot.scatter")
def scatter(
    scores: Across[Table], *, x: str, metric: str | None = None, compare: str | None = None
) -> Figure:
    """Draw a point per row of the gathered tables: a gap, a marker, a take.

    So one sees whether a method errs in a few bad gaps or a little in all, and what the error
    goes with: the length of the gap, the speed of the marker.

    Parameters
    ----------
    scores
        Tables with the columns that are drawn.
    x
        The column of numbers drawn to the right, or an axis whose labels are numbers.
    metric
        The column drawn upwards. Default: the first column of floats.
    compare
        The axis whose labels have a colour each. Default: the last gathered axis.

    Returns
    -------
    Figure
        An axis is logarithmic where all numbers are positive and the largest is more than 100
        times the smallest. Rows without a finite number are left out, with a warning.

    Raises
    ------
    ValueError
        If there is no such column or axis, or it holds no numbers; the message says what there
        is.
    """
    from nodegraph_plot.scatter_figure import draw

    if not len(scores):
        raise ValueError("there is no table to draw")
    across = scores.values()[0]
    upwards = metric or _first_float(across)
    by = compare or next(iter(reversed(tuple(scores.axes))), "")
    if by and by not in scores.axes:
        raise ValueError(f"no axis {by!r} is gathered; there are {_axis_labels(scores)}")
    points = {name: _points(scores, by, name, x, upwards) for name in _labels(scores, by)}
    _warn(points)
    units = {x: "", upwards: "", **info_of(across).units}
    finite = {name: values[np.isfinite(values).all(axis=1)] for name, values in points.items()}
    known = scores.labels(by) if by else ()
    return draw(finite, looks([*finite, *known]), _named(x, units), _named(upwards, units))


def _labels(scores: Across[Table], by: str) -> list[str]:
    return list(dict.fromkeys(str(labels.get(by, "")) for labels, _ in scores))


def _points(scores: Across[Table], by: str, name: str, x: str, y: str) -> NDArray[np.float64]:
    parts = [
        np.stack([_column(scores, table, labels, column) for column in (x, y)], axis=1)
        for labels, table in scores
        if str(labels.get(by, "")) == name
    ]
    return np.concatenate(parts)


def _column(
    scores: Across[Table], table: Table, labels: Mapping[str, Label], name: str
) -> NDArray[np.float64]:
    if name in scores.axes:
        label = labels.get(name, "")
        if isinstance(label, (int, float)):
            return np.full(len(table), float(label))
        raise ValueError(f"axis {name!r} has the label {label!r}, which is no number")
    _check_number(table, name, scores)
    return table[name].to_numpy(dtype=np.float64)


def _warn(points: dict[str, NDArray[np.float64]]) -> None:
    lost = {name: int((~np.isfinite(values)).any(axis=1).sum()) for name, values in points.items()}
    lines = [
        f"{name or 'scores'} {count} of {len(points[name])}"
        for name, count in lost.items()
        if count
    ]
    if lines:
        warnings.warn(f"rows without a number, left out: {', '.join(lines)}", stacklevel=3)


def _named(name: str, units: dict[str, str]) -> str:
    return f"{name} ({units[name]})" if units.get(name) else name


def _first_float(table: Table) -> str:
    """Return the name of the first column of floats.

    Raises
    ------
    ValueError
        If there is none.
    """
    for name, kind in table.dtypes.items():
        if kind.kind == "f":
            return str(name)
    raise ValueError(f"the table has no column of floats; it has {listed(table.columns)}")


def _check_number(table: Table, name: str, scores: Across[Table]) -> None:
    """Raise a ValueError if a table has no such column, or one that holds no numbers."""
    if name not in table:
        raise ValueError(
            f"no column or axis {name!r}; there are the columns {listed(table.columns)} "
            f"and the axes {_axis_labels(scores)}"
        )
    if table[name].dtype.kind not in "iufb":
        raise ValueError(f"column {name!r} holds no numbers")


def _axis_labels(scores: Across[Table]) -> str:
    """Return the gathered axes as text."""
    return ", ".join(scores.axes) or "none"

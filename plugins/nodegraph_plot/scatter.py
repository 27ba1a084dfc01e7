"""One number against another, a point per row."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Across, Label, listed, node
from nodegraph_mocap import Figure, Table, figure_text
from nodegraph_tables import info_of
from nodegraph_tables.axes import plain
from nodegraph_tables.style import looks, scale_of, unit_text

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from nodegraph_tables.style import Look

_MANY = 5000
"""Points from which on they are drawn as one picture, so that the file stays small."""
_WIDE = 100.0
_LETTERS = 24
"""Letters in a line of the legend."""


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
    scale = np.array([scale_of(units[x]), scale_of(units[upwards])])
    finite = {
        name: scale * values[np.isfinite(values).all(axis=1)] for name, values in points.items()
    }
    known = scores.labels(by) if by else ()
    return _draw(finite, looks([*finite, *known]), _named(x, units), _named(upwards, units))


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
        raise ValueError(f"axis {name!r} has the label {label!r}, which is not a number")
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
    return f"{name} ({unit_text(units[name])})" if units.get(name) else name


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


def _draw(
    points: dict[str, NDArray[np.float64]], look: dict[str, Look], right: str, up: str
) -> Figure:
    """Return the figure: the points of each label in its colour."""
    from matplotlib.figure import Figure as Drawing

    figure = Drawing(figsize=(7.0, 4.4), layout="constrained")
    axis = figure.subplots()
    many = sum(map(len, points.values())) > _MANY
    for name, values in points.items():
        axis.scatter(
            values[:, 0],
            values[:, 1],
            s=12,
            alpha=0.45 if many else 0.7,
            color=look[name].colour,
            marker=look[name].marker,
            linewidths=0,
            label=figure_text(name or up, across=_LETTERS, lines=2),
            rasterized=many,
        )
    together = np.concatenate(list(points.values()))
    axis.set(xlabel=figure_text(right), ylabel=figure_text(up))
    axis.set(xscale=_scale(together[:, 0]), yscale=_scale(together[:, 1]))
    plain(axis, grid="both")
    if len(points) > 1:
        figure.legend(loc="outside right upper", frameon=False)
    return figure


def _scale(values: NDArray[np.float64]) -> str:
    positive = len(values) and values.min() > 0
    return "log" if positive and values.max() > _WIDE * values.min() else "linear"

"""Which axis or column is what in a figure of curves: defaults filled in, every name checked."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from nodegraph import listed
from nodegraph_compare.curve_points import Axes
from nodegraph_compare.named import check_known, placed

if TYPE_CHECKING:
    from nodegraph import Across
    from nodegraph_mocap import Table

_MADE = ("low", "high", "blocks", "rows", "on curve", "local minimum", "floor", "below floor")


def axes_of(
    scores: Across[Table],
    *,
    x: str,
    metric: str | None,
    compare: str | None,
    blocks: tuple[str, ...],
    lowest: bool | None,
) -> Axes:
    """Return what is drawn.

    Parameters
    ----------
    scores
        The gathered tables.
    x
        Axis or column of numbers.
    metric
        Default: the first column of floats that is not `x`.
    compare
        Default: the last gathered axis that is not `x` or in `blocks`.
    blocks
        Axes, or columns, whose combinations are repeats.
    lowest
        Whether the curve takes the lowest of several points at one x. Default: where `x` is a
        column.

    Raises
    ------
    ValueError
        If there is no table, a name is unknown, used twice or one that the result's table needs,
        or `x` or the metric is no number.
    """
    if not len(scores):
        raise ValueError("there is no table to draw a curve of")
    free = [axis for axis in scores.axes if axis not in (x, *blocks)]
    compare = compare if compare is not None or not free else free[-1]
    metric = _first_number(scores, x) if metric is None else metric
    named = (x, metric, *filter(None, [compare]), *blocks)
    _check_once((*named, *(axis for axis in free if axis not in named)))
    for name in named:
        check_known(scores, name, what="metric" if name == metric else "axis or column")
    _check_x(scores, x)
    _check_numbers(scores, metric, "metric")
    others = tuple(axis for axis in free if axis != compare)
    apart = x not in scores.axes if lowest is None else lowest
    every = scores.labels(compare) if compare in scores.axes else ()
    return Axes(x, metric, compare, blocks, others, apart, every)


def check_floor(floor: Across[Table], axes: Axes) -> None:
    """Check that the floor can be drawn beside the curves.

    Raises
    ------
    ValueError
        If a table of it lacks the metric, or only some of them have the compared labels.
    """
    check_known(floor, axes.metric, what="metric")
    _check_numbers(floor, axes.metric, "metric of the floor")
    if axes.compare and any(axes.compare in table for table in floor.values()):
        check_known(floor, axes.compare)


def _first_number(scores: Across[Table], x: str) -> str:
    first = scores.values()[0]
    floats = [str(name) for name in first if first[name].dtype.kind == "f" and name != x]
    if not floats:
        raise ValueError(f"the tables have no column of floats; columns: {listed(first.columns)}")
    return floats[0]


def _check_once(named: tuple[str, ...]) -> None:
    twice = sorted({name for name in named if named.count(name) > 1})
    if twice:
        raise ValueError(f"x, metric, compare and blocks share a name: {', '.join(twice)}")
    taken = [name for name in named if name in (*_MADE, "marked")]
    if taken:
        raise ValueError(f"the table of the curve has a column {', '.join(taken)} of its own")


def _check_x(scores: Across[Table], x: str) -> None:
    if x not in scores.axes:
        _check_numbers(scores, x, "x")
        return
    labels = list(dict.fromkeys(at.get(x, "") for at, _ in scores))
    words = [str(label) for label in labels if not _is_number(label)]
    if words:
        raise ValueError(f"x {x!r} is no axis of finite numbers: it has {', '.join(words[:5])}")


def _check_numbers(scores: Across[Table], name: str, what: str) -> None:
    for where, table in placed(scores):
        if table[name].dtype.kind not in "iuf":
            numbers = [column for column in table if table[column].dtype.kind in "iuf"]
            raise ValueError(
                f"{what} {name!r} is no column of numbers{where}; there are: {listed(numbers)}"
            )


def _is_number(label: Any) -> bool:
    return isinstance(label, int | float) and type(label) is not bool and math.isfinite(label)

"""Curves of an error over a number, with their noise floor and their best place."""

from __future__ import annotations

import math
import warnings
from typing import TYPE_CHECKING, Annotated, NamedTuple

import numpy as np
from pydantic import Field

from nodegraph import Across, ColumnOf, Label, node
from nodegraph_compare.actors import clusters_of
from nodegraph_compare.blocks import columns_of
from nodegraph_compare.curve.answer import answer_of
from nodegraph_compare.curve.curves import Curves
from nodegraph_compare.curve.marks import Mark, marks
from nodegraph_compare.curve.notes import losses, notes
from nodegraph_compare.curve.points import Axes, floors, points
from nodegraph_compare.curve.scale import scale_of
from nodegraph_compare.question import (
    Clusters,
    Names,
    OneColumn,
    OneLabel,
    OneName,
    check_clusters,
    check_known,
    check_names,
    check_numbers,
    metric_of,
    unit_of,
)
from nodegraph_compare.recordings import recordings_of
from nodegraph_compare.ties import at_most
from nodegraph_compare.units import MOST_RECORDINGS
from nodegraph_compare.unused_axes import unused_axes
from nodegraph_mocap import Figure, Table
from nodegraph_tables import TableInfo, with_info

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from nodegraph_compare.curve.points import Points


_COLUMNS = ("low", "high", "blocks", "rows", "on curve", "local minimum", "floor", "below floor")


def _axes_of(
    scores: Across[Table],
    *,
    x: str,
    metric: str | None,
    compare: str | None,
    blocks: tuple[str, ...],
    clusters: tuple[str, ...],
    lowest: bool | None,
) -> Axes:
    """Return what is drawn, by the settings of the node, every name checked."""
    if not len(scores):
        raise ValueError("there is no table to draw a curve of")
    free = [axis for axis in scores.axes if axis not in (x, *blocks)]
    compare = compare if compare is not None or not free else free[-1]
    taken = (x, *filter(None, [compare]))
    apart = x not in scores.axes if lowest is None else lowest
    sources = tuple(axis for axis in scores.sources or () if axis not in taken)
    if clusters:
        check_clusters(scores, clusters, taken, sources)
    else:
        known = clusters_of(scores, sources)
        clusters = tuple(name for name in known if not (apart and name.partition(".")[0] in free))
    blocks = blocks or clusters
    metric = metric_of(scores, metric, but=x)
    named = (*taken, metric, *blocks)
    check_names(scores, named, "x, metric, compare and blocks")
    others = tuple(axis for axis in scores.axes if axis not in named)
    own = [name for name in (*named, *others) if name in (*_COLUMNS, "marked")]
    if own:
        raise ValueError(f"the table of the curve has a column {', '.join(own)} of its own")
    _check_x(scores, x)
    units = clusters
    if len(np.unique(columns_of(scores, clusters).combined())) <= MOST_RECORDINGS:
        units = tuple(name for name in blocks if name in scores.axes and name not in clusters)
    return Axes(x, metric, compare, blocks, clusters, units, others, apart)


def _check_floor(floor: Across[Table], axes: Axes) -> None:
    """Check that all tables of the floor have the metric, and all or none the compared labels."""
    check_numbers(floor, axes.metric, "metric of the floor")
    if axes.compare and any(axes.compare in table for table in floor.values()):
        check_known(floor, axes.compare)


def _check_x(scores: Across[Table], x: str) -> None:
    if x not in scores.axes:
        check_numbers(scores, x, "x")
        return
    labels = list(dict.fromkeys(at.get(x, "") for at, _ in scores))
    words = [str(label) for label in labels if not _is_number(label)]
    if words:
        raise ValueError(f"x {x!r} is not an axis of finite numbers: it has {', '.join(words[:5])}")


def _is_number(label: object) -> bool:
    return isinstance(label, int | float) and type(label) is not bool and math.isfinite(label)


class Curve(NamedTuple):
    """Curves: their numbers and their picture."""

    table: Table
    figure: Figure


@node("compare.curve", cite=("satopaa2011finding",))
def curve(
    scores: Across[Table],
    floor: Across[Table] | None = None,
    *,
    x: Annotated[str, ColumnOf("scores", or_axis=True)],
    metric: OneColumn = None,
    compare: OneName = None,
    blocks: Names = (),
    clusters: Clusters = (),
    lowest: bool | None = None,
    fallback: OneLabel = None,
    mark: Mark = "none",
    tolerance: Annotated[float, Field(ge=0)] = 2.0,
) -> Curve:
    """Draw an error over a number, a curve per label, and mark where few is enough.

    As figure 2 of the marker study draws blendshape-weight errors over the number of selected
    markers: a curve per actor, and a circle around a minimum that all of them share. Lower
    is better. An interior local minimum is a point of the curve lower than the one before and
    the one after; the ends are none. Of neighbouring points with one value the first counts.

    The knee of a curve is the point farthest below the straight line through its first and last
    point, ``argmax_i (y_1 + (y_n - y_1) (x_i - x_1) / (x_n - x_1) - y_i)``, the first of equals,
    with y the error as the figure shows it: its logarithm where the scale is logarithmic; an error
    below the noise floor counts as the floor. A curve that is nowhere below that line, or has
    fewer than three points, has none.

    What differs by rounding alone is equal: of a label's values that are at most 1e-9 of their
    size apart (of a thousandth of the largest at least) all stand as the first; one as far above
    the noise floor is level with it.

    Parameters
    ----------
    scores
        Tables, with a row per unit or a row in all.
    floor
        Tables of the same metric, by the same compared labels, with what measurement noise alone
        does: shaded up to the mean of each label's rows. One floor for all where it has no
        labels.
    x
        Axis or column of numbers.
    metric
        The column of numbers along y. Default: the first column of floats that is not `x`.
    compare
        The axis, or column, with a curve per label. Default: the last gathered axis that is not
        `x` or in `blocks`.
    blocks
        Axes, or columns, whose combinations are repeats, such as trials. The rows of a block are
        averaged, then the blocks of a cluster, then the clusters, geometrically where all numbers
        are positive. A block that has a row without a
        finite number is left out and counted. Default: `clusters`, if there are any.
    clusters
        Axes, or columns, whose combinations are the independent units, such as actors: three or
        more give a 95 % interval (Student's, of the logarithms of positive means). Of one or two,
        the units are repetitions, the axes of `blocks` along which the same data
        are treated again, and the interval is for further ones; other blocks of one recording
        have none. Default: the axes along which the data differ, but for `x`, `compare`, and
        those that distinguish points.
    lowest
        Whether the curve takes the lowest of several points at one x, while all are drawn. A
        point is a combination of the axes that are neither `x` nor compared nor in `blocks`; with
        no blocks, a row. Otherwise it takes their mean. Default: true where `x` is a column, as
        where several searches choose one number of markers; false where it is an axis.
    fallback
        A label of `compare`, whose value stands where another curve has none in a block at the
        same `x`, as where a method refuses; counted in the notes. Needs `blocks`.
    mark
        ``shared``: the smallest minimum that every curve has one within `tolerance` of, by a
        circle around each curve's nearest; where there is none the title states that, and a
        square marks each curve's knee. ``minimum``: each curve's lowest interior minimum,
        its knee where it has none. A number: an error that is small enough, by a circle around
        the point of each curve from which on none is larger. A label without any number is
        disregarded.
    tolerance
        How far apart minima may lie and still be shared, in units of `x`.

    Returns
    -------
    table
        A row per point, in the order of the labels and of `x`: the compared label, the other
        axes of a point, `x`, the metric; with blocks, ``low``, ``high`` and ``blocks``, else
        ``rows``; ``on curve``; ``local minimum``; with a floor, ``floor`` (NaN where there is
        none for a label) and ``below floor`` (at or below it); ``marked`` (``shared``,
        ``minimum``, ``knee``, ``enough`` or empty). Its answer states what is marked and what the
        noise floor reaches, its notes what was left out.
    figure
        A panel per curve, at most 24, with the others in grey. Logarithmic along y where no error
        is negative and they span more than a factor of 30, those below a millionth of the largest
        left aside; these stand on the lower edge.

    Raises
    ------
    ValueError
        If a name is neither axis nor column, is used twice, or `x` or the metric holds no
        numbers; the message lists what there is. If there is a fallback, and nothing is compared
        or there are no blocks.

    References
    ----------
    Satopää, Albrecht, Irwin and Raghavan, "Finding a 'Kneedle' in a haystack: detecting knee
    points in system behavior", ICDCS workshops 2011.
    """
    from nodegraph_compare.curve.figure import draw

    axes = _axes_of(
        scores,
        x=x,
        metric=metric,
        compare=compare,
        blocks=blocks,
        clusters=clusters,
        lowest=lowest,
    )
    curve_points = points(scores, axes, fallback)
    level = None
    if floor is not None:
        _check_floor(floor, axes)
        level = _levels(floors(floor, axes), curve_points)
    scale = scale_of(curve_points, level)
    unit = unit_of(scores, axes.metric)
    curves = Curves(
        axes=axes,
        points=curve_points,
        marked=marks(curve_points, mark, tolerance, level, scale),
        floors=level,
        scale=scale,
        mark=mark,
        tolerance=tolerance,
        unit=unit,
        recordings=recordings_of(scores),
    )
    frame = _frame(curves)
    valued = (axes.metric, "low", "high", "floor")
    info = TableInfo(
        title=f"{axes.metric} over {axes.x}" + (f" by {axes.compare}" if axes.compare else ""),
        answer=answer_of(curves),
        notes=(
            *notes(curves),
            *losses(scores, curves, skipped=True),
            *unused_axes(scores, axes.compare).values(),
        ),
        units={name: unit for name in valued if unit and name in frame},
    )
    lost = losses(scores, curves, skipped=False)
    if lost:
        warnings.warn("; ".join(lost), stacklevel=2)
    return Curve(with_info(frame, info), draw(curves))


def _levels(known: Mapping[Label, float], curves: Sequence[Points]) -> dict[Label, float]:
    """Return the floor under each label; NaN where there is none."""
    common = known.get("", np.nan) if set(known) == {""} else np.nan
    return {curve_points.label: known.get(curve_points.label, common) for curve_points in curves}


def _frame(curves: Curves) -> Table:
    from pandas import DataFrame, concat

    parts = [DataFrame(_columns(curves, each)) for each in curves.points]
    frame = concat([part for part in parts if len(part)] or parts[:1], ignore_index=True)
    whole = bool((frame[curves.axes.x] % 1 == 0).all())
    return frame.astype({curves.axes.x: np.int64}) if whole else frame


def _columns(curves: Curves, curve_points: Points) -> dict[str, object]:
    axes, marked = curves.axes, curves.marked
    place = np.arange(len(curve_points.x))
    columns: dict[str, object] = {
        name: [curve_points.label] * len(place) for name in _compared(axes)
    }
    apart = axes.others if axes.lowest else ()
    columns |= {name: [other[name] for other in curve_points.others] for name in apart}
    columns |= {axes.x: curve_points.x, axes.metric: curve_points.value}
    if axes.blocks:
        columns |= {"low": curve_points.low, "high": curve_points.high}
    columns["blocks" if axes.blocks else "rows"] = curve_points.count
    columns["on curve"] = np.isin(place, curve_points.curve)
    columns["local minimum"] = np.isin(place, marked.minima[curve_points.label])
    if curves.floors is not None:
        columns["floor"] = curves.floor(curve_points)
        columns["below floor"] = at_most(curve_points.value, curves.floor(curve_points))
    kind = marked.kinds.get(curve_points.label, "")
    marked_place = marked.places.get(curve_points.label)
    columns["marked"] = [kind if at == marked_place else "" for at in place]
    return columns


def _compared(axes: Axes) -> Iterable[str]:
    return () if axes.compare is None else (axes.compare,)

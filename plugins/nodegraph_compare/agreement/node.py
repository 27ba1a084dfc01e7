"""Bland and Altman's comparison of methods: bias and limits of agreement."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nodegraph import Across, node
from nodegraph_compare.agreement.limits import Pair, pairs_of
from nodegraph_compare.comparison import prepare
from nodegraph_compare.inference import CONFIDENCE
from nodegraph_compare.left_out import block_text, group_text, left_out, start_text
from nodegraph_compare.question import (
    Clusters,
    Names,
    OneColumn,
    OneLabel,
    OneName,
    Question,
)
from nodegraph_mocap import Figure, Table, figure_text
from nodegraph_tables import TableInfo, with_info
from nodegraph_tables.axes import plain
from nodegraph_tables.style import BEST, BLACK, REST, STANDS_OUT, scale_of, unit_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from nodegraph_compare.agreement.limits import Interval

_MOST_PANELS = 12
_PER_ROW = 3
_MOST_LISTED = 12


class Agreed(NamedTuple):
    """How far methods agree: the numbers and their picture."""

    table: Table
    figure: Figure


@node("compare.agreement", cite=("bland1986statistical", "bland1999measuring", "carkeet2015exact"))
def agreement(
    scores: Across[Table],
    *,
    metric: OneColumn = None,
    compare: OneName = None,
    within: Names = (),
    blocks: Names = (),
    clusters: Clusters = (),
    baseline: OneLabel = None,
) -> Agreed:
    """How far two methods give the same numbers: bias and limits of agreement.

    For each pair of labels, over the blocks in which both have a number, with d the first's value
    minus the second's: the bias ``mean(d)`` and the limits ``bias -+ 1.96 sd(d)``, between which
    95 % of normal differences lie (Bland & Altman 1986), each with its 95 % interval: of the bias
    Student's, of the limits the exact one for normal differences (Carkeet 2015). The slope of d
    on the mean of the two values shows whether the difference grows with the value; where it
    does, the limits hold for no value in particular. A pair's blocks do not depend on other
    labels; blocks that a label lacks are counted in a warning.

    What differs by rounding alone is equal: of values in a block that are at most 1e-9 of their
    size apart all stand as the first, and of differences, as measured by the values.

    Parameters
    ----------
    scores
        Tables, a row per unit (a gap, a marker, a take).
    metric
        The column of numbers to compare. Default: the first column of floats.
    compare
        The axis, or column, whose labels are compared. Default: the last gathered axis that is
        not in `within` or `blocks`.
    within
        Axes, or columns: each combination of their labels is compared by itself.
    blocks
        Axes, or columns, whose combinations are the paired blocks. Default: every gathered axis
        that is not compared or in `within`, and the first column of the tables where it
        identifies the unit of a row.
    clusters
        Axes, or columns, whose combinations are the independent units. Over three or more, the
        bias is the mean of their means, the limits are those of a single block, and intervals
        are those of that many pairs; within one or two recordings, blocks are taken as independent.
        Default: the axes along which the data differ, but for those in `compare` and `within`.
    baseline
        A label of `compare`: only pairs with it, as the second. Default: each pair of labels.

    Returns
    -------
    table
        A row per pair: ``blocks`` that both have, ``bias``, ``sd``, ``lower`` and ``upper`` limit
        and ``slope``, each but sd with the ``low`` and ``high`` end of its interval (NaN with
        fewer than two blocks, for the slope with fewer than three or where all means are equal).
    figure
        Differences over means, with bias, limits and their intervals; at most 12 pairs.

    Raises
    ------
    ValueError
        If a name is neither axis nor column or is used twice, the metric holds no numbers, or
        the baseline is not among the compared labels.
    """
    comparison = prepare(
        scores, metric=metric, compare=compare, within=within, blocks=blocks, clusters=clusters
    )
    question, gathered, unit = comparison.question, comparison.groups, comparison.unit
    against = comparison.baseline(baseline)
    pairs = [pair for group in gathered for pair in pairs_of(group, against)]
    notes = (
        block_text(question),
        f"Differences are first minus second. lower, upper: limits of agreement, bias -+ 1.96 sd. "
        f"low, high: {100 * CONFIDENCE:.0f} % intervals, exact for normal differences.",
        *left_out(scores, question, gathered, pairwise=True),
    )
    return Agreed(_table(pairs, question, unit, notes), _draw(question, pairs, unit))


def _table(pairs: Sequence[Pair], question: Question, unit: str, notes: tuple[str, ...]) -> Table:
    from pandas import DataFrame

    frame = DataFrame([_row(pair, question) for pair in pairs])
    valued = ("bias", "sd", "lower", "upper")
    by = f" by {question.compare}" if question.compare else ""
    info = TableInfo(
        title=f"Agreement of {question.metric}{by}",
        answer=tuple(_answers(pairs, question, unit)),
        notes=notes,
        units={name: unit for name in frame.columns if unit and name.split(" ")[0] in valued},
    )
    return with_info(frame, info)


def _row(pair: Pair, question: Question) -> dict[str, object]:
    limits = pair.limits
    row: dict[str, object] = dict(zip(question.within, pair.group.labels, strict=True))
    row |= {"first": pair.first, "second": pair.second, "blocks": len(limits.difference)}
    row |= {"bias": limits.bias, "bias low": limits.of_bias[0], "bias high": limits.of_bias[1]}
    row |= {"sd": limits.sd}
    for name in ("lower", "upper", "slope"):
        low, high = getattr(limits, f"of_{name}")
        row |= {name: getattr(limits, name), f"{name} low": low, f"{name} high": high}
    return row


def _answers(pairs: Sequence[Pair], question: Question, unit: str) -> list[str]:
    if not pairs:
        return ["there are no two labels to compare."]
    sentences = [_answer(pair, question, unit) for pair in pairs[:_MOST_LISTED]]
    more = len(pairs) - len(sentences)
    return sentences + ([f"{more} more pairs are in the table."] if more else [])


def _answer(pair: Pair, question: Question, unit: str) -> str:
    limits, start = pair.limits, start_text(group_text(pair.group, question))
    names, count = f"{pair.first} and {pair.second}", len(limits.difference)
    if count < 2:
        return (
            f"{start}{names} share {count or 'no'} block{'s' * (not count)}; nothing can be said."
        )
    low, high = limits.of_bias
    side = "above" if low > 0 else "below" if high < 0 else "not clearly above or below"
    in_unit = f" {unit_text(unit)}" if unit else ""
    scale = scale_of(unit)
    bias, lower, upper, first, last = (
        f"{scale * value:.3g}" for value in (limits.bias, limits.lower, limits.upper, low, high)
    )
    slope = (
        "; the difference changes with the value"
        if limits.of_slope[0] > 0 or limits.of_slope[1] < 0
        else ""
    )
    return (
        f"{start}{pair.first} is {side} {pair.second} on average (bias {bias}{in_unit}, "
        f"interval {first} to {last}); 95 % of differences are expected between "
        f"{lower} and {upper}{in_unit} ({count} blocks){slope}."
    )


def _draw(question: Question, pairs: Sequence[Pair], unit: str) -> Figure:
    """Return a panel per pair that shares a block, at most 12 of them.

    Parameters
    ----------
    question, pairs
        Of the comparison.
    unit
        Of the metric.
    """
    from matplotlib.figure import Figure as Drawing

    from nodegraph_compare.pictures import without_drawing

    known = [pair for pair in pairs if len(pair.limits.difference)]
    drawn = known[:_MOST_PANELS]
    if not drawn:
        return without_drawing("no two labels share a block")
    columns = min(len(drawn), _PER_ROW)
    rows = math.ceil(len(drawn) / columns)
    size = (max(3.4 * columns, 5.2), 2.9 * rows + 0.3)
    figure = Drawing(figsize=size, layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False).ravel()
    for axis in axes[len(drawn) :]:
        axis.remove()
    for axis, pair in zip(axes, drawn, strict=False):
        _panel(axis, pair, scale_of(unit))
        place = group_text(pair.group, question)
        name = f"{figure_text(pair.first)} \N{MINUS SIGN} {figure_text(pair.second)}"
        axis.set_title(f"{figure_text(place)}\n{name}" if place else name, fontsize=9)
    in_unit = f" ({unit_text(unit)})" if unit else ""
    figure.supxlabel(figure_text(f"mean {question.metric} of the two{in_unit}"), fontsize=10)
    figure.supylabel(figure_text(f"difference{in_unit}"), fontsize=10)
    if len(known) > len(drawn):
        figure.suptitle(f"{len(known) - len(drawn)} more pairs are not drawn", fontsize=8)
    return figure


def _panel(axis: Axes, pair: Pair, scale: float) -> None:
    limits = pair.limits
    axis.axhline(0.0, color=REST, linewidth=0.8)
    axis.scatter(limits.middle, limits.difference, s=14, color=REST, linewidths=0, alpha=0.8)
    _line(axis, limits.bias, limits.of_bias, BEST, "-", f"bias {scale * limits.bias:.3g}")
    lower, upper = (f"{scale * limit:.3g}" for limit in (limits.lower, limits.upper))
    _line(axis, limits.lower, limits.of_lower, STANDS_OUT, "--", f"lower limit {lower}")
    _line(axis, limits.upper, limits.of_upper, STANDS_OUT, "--", f"upper limit {upper}")
    for part in (axis.xaxis, axis.yaxis) if scale != 1.0 else ():
        part.set_major_formatter(lambda value, _: f"{scale * value:g}")
    if limits.of_slope[0] > 0.0 or limits.of_slope[1] < 0.0:
        ends = np.array([limits.middle.min(), limits.middle.max()])
        heights = limits.bias + limits.slope * (ends - limits.middle.mean())
        axis.plot(ends, heights, color=BLACK, linewidth=1)
    plain(axis)


def _line(axis: Axes, height: float, interval: Interval, colour: str, line: str, text: str) -> None:
    if not math.isfinite(height):
        return
    axis.axhline(height, color=colour, linestyle=line, linewidth=1.2)
    if math.isfinite(interval[0]):
        axis.axhspan(*interval, color=colour, alpha=0.15, linewidth=0)
    axis.annotate(
        text, (1.0, height), xycoords=axis.get_yaxis_transform(),
        xytext=(0, 2), textcoords="offset points", ha="right", va="bottom", fontsize=8,
        color=colour,
    )  # fmt: skip

"""The table of a comparison and its figure."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

from pydantic import Field

from nodegraph import Across, Label, node
from nodegraph_compare.answer import absences, answer, dropped, notes, shortened
from nodegraph_compare.blocks import groups
from nodegraph_compare.labels import label_order
from nodegraph_compare.question import Question, ask
from nodegraph_compare.summary import Summary, differences, summarise
from nodegraph_mocap import Figure, Table

if TYPE_CHECKING:
    from collections.abc import Sequence


class Compared(NamedTuple):
    """A comparison: its numbers and its picture."""

    table: Table
    figure: Figure


@node(
    "compare.table",
    cite=("efron1979bootstrap", "wilcoxon1945individual", "holm1979simple"),
)
def table(
    scores: Across[Table],
    *,
    metric: str | None = None,
    compare: str | None = None,
    within: tuple[str, ...] = (),
    blocks: tuple[str, ...] = (),
    baseline: str | None = None,
    seed: Annotated[int, Field(ge=0)] = 0,
) -> Compared:
    """Compare methods by one number, over paired blocks; lower is better.

    Every row of the gathered tables carries the labels of its combination. The unit of statistics
    is the block: the rows of a block are averaged first (for the metric ``rmse``, the result is
    the mean over blocks of the rows' rmse, not the rmse over all samples). A block in which a
    method has a row without a finite number counts as lacking for that method. Statistics are
    paired: within a group, only blocks that every method has are used; the others are dropped,
    counted and told in a warning. A method without any number in a group does not take part in
    it. An axis hides a column of the same name.

    Parameters
    ----------
    scores
        Tables, a row per unit (a gap, a marker, a take).
    metric
        The column of numbers to compare. Default: the first column of floats; columns of whole
        numbers, such as indices and lengths, are never taken by default.
    compare
        The axis, or column, whose labels are compared. Default: the last gathered axis that is
        not in `within` or `blocks`.
    within
        Axes, or columns: each combination of their labels is compared by itself.
    blocks
        Axes, or columns, whose combinations are the paired blocks. Default: every gathered axis
        that is not compared or in `within`, and the first column of the tables where it says
        which unit a row is, that is, where it holds no floats and is not called ``frame``.
        An axis named nowhere is averaged over within each block.
    baseline
        A label of `compare`: adds paired differences to it.
    seed
        Of the bootstrap.

    Returns
    -------
    table
        A row per combination of `within` and `compare`, in the order of the labels: ``blocks``
        used, ``mean``, ``rms`` (root mean square: for the metric ``rmse`` and gaps of one length,
        the rmse over all samples), ``median`` and ``sd`` over blocks, ``low`` and ``high`` (95 %
        bootstrap percentile interval of the mean, 2000 resamples), ``refused`` (share of the
        combinations that were refused or failed), ``left missing`` (share of the rows without a
        number).
        With a baseline: ``difference`` (mean of method minus baseline), ``difference low`` and
        ``difference high`` (its paired bootstrap interval), ``p`` (two-sided Wilcoxon
        signed-rank test, after Holm's correction over the methods of the group) and
        ``better in`` (share of blocks in which the method is strictly lower). ``sd`` and
        intervals are NaN with fewer than two blocks. ``attrs["answer"]`` holds a sentence per
        group, ``attrs["notes"]`` what was left out.
    figure
        Means and intervals.

    Raises
    ------
    ValueError
        If a name is neither axis nor column, the metric holds no numbers, or the baseline is not
        among the compared labels; the message lists what there is.
    """
    question = ask(scores, metric=metric, compare=compare, within=within, blocks=blocks)
    found = [summarise(group, seed=seed) for group in groups(scores, question)]
    order = _methods(scores, question, found)
    against = _baseline(order, baseline)
    unit = str(scores.values()[0].attrs.get("units", {}).get(question.metric, ""))
    _warn(scores, question, found)
    return Compared(
        _frame(scores, question, found, against, unit, seed), _draw(question, found, order, unit)
    )


def _frame(
    scores: Across[Table],
    question: Question,
    found: list[Summary],
    against: Label | None,
    unit: str,
    seed: int,
) -> Table:
    from pandas import DataFrame, concat

    parts = [DataFrame(_rows(one, question, against)) for one in found]
    made = concat(parts, ignore_index=True) if parts else DataFrame()
    told = [text for text in (dropped(one, question) for one in found) if text]
    made.attrs["title"] = _title(question)
    made.attrs["notes"] = notes(question, seed) + told + absences(scores.absent, question)
    made.attrs["answer"] = [answer(one, question, unit) for one in found]
    made.attrs["units"] = _units(made, unit)
    return made


def _rows(summary: Summary, question: Question, against: Label | None) -> dict[str, Any]:
    """Return the columns of a group's rows."""
    group = summary.group
    methods = range(len(group.methods))
    columns: dict[str, Any] = {
        name: [label for _ in methods]
        for name, label in zip(question.within, group.labels, strict=True)
    }
    columns |= {name: list(group.methods) for name in question.compared}
    columns["blocks"] = summary.blocks
    for name in ("mean", "rms", "median", "sd", "low", "high"):
        columns[name] = getattr(summary, name)
    columns["refused"] = group.refused
    columns["left missing"] = group.missing
    return columns if against is None else columns | _difference_columns(summary, against)


def _difference_columns(summary: Summary, against: Label) -> dict[str, Any]:
    import numpy as np

    names = ("difference", "difference low", "difference high", "p", "better in")
    if against not in summary.group.methods:
        return dict.fromkeys(names, np.nan)
    paired = differences(summary, summary.group.methods.index(against))
    return dict(
        zip(names, (paired.mean, paired.low, paired.high, paired.p, paired.better), strict=True)
    )


def _units(made: Table, unit: str) -> dict[str, str]:
    valued = ("mean", "rms", "median", "sd", "low", "high", "difference")
    shares = ("refused", "left missing", "better in")
    units = {str(name): unit for name in made if unit and str(name).startswith(valued)}
    return units | {name: "share" for name in shares if name in made}


def _title(question: Question) -> str:
    by = f" by {question.compare}" if question.compare else ""
    within = f" within {', '.join(question.within)}" if question.within else ""
    return f"{question.metric}{by}{within}"


def _methods(
    scores: Across[Table], question: Question, found: Sequence[Summary]
) -> tuple[Label, ...]:
    """Return all compared labels, in their order."""
    if question.compare in scores.axes:
        return label_order(scores, question.compare)
    return tuple(dict.fromkeys(label for one in found for label in one.group.methods))


def _baseline(order: tuple[Label, ...], baseline: str | None) -> Label | None:
    if baseline is None:
        return None
    for label in order:
        if str(label) == baseline:
            return label
    raise ValueError(f"no baseline {baseline!r}; compared are: {', '.join(map(str, order))}")


def _warn(scores: Across[Table], question: Question, found: Sequence[Summary]) -> None:
    told = [text for text in (dropped(one, question) for one in found) if text]
    told += absences((one for one in scores.absent if one.kind != "skipped"), question)
    if not found:
        told.append("the tables have no rows")
    if told:
        warnings.warn(shortened(told), stacklevel=3)


def _draw(
    question: Question, found: Sequence[Summary], order: tuple[Label, ...], unit: str
) -> Figure:
    from nodegraph_compare.figure import draw

    return draw(question, found, order, unit)

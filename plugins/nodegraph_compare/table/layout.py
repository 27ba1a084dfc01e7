"""The table in rows and columns, as a paper prints it: a mean and its interval in each cell."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from nodegraph_tables import TableInfo, with_info

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from nodegraph import Across, Label
    from nodegraph_compare.question import Question
    from nodegraph_compare.table.summary import Summary
    from nodegraph_mocap import Table
    from nodegraph_tables.info import Part


Labels = tuple["Label", ...]


class _Cell(NamedTuple):
    """What stands in one place of the table."""

    mean: float
    low: float
    high: float
    p: float
    blocks: int
    best: bool


_NOTHING = _Cell(np.nan, np.nan, np.nan, np.nan, 0, False)


def wide_table(
    summaries: Sequence[Summary],
    question: Question,
    layout: Layout,
    order: Sequence[Label],
    parts: Sequence[Part],
) -> Table:
    """Return the means in rows and columns.

    What is wanted beside the mean stands in columns of its own, which a reader sees in one cell.
    The best mean of each group is marked.

    Parameters
    ----------
    summaries, question
        Of the comparison.
    layout
        What stands down the side, and along the top.
    order
        The compared labels as the graph lists them.
    parts
        What is wanted beside the mean: ``low``, ``high`` and ``p``, that of its difference to the
        baseline.
    """
    from pandas import DataFrame

    cells = {
        (_picked(at, layout.rows), _picked(at, layout.columns)): cell
        for summary in summaries
        for at, cell in _cells(summary, question)
    }
    place = _order(summaries, question, order)
    rows = sorted({row for row, _ in cells}, key=place(layout.rows))
    tops = sorted({top for _, top in cells}, key=place(layout.columns))
    stacked = [[cells.get((row, top), _NOTHING) for row in rows] for top in tops]
    columns = _side(rows, layout)
    if set(question.within).issubset(layout.rows):
        columns["blocks"] = [max(cell.blocks for cell in row) for row in zip(*stacked, strict=True)]
    under = dict(zip(_heads(tops, layout.columns, taken=columns), stacked, strict=True))
    for head, column in under.items():
        columns |= _beneath(head, column, parts)
    info = TableInfo(
        labels=layout.rows,
        cells={head: {part: f"{head} {part}" for part in parts} for head in under},
        best={
            head: tuple(at for at, cell in enumerate(column) if cell.best)
            for head, column in under.items()
        },
    )
    return with_info(DataFrame(columns), info)


def _side(rows: Sequence[Labels], layout: Layout) -> dict[str, Sequence[Any]]:
    """Return the columns of labels down the side."""
    return {name: [row[at] for row in rows] for at, name in enumerate(layout.rows)}


def _beneath(head: str, column: Sequence[_Cell], parts: Sequence[str]) -> dict[str, list[float]]:
    """Return the columns of numbers under one head: the means, then what is wanted beside them."""
    beside = {f"{head} {part}": [getattr(cell, part) for cell in column] for part in parts}
    return {head: [cell.mean for cell in column]} | beside


def blocks_text(summaries: Sequence[Summary]) -> str:
    """Return over how many blocks the means of a table are."""
    counts = sorted({int(summary.blocks.max(initial=0)) for summary in summaries})
    if len(counts) == 1:
        return f"Every mean is over {counts[0]} blocks."
    return f"The means are over {counts[0]} to {counts[-1]} blocks." if counts else ""


def _cells(summary: Summary, question: Question) -> Iterable[tuple[Mapping[str, Label], _Cell]]:
    at = dict(zip(question.within, summary.group.labels, strict=True))
    paired, bests, blocks = summary.paired, summary.marked, summary.blocks
    for place, method in enumerate(summary.group.methods):
        names = dict.fromkeys(question.compared, method)
        p = np.nan if paired is None else float(paired.p[place])
        numbers = (summary.mean, summary.low, summary.high)
        mean, low, high = (float(number[place]) for number in numbers)
        yield at | names, _Cell(mean, low, high, p, int(blocks[place]), bool(bests[place]))


def _picked(at: Mapping[str, Label], names: Sequence[str]) -> Labels:
    return tuple(at[name] for name in names)


def _order(
    summaries: Sequence[Summary], question: Question, order: Sequence[Label]
) -> Callable[[Sequence[str]], Callable[[Labels], tuple[int, ...]]]:
    """Return what gives the places of labels in the order in which the graph lists them."""
    listed: dict[str, Sequence[Label]] = dict.fromkeys(question.compared, order)
    for at, name in enumerate(question.within):
        listed[name] = tuple(dict.fromkeys(summary.group.labels[at] for summary in summaries))
    places = {
        name: {label: at for at, label in enumerate(labels)} for name, labels in listed.items()
    }

    def key_of(names: Sequence[str]) -> Callable[[Labels], tuple[int, ...]]:
        return lambda labels: tuple(
            places[name][label] for name, label in zip(names, labels, strict=True)
        )

    return key_of


def _heads(tops: Sequence[Labels], names: Sequence[str], taken: Iterable[str]) -> list[str]:
    """Return a name for each column: its labels, with what they are where the labels are bare."""
    bare = [
        ", ".join(
            label if isinstance(label, str) else f"{name} {label}"
            for name, label in zip(names, labels, strict=True)
        )
        for labels in tops
    ]
    parts = {f"{head} {part}" for head in bare for part in ("low", "high", "p")}
    if len({*bare, *parts, *taken}) == len(bare) + len(parts) + len(list(taken)):
        return bare
    return [
        ", ".join(f"{name} {label!r}" for name, label in zip(names, labels, strict=True))
        for labels in tops
    ]


Names = tuple[str, ...]


@dataclass(frozen=True)
class Layout:
    """Names that stand down the side, and along the top; without the latter, a row per mean."""

    rows: Names
    columns: Names


def implied(
    scores: Across[Table], compare: str | None, within: Names, layout: Layout, blocks: Names
) -> tuple[str | None, Names]:
    """Return what is compared, and within what, as the layout implies.

    Every name laid out is compared or in `within`; without `compare`, the
    last gathered axis among them.

    Parameters
    ----------
    scores
        The gathered tables.
    compare, within, blocks
        As the user gave them.
    layout
        Which names stand down the side, and along the top.

    Raises
    ------
    ValueError
        If a name is laid out twice.
    """
    named = (*layout.rows, *layout.columns)
    repeated = sorted({name for name in named if named.count(name) > 1})
    if repeated:
        raise ValueError(f"rows and columns share a name: {', '.join(repeated)}")
    axes = [name for name in scores.axes if name in named and name not in (*within, *blocks)]
    if compare is None and axes:
        compare = axes[-1]
    return compare, (*within, *(name for name in named if name not in (compare, *within)))


def completed(layout: Layout, question: Question) -> Layout:
    """Return the layout with a place for every name of the question, in rows if it has columns."""
    names = (*question.within, *question.compared)
    rest = tuple(name for name in names if name not in (*layout.rows, *layout.columns))
    if layout.columns:
        return Layout((*layout.rows, *rest), layout.columns)
    return Layout(layout.rows, rest if layout.rows else ())


_VALUED = ("mean", "rms", "median", "sd", "low", "high")
_PAIRED = {
    "difference": "mean",
    "difference low": "low",
    "difference high": "high",
    "p": "p",
    "better in": "better",
}
_INTERVALS: dict[str, dict[Part, str]] = {
    "mean": {"low": "low", "high": "high"},
    "difference": {"low": "difference low", "high": "difference high"},
}
_SHARES = ("refused", "left missing", "better in")


def long_table(
    summaries: Sequence[Summary], question: Question, unit: str, left: Sequence[str]
) -> Table:
    """Return a row per group and method, the best mean of each group first and marked.

    Parameters
    ----------
    summaries, question
        Of the comparison.
    unit
        Of the metric.
    left
        Columns that are not wanted.
    """
    from pandas import DataFrame

    columns: dict[str, list[Any]] = {}
    for summary in summaries:
        for name, values in _columns(summary, question, left).items():
            columns.setdefault(name, []).extend(values)
    frame = DataFrame(columns)
    marked = [mark for summary in summaries for mark in summary.marked[summary.ranked]]
    several = question.compare is not None
    info = TableInfo(
        units=_units(frame, unit),
        labels=(*question.within, *question.compared),
        best={"mean": tuple(np.flatnonzero(marked).tolist())} if several else {},
        cells={name: parts for name, parts in _INTERVALS.items() if name in frame},
    )
    return with_info(frame, info)


def _columns(
    summary: Summary, question: Question, left: Sequence[str]
) -> Mapping[str, Sequence[Any]]:
    group = summary.group
    labels = zip(question.within, group.labels, strict=True)
    columns: dict[str, Any] = {name: [label] * len(group.methods) for name, label in labels}
    columns |= {name: group.methods for name in question.compared}
    columns["blocks"] = summary.blocks
    columns |= {name: getattr(summary, name) for name in _VALUED}
    columns |= {"refused": group.refused, "left missing": group.missing}
    nothing = np.full(len(group.methods), np.nan)
    for name, attribute in _PAIRED.items():
        if name not in left:
            paired = summary.paired
            columns[name] = nothing if paired is None else getattr(paired, attribute)
    return {name: [values[place] for place in summary.ranked] for name, values in columns.items()}


def _units(frame: Table, unit: str) -> dict[str, str]:
    valued = (*_VALUED, "difference", "difference low", "difference high")
    units = {name: unit for name in valued if unit and name in frame}
    return units | {name: "share" for name in _SHARES if name in frame}


PAIRED = tuple(_PAIRED)
"""The columns that need a baseline."""

"""The table in rows and columns, as a paper prints it: a mean and its interval in each cell."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import zip_longest
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from nodegraph_compare.table.sensitivity import COMMON, WORST, behind_by_all_rules, tied_with_best
from nodegraph_tables import TableInfo, with_info
from nodegraph_tables.style import CHANCE, SHARE

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from nodegraph import Across, Declared, Label
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
    tied: bool


_NOTHING = _Cell(np.nan, np.nan, np.nan, np.nan, 0, False, False)


def wide_table(
    summaries: Sequence[Summary],
    question: Question,
    layout: Layout,
    order: Sequence[Label],
    parts: Sequence[Part],
    unit: str,
) -> Table:
    """Return the means in rows and columns.

    Further numbers about the mean are in columns of their own, which a reader sees in one cell.
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
        Further numbers about the mean: ``low``, ``high`` and ``p``, against the baseline, or the
        best.
    unit
        Of the means.
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
        # a share is printed in percent, which a head must say; other units stand in the title
        units=dict.fromkeys(under, unit) if unit == SHARE else {},
        labels=layout.rows,
        compared=question.compare if question.compare in layout.rows else "",
        cells={head: {part: f"{head} {part}" for part in parts} for head in under},
        best={
            head: tuple(at for at, cell in enumerate(column) if cell.best)
            for head, column in under.items()
        },
        tied={
            head: tuple(at for at, cell in enumerate(column) if cell.tied)
            for head, column in under.items()
        },
    )
    return with_info(DataFrame(columns), info)


def _side(rows: Sequence[Labels], layout: Layout) -> dict[str, Sequence[object]]:
    """Return the columns of labels down the side."""
    return {name: [row[at] for row in rows] for at, name in enumerate(layout.rows)}


def _beneath(head: str, column: Sequence[_Cell], parts: Sequence[str]) -> dict[str, list[float]]:
    """Return the columns of numbers under one head: the means, then the further numbers."""
    beside = {f"{head} {part}": [getattr(cell, part) for cell in column] for part in parts}
    return {head: [cell.mean for cell in column]} | beside


def blocks_text(summaries: Sequence[Summary]) -> str:
    """Return the number of blocks behind the means of a table."""
    counts = sorted({int(summary.blocks.max(initial=0)) for summary in summaries})
    if len(counts) == 1:
        return f"Every mean is over {counts[0]} blocks."
    return f"The means are over {counts[0]} to {counts[-1]} blocks." if counts else ""


def _cells(summary: Summary, question: Question) -> Iterable[tuple[Mapping[str, Label], _Cell]]:
    at = dict(zip(question.within, summary.group.labels, strict=True))
    paired, bests, blocks = summary.paired, summary.marked, summary.blocks
    tied = tied_with_best(summary)
    for place, method in enumerate(summary.group.methods):
        names = dict.fromkeys(question.compared, method)
        p = np.nan if paired is None else float(paired.p[place])
        numbers = (summary.mean, summary.low, summary.high)
        mean, low, high = (float(number[place]) for number in numbers)
        marks = bool(bests[place]), bool(tied[place])
        yield at | names, _Cell(mean, low, high, p, int(blocks[place]), *marks)


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
    """Return the compared axis and the axes of groups that the layout implies.

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


_DIFFERENCE = {
    "difference": "difference",
    "difference low": "difference_low",
    "difference high": "difference_high",
}
_PAIRED = {
    "low": "low",
    "high": "high",
    **_DIFFERENCE,
    "p": "p",
    "p of flips": "flips",
    "g": "effect",
    "margin": "margin",
}
_VALUED = ("mean", "low", "high", "median")
_LOST = {"refused": "refused", "left missing": "missing"}


def long_table(
    summaries: Sequence[Summary],
    overall: Summary | None,
    question: Question,
    unit: str,
    declared: Mapping[Label, Declared],
    references: Collection[Label],
) -> Table:
    """Return a row per group and method, the best mean of each group first and marked.

    Columns that would hold nothing are left out: what was refused or left missing where nothing
    was, and differences where there are not enough units.

    Parameters
    ----------
    summaries, question
        Of the comparison.
    overall
        Over all groups, whose rows have no labels of `within`; None where there is none.
    unit
        Of the metric.
    declared
        What the methods declare.
    references
        Methods whose rows a folded table shows in any case.
    """
    from pandas import DataFrame

    columns: dict[str, Any] = {}
    paired = paired_name(summaries)
    marks = differing(declared)
    every = [*summaries, *([] if overall is None else [overall])]
    for summary in every:
        for name, values in _columns(summary, question, paired, marks).items():
            columns.setdefault(name, []).extend(values)
    if overall is not None:
        columns |= {name: _with_missing(columns[name]) for name in question.within}
    labels = (*question.within, *question.compared)
    frame = DataFrame(
        {
            name: values
            for name, values in columns.items()
            if _holds(name, values) and not _says_no_more(name, values, columns["mean"])
        }
    )
    marked = [mark for summary in every for mark in summary.marked[summary.ranked]]
    tied = [mark for summary in every for mark in tied_with_best(summary)[summary.ranked]]
    highlights = [
        mark for summary in every for mark in _highlights(summary, references)[summary.ranked]
    ]
    several = question.compare is not None
    valued = (
        *_VALUED,
        f"mean, {COMMON}",
        f"mean, {WORST}",
        *_DIFFERENCE,
    )
    units = {name: unit for name in valued if unit and name in frame}
    margin = next((s.margin for s in summaries), None)
    in_unit = paired != "ratio" if margin is None else not margin.ratio
    units |= {name: CHANCE for name in ("p", "p of flips") if name in frame}
    units |= {"margin": unit} if unit and in_unit and "margin" in frame else {}
    intervals: dict[str, Mapping[Part, str]] = {
        name: {"low": low, "high": high}
        for name, low, high in (
            ("mean", "low", "high"),
            ("ratio", "ratio low", "ratio high"),
            ("difference", "difference low", "difference high"),
        )
        if name in frame
    }
    info = TableInfo(
        units=units | {name: "share" for name in _LOST if name in frame},
        labels=labels,
        best={"mean": tuple(np.flatnonzero(marked).tolist())} if several else {},
        tied={"mean": tuple(np.flatnonzero(tied).tolist())} if several else {},
        highlights=tuple(np.flatnonzero(highlights).tolist()),
        overall=tuple(range(len(frame) - _count(overall), len(frame))),
        compared=question.compare or "",
        cells=intervals,
    )
    return with_info(frame, info)


def _count(overall: Summary | None) -> int:
    return 0 if overall is None else len(overall.group.methods)


def _with_missing(labels: list[Any]) -> object:
    """Return a column of labels, numbers as such, some of which are missing."""
    import pandas as pd

    kinds = {type(label) for label in labels if label is not None}
    if kinds == {int}:
        return pd.array(labels, dtype="Int64")
    if kinds <= {int, float}:
        return np.array([np.nan if label is None else label for label in labels])
    return labels


def _highlights(summary: Summary, references: Collection[Label]) -> NDArray[np.bool_]:
    """Return (K,), where the nearest method that is behind stands, and the references."""
    marks = np.array([method in references for method in summary.group.methods], dtype=bool)
    if summary.judged and summary.best is not None:
        behind = behind_by_all_rules(summary)
        marks[[place for place in summary.ranked if behind[place]][:1]] = True
    return marks


def paired_name(summaries: Sequence[Summary]) -> str:
    """Return how methods are compared to the best one, or to the baseline."""
    return "ratio" if all(summary.ratio for summary in summaries) else "difference"


def _columns(
    summary: Summary,
    question: Question,
    name: str,
    marks: Mapping[str, Mapping[Label, str]],
) -> Mapping[str, Sequence[object]]:
    group, paired = summary.group, summary.paired
    labels = zip_longest(question.within, group.labels)
    columns: dict[str, Any] = {name: [label] * len(group.methods) for name, label in labels}
    columns |= {name: group.methods for name in question.compared}
    columns["blocks"] = summary.blocks
    columns |= {name: getattr(summary, name) for name in _VALUED}
    nothing = np.full(len(group.methods), np.nan)
    if name == "ratio":
        columns[name] = nothing if paired is None else paired.value
    for part, attribute in _PAIRED.items():
        head = f"{name} {part}" if part in ("low", "high") else part
        columns[head] = nothing if paired is None else getattr(paired, attribute)
    columns["wins"] = _wins(summary)
    of = {variant.rule: variant.summary for variant in summary.variants}
    for rule in (COMMON, WORST):
        columns[f"mean, {rule}"] = of[rule].mean if rule in of else nothing
    columns |= {name: getattr(group, attribute) for name, attribute in _LOST.items()}
    columns |= {
        head: [texts.get(method, "") for method in group.methods] for head, texts in marks.items()
    }
    return {name: [values[place] for place in summary.ranked] for name, values in columns.items()}


def _wins(summary: Summary) -> list[str]:
    """Return in how many of the units each method is better than the reference: ``3/8``."""
    paired = summary.paired
    if paired is None or summary.end == "none":
        return [""] * len(summary.level)
    count = len(summary.units.means)
    return [f"{wins:.0f}/{count}" if np.isfinite(wins) else "" for wins in paired.wins]


def differing(declared: Mapping[Label, Declared]) -> dict[str, dict[Label, str]]:
    """Return what methods declare as columns of text, where it differs among them."""
    columns = {
        "adapted": {label: "yes" if "adapted" in each else "" for label, each in declared.items()},
        "looks ahead": {label: _ahead(each) for label, each in declared.items()},
        "meets ends": {
            label: {True: "yes", False: "no", None: ""}[each.get("ends")]
            for label, each in declared.items()
        },
    }
    return {head: texts for head, texts in columns.items() if len({*texts.values()}) > 1}


def _ahead(declared: Declared) -> str:
    frames = declared.get("lookahead", -1)
    if frames is None:
        return "whole take"
    return "" if frames < 0 else f"{frames} frames"


def _says_no_more(name: str, values: Sequence[float], means: Sequence[float]) -> bool:
    """Whether a column repeats the means, as nothing is missing."""
    return name.startswith("mean, ") and np.array_equal(values, means, equal_nan=True)


def _holds(name: str, values: Sequence[Any]) -> bool:
    """Whether a column says anything."""
    if name in _LOST:
        return any(value > 0.0 for value in values)
    if name == "wins":
        return any(values)
    paired = (
        name in _PAIRED
        or name.startswith("mean, ")
        or name.split(" ")[0] in ("ratio", "difference")
    )
    return name in _VALUED or not paired or bool(np.isfinite(values).any())

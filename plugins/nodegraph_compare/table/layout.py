"""The table in rows and columns, as a paper prints it: a mean and its interval in each cell."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import zip_longest
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from nodegraph_compare.verdict import COMMON, WORST
from nodegraph_tables import TableInfo, with_info
from nodegraph_tables.style import CHANCE, SHARE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from nodegraph import Across, Declared, Label
    from nodegraph_compare.question import Question
    from nodegraph_compare.verdict import Mark, Verdict, Verdicts
    from nodegraph_mocap import Table
    from nodegraph_tables.info import Part


Labels = tuple["Label", ...]


class _Cell(NamedTuple):
    """The content of one place of the table."""

    mean: float
    low: float
    high: float
    p: float
    blocks: int
    mark: Mark | None


_NOTHING = _Cell(np.nan, np.nan, np.nan, np.nan, 0, None)


def wide_table(verdicts: Verdicts, layout: TableLayout, parts: Sequence[Part]) -> Table:
    """Return the means in rows and columns.

    Further numbers about the mean are in columns of their own, which a reader sees in one cell.
    The best mean of each group is marked.

    Parameters
    ----------
    verdicts
        On each group.
    layout
        What stands down the side, and along the top.
    parts
        Further numbers about the mean: ``low``, ``high`` and ``p``, against the baseline, or the
        best.
    """
    from pandas import DataFrame

    cells = {
        (_picked(at, layout.rows), _picked(at, layout.columns)): cell
        for group in verdicts.groups
        for at, cell in _cells(verdicts, group)
    }
    place = _order(verdicts)
    unit = verdicts.metric.unit
    rows = sorted({row for row, _ in cells}, key=place(layout.rows))
    tops = sorted({top for _, top in cells}, key=place(layout.columns))
    stacked = [[cells.get((row, top), _NOTHING) for row in rows] for top in tops]
    columns = _side(rows, layout)
    if set(verdicts.within).issubset(layout.rows):
        columns["blocks"] = [max(cell.blocks for cell in row) for row in zip(*stacked, strict=True)]
    under = dict(zip(_heads(tops, layout.columns, taken=columns), stacked, strict=True))
    for head, column in under.items():
        columns |= _beneath(head, column, parts)
    info = TableInfo(
        # a share is printed in percent, which a head must say; other units stand in the title
        units=dict.fromkeys(under, unit) if unit == SHARE else {},
        labels=layout.rows,
        compared=verdicts.compare if verdicts.compare in layout.rows else "",
        cells={head: {part: f"{head} {part}" for part in parts} for head in under},
        best={
            head: tuple(at for at, cell in enumerate(column) if cell.mark == "best")
            for head, column in under.items()
        },
        tied={
            head: tuple(at for at, cell in enumerate(column) if cell.mark == "tied")
            for head, column in under.items()
        },
    )
    return with_info(DataFrame(columns), info)


def _side(rows: Sequence[Labels], layout: TableLayout) -> dict[str, Sequence[object]]:
    """Return the columns of labels down the side."""
    return {name: [row[at] for row in rows] for at, name in enumerate(layout.rows)}


def _beneath(head: str, column: Sequence[_Cell], parts: Sequence[str]) -> dict[str, list[float]]:
    """Return the columns of numbers under one head: the means, then the further numbers."""
    beside = {f"{head} {part}": [getattr(cell, part) for cell in column] for part in parts}
    return {head: [cell.mean for cell in column]} | beside


def blocks_text(groups: Sequence[Verdict]) -> str:
    """Return the number of blocks behind the means of a table."""
    counts = sorted({int(group.blocks.max(initial=0)) for group in groups})
    if len(counts) == 1:
        return f"Every mean is over {counts[0]} blocks."
    return f"The means are over {counts[0]} to {counts[-1]} blocks." if counts else ""


def _cells(verdicts: Verdicts, group: Verdict) -> Iterable[tuple[Mapping[str, Label], _Cell]]:
    at = dict(zip(verdicts.within, group.labels, strict=True))
    paired, marks = group.paired, group.marks
    for place in group.ranked:
        names = {verdicts.compare: verdicts.methods[place]} if verdicts.compare else {}
        p = np.nan if paired is None else float(paired.p[place])
        numbers = (group.mean, group.low, group.high)
        mean, low, high = (float(number[place]) for number in numbers)
        yield at | names, _Cell(mean, low, high, p, int(group.blocks[place]), marks.get(place))


def _picked(at: Mapping[str, Label], names: Sequence[str]) -> Labels:
    return tuple(at[name] for name in names)


def _order(verdicts: Verdicts) -> Callable[[Sequence[str]], Callable[[Labels], tuple[int, ...]]]:
    """Return what gives the places of labels in the order in which the graph lists them."""
    listed: dict[str, Sequence[Label]] = {verdicts.compare: verdicts.methods}
    for at, name in enumerate(verdicts.within):
        listed[name] = tuple(dict.fromkeys(group.labels[at] for group in verdicts.groups))
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
class TableLayout:
    """Names that stand down the side, and along the top; without the latter, a row per mean."""

    rows: Names
    columns: Names


def implied(
    scores: Across[Table], compare: str | None, within: Names, layout: TableLayout, blocks: Names
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


def completed(layout: TableLayout, question: Question) -> TableLayout:
    """Return the layout with a place for every name of the question, in rows if it has columns."""
    names = (*question.within, *question.compared)
    rest = tuple(name for name in names if name not in (*layout.rows, *layout.columns))
    if layout.columns:
        return TableLayout((*layout.rows, *rest), layout.columns)
    return TableLayout(layout.rows, rest if layout.rows else ())


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
_VALUED = {
    "mean": "mean",
    "low": "low",
    "high": "high",
    "arithmetic mean": "arithmetic",
    "median": "median",
}
_LOST = {"refused": "refused", "left missing": "missing"}


def long_table(verdicts: Verdicts, declared: Mapping[Label, Declared]) -> Table:
    """Return a row per group and method, the best mean of each group first and marked.

    Columns that would hold nothing are left out: what was refused or left missing where nothing
    was, and differences where there are not enough units. Rows over all groups have no labels of
    `within`.

    Parameters
    ----------
    verdicts
        On each group, and over all of them.
    declared
        What the methods declare.
    """
    from pandas import DataFrame

    columns: dict[str, Any] = {}
    paired = "ratio" if verdicts.ratio else "difference"
    texts = differing(declared)
    overall = verdicts.overall
    for group in verdicts.every:
        for name, values in _columns(verdicts, group, paired, texts).items():
            columns.setdefault(name, []).extend(values)
    if overall is not None:
        columns |= {name: _with_missing(columns[name]) for name in verdicts.within}
    compared = (verdicts.compare,) if verdicts.compare else ()
    frame = DataFrame(
        {
            name: values
            for name, values in columns.items()
            if _holds(name, values) and not _says_no_more(name, values, columns["mean"])
        }
    )
    rows = [(group, place) for group in verdicts.every for place in group.ranked]
    marks = [group.marks.get(place) for group, place in rows]
    best, tied = (
        tuple(row for row, of in enumerate(marks) if of == mark) for mark in ("best", "tied")
    )
    shown = {id(group): _highlights(verdicts, group) for group in verdicts.every}
    highlights = tuple(row for row, (group, place) in enumerate(rows) if place in shown[id(group)])
    unit = verdicts.metric.unit
    valued = (
        *_VALUED,
        f"mean, {COMMON}",
        f"mean, {WORST}",
        *_DIFFERENCE,
    )
    units = {name: unit for name in valued if unit and name in frame}
    margin = verdicts.margin
    in_unit = not (verdicts.ratio if margin is None else margin.ratio)
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
        unseen=("arithmetic mean",),
        units=units | {name: "share" for name in _LOST if name in frame},
        labels=(*verdicts.within, *compared),
        best={"mean": best} if compared else {},
        tied={"mean": tied} if compared else {},
        highlights=highlights,
        overall=tuple(row for row, (group, _) in enumerate(rows) if group is overall),
        compared=verdicts.compare,
        cells=intervals,
    )
    return with_info(frame, info)


def _with_missing(labels: list[Any]) -> object:
    """Return a column of labels, numbers as such, some of which are missing."""
    import pandas as pd

    kinds = {type(label) for label in labels if label is not None}
    if kinds == {int}:
        return pd.array(labels, dtype="Int64")
    if kinds <= {int, float}:
        return np.array([np.nan if label is None else label for label in labels])
    return labels


def _highlights(verdicts: Verdicts, group: Verdict) -> set[int]:
    """Return the nearest method that is behind, and those that others are compared to."""
    behind = group.behind
    references = (verdicts.baseline, verdicts.fallback)
    return {
        *[place for place in group.ranked if place in behind][:1],
        *[place for place, method in enumerate(verdicts.methods) if method in references],
    }


def _columns(
    verdicts: Verdicts,
    group: Verdict,
    name: str,
    marks: Mapping[str, Mapping[Label, str]],
) -> Mapping[str, Sequence[object]]:
    paired, count = group.paired, len(verdicts.methods)
    labels = zip_longest(verdicts.within, group.labels)
    columns: dict[str, Any] = {name: [label] * count for name, label in labels}
    columns |= {verdicts.compare: verdicts.methods} if verdicts.compare else {}
    columns["blocks"] = group.blocks
    columns |= {name: getattr(group, attribute) for name, attribute in _VALUED.items()}
    nothing = np.full(count, np.nan)
    if name == "ratio":
        columns[name] = nothing if paired is None else paired.value
    for part, attribute in _PAIRED.items():
        head = f"{name} {part}" if part in ("low", "high") else part
        columns[head] = nothing if paired is None else getattr(paired, attribute)
    columns["wins"] = _wins(group)
    for rule in (COMMON, WORST):
        other = group.by_rule.get(rule)
        columns[f"mean, {rule}"] = nothing if other is None else other.mean
    columns |= {name: getattr(group, attribute) for name, attribute in _LOST.items()}
    columns |= {
        head: [texts.get(method, "") for method in verdicts.methods]
        for head, texts in marks.items()
    }
    return {name: [values[place] for place in group.ranked] for name, values in columns.items()}


def _wins(group: Verdict) -> list[str]:
    """Return in how many of the units each method is better than the reference: ``3/8``."""
    paired = group.paired
    if paired is None or group.better == "none":
        return [""] * len(group.mean)
    count = group.scope.units
    return [f"{wins:.0f}/{count}" if np.isfinite(wins) else "" for wins in paired.wins]


def differing(declared: Mapping[Label, Declared]) -> dict[str, dict[Label, str]]:
    """Return what methods declare as columns of text, where it differs among them."""
    columns = {
        "adapted": {label: "yes" if "adapted" in each else "" for label, each in declared.items()},
        "looks ahead": {label: _ahead(each) for label, each in declared.items()},
        "meets ends": {
            label: _MEETS[each["ends"]] if "ends" in each else ""
            for label, each in declared.items()
        },
    }
    return {head: texts for head, texts in columns.items() if len({*texts.values()}) > 1}


_MEETS = {True: "yes", False: "no", None: "by setting"}


def _ahead(declared: Declared) -> str:
    frames = declared.get("lookahead", -1)
    if frames is None:
        return "whole take"
    return "" if frames < 0 else f"{frames} frame{'s' * (frames != 1)}"


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

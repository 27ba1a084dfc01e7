"""The table of a comparison: a row for each mean."""

from __future__ import annotations

from dataclasses import replace
from itertools import zip_longest
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph_compare.verdict import COMMON, WORST
from nodegraph_tables import TableInfo, with_info
from nodegraph_tables.style import CHANCE

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from nodegraph import Across, Declared, Label
    from nodegraph_compare.verdict import Verdict, Verdicts
    from nodegraph_mocap import Table
    from nodegraph_tables.info import Part


Names = tuple[str, ...]


def blocks_text(groups: Sequence[Verdict]) -> str:
    """Return the number of blocks behind the means of a table."""
    counts = sorted({int(group.blocks.max(initial=0)) for group in groups})
    if len(counts) == 1:
        return f"Every mean is over {counts[0]} blocks."
    return f"The means are over {counts[0]} to {counts[-1]} blocks." if counts else ""


def implied(
    scores: Across[Table], compare: str | None, within: Names, named: Names, blocks: Names
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
    named
        Which names stand down the side, or along the top.

    Raises
    ------
    ValueError
        If a name is laid out twice.
    """
    repeated = sorted({name for name in named if named.count(name) > 1})
    if repeated:
        raise ValueError(f"rows and columns share a name: {', '.join(repeated)}")
    axes = [name for name in scores.axes if name in named and name not in (*within, *blocks)]
    if compare is None and axes:
        compare = axes[-1]
    return compare, (*within, *(name for name in named if name not in (compare, *within)))


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


def means_table(
    verdicts: Verdicts, declared: Mapping[Label, Declared], layout: tuple[Names, Names]
) -> Table:
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
    layout
        Labels that a reader sees down the side, and along the top, methods in the order of the
        graph; none where every mean has a row.
    """
    from pandas import DataFrame

    every: Sequence[Verdict] = verdicts.every
    if any(layout):
        every = [replace(group, ranked=tuple(sorted(group.ranked))) for group in every]
    columns: dict[str, Any] = {}
    paired = "ratio" if verdicts.ratio else "difference"
    texts = differing(declared)
    overall = verdicts.overall
    for group in every:
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
    rows = [(group, place) for group in every for place in group.ranked]
    marks = [group.marks.get(place) for group, place in rows]
    best, tied = (
        tuple(row for row, of in enumerate(marks) if of == mark) for mark in ("best", "tied")
    )
    shown = {id(group): _highlights(verdicts, group) for group in every}
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
    if any(layout) and "p" in frame:
        intervals["mean"] = {**intervals["mean"], "p": "p"}
    info = TableInfo(
        unseen=("arithmetic mean",),
        units=units | {name: "share" for name in _LOST if name in frame},
        labels=(*verdicts.within, *compared),
        best={"mean": best} if compared or any(layout) else {},
        tied={"mean": tied} if compared else {},
        highlights=() if any(layout) else highlights,
        overall=tuple(row for row, (group, _) in enumerate(rows) if group is overall),
        compared=verdicts.compare,
        cells=intervals,
        layout=layout,
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

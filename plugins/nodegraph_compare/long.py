"""The table with a row per group and method, and every statistic in a column."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from nodegraph_compare.question import Question
    from nodegraph_compare.summary import Summary
    from nodegraph_mocap import Table

_VALUED = ("mean", "rms", "median", "sd", "low", "high")
_PAIRED = {
    "difference": "mean",
    "difference low": "low",
    "difference high": "high",
    "p": "p",
    "better in": "better",
}
_INTERVALS = {
    "mean": {"low": "low", "high": "high"},
    "difference": {"low": "difference low", "high": "difference high"},
}
_SHARES = ("refused", "left missing", "better in")


def long_table(
    found: Sequence[Summary], question: Question, unit: str, left: Sequence[str]
) -> Table:
    """Return a row per group and method, the best mean of each group first.

    ``attrs["best"]`` has the rows of the best means.

    Parameters
    ----------
    found, question
        Of the comparison.
    unit
        Of the metric.
    left
        Columns that are not wanted.
    """
    from pandas import DataFrame

    columns: dict[str, list[Any]] = {}
    for one in found:
        for name, values in _columns(one, question, left).items():
            columns.setdefault(name, []).extend(values)
    made = DataFrame(columns)
    marked = [mark for one in found for mark in one.marked[one.ranked]]
    several = question.compare is not None
    made.attrs["best"] = {"mean": np.flatnonzero(marked).tolist()} if several else {}
    made.attrs["units"] = _units(made, unit)
    made.attrs["labels"] = [*question.within, *question.compared]
    made.attrs["cells"] = {name: parts for name, parts in _INTERVALS.items() if name in made}
    return made


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


def _units(made: Table, unit: str) -> dict[str, str]:
    valued = (*_VALUED, "difference", "difference low", "difference high")
    units = {name: unit for name in valued if unit and name in made}
    return units | {name: "share" for name in _SHARES if name in made}


PAIRED = tuple(_PAIRED)
"""The columns that need a baseline."""

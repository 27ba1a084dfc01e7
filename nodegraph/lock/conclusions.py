"""The conclusions and tables of a study, and how they changed."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from nodegraph.execute.results import Run
from nodegraph.formatting import name_at

Rows = list[list[str]]
"""The cells of a table with its header."""

_LABELS = 3
"""Cells at the start of a row that name it at most."""


@dataclass(frozen=True)
class Reported:
    """A reported value as text.

    Attributes
    ----------
    name : str
        The node, its output if there are several, and its labels.
    conclusions : tuple of str
    table : str
        As CSV.
    """

    name: str
    conclusions: tuple[str, ...]
    table: str


def reported_by(run: Run) -> Iterator[Reported]:
    """Yield the reported values of a run from which a plugin draws conclusions."""
    graph = run.plan.graph
    for node, output, labels, value in run.reported():
        kind = graph.registry.hooks.kind(type(value), "conclude")
        if kind is not None and kind.conclude is not None:
            several = len(graph.nodes[node].outputs) > 1
            name = name_at(f"{node}.{output}" if several else node, labels)
            numbers = kind.numbers(value) if kind.numbers is not None else ""
            yield Reported(name, tuple(map(str, kind.conclude(value))), numbers)


def conclusion_changes(
    was: Mapping[str, Sequence[str]], reported: Sequence[Reported]
) -> Iterator[str]:
    """Yield each conclusion that is no longer drawn, or that is new.

    Parameters
    ----------
    was
        The locked conclusions, by the name of the reported value.
    reported
        By the run.
    """
    now = {value.name: value.conclusions for value in reported if value.conclusions}
    for name in {**was, **now}:
        before, after = was.get(name, ()), now.get(name, ())
        yield from (f"{name}: no longer: {text}" for text in before if text not in after)
        yield from (f"{name}: now: {text}" for text in after if text not in before)


def table_changes(
    was: Mapping[str, str], reported: Sequence[Reported], least: float
) -> Iterator[str]:
    """Yield for each table how many rows changed, and the largest change.

    Parameters
    ----------
    was
        The locked tables as CSV, by the name of the reported value.
    reported
        By the run.
    least
        Smaller relative changes do not count.
    """
    for value in reported:
        if value.name in was:
            changes = _table_changes(was[value.name], value.table, least)
            yield from (f"{value.name}: {text}" for text in changes)


def _table_changes(was: str, now: str, least: float) -> Iterator[str]:
    before, after = (list(csv.reader(text.splitlines())) for text in (was, now))
    if before[:1] != after[:1]:
        columns = [", ".join(rows[0]) if rows else "none" for rows in (before, after)]
        yield f"had the columns {columns[0]}, now {columns[1]}"
    elif len(before) != len(after):
        yield f"had {len(before) - 1} rows, now {len(after) - 1}"
    else:
        width = max(map(len, before + after), default=0)
        yield from _row_changes(_padded(before, width), _padded(after, width), least)


def _padded(rows: Rows, width: int) -> Rows:
    return [row + [""] * (width - len(row)) for row in rows]


def _row_changes(before: Rows, after: Rows, least: float) -> Iterator[str]:
    """Yield how many rows changed, and the cell that changed most, if any did."""
    sizes = [max(map(_magnitude, column)) for column in zip(*before[1:], strict=True)]
    rows: set[int] = set()
    largest, text = least, ""
    for row, (was, now) in enumerate(zip(before, after, strict=True)):
        for column, (old, new) in enumerate(zip(was, now, strict=True)):
            change = _relative_change(old, new, sizes[column]) if old != new else 0.0
            if change > least:
                rows.add(row)
            if change > largest:
                labels = ", ".join(now[: min(column, _LABELS)])
                largest, text = change, f"{before[0][column]} of {labels}: {old}, now {new}"
    if rows:
        yield f"{len(rows)} of {len(after) - 1} rows changed; most of all {text}"


def _relative_change(old: str, new: str, size: float) -> float:
    """Return the change of a cell in units of its column; infinity if one is not a number."""
    change = abs(_number(old) - _number(new)) / (size or 1.0)
    return change if math.isfinite(change) else math.inf


def _magnitude(cell: str) -> float:
    number = _number(cell)
    return abs(number) if math.isfinite(number) else 0.0


def _number(cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        return math.nan

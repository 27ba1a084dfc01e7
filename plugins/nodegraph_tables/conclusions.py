"""The conclusions of a table: its answer, what is best, the order of rows, signs of differences."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph_tables.info import info_of
from nodegraph_tables.types import Table

if TYPE_CHECKING:
    from collections.abc import Sequence

_NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?(?![\w.]*\w)", re.I)
_MEASURED = re.compile(r"(?<![\w.])[-+]?\d*\.\d+(?:e[-+]?\d+)?(?!\w)|(?<![\w.])\d+e[-+]?\d+", re.I)
_ASIDE = re.compile(r"\([^()]*\)")
_GROUP_ENDS = "blocks"
"""The column after the labels; the last label is the method, those before it the group."""


def conclude_table(table: Table) -> Iterator[str]:
    """Yield the conclusions of a table, without measured numbers.

    They are its answer without the numbers that are in brackets or not whole; the rows that are
    marked as best; the order of rows by a column so marked; and on which side of 0 the intervals
    of differences lie.
    """
    info = info_of(table)
    for sentence in info.answer:
        yield without_measured(sentence)
    for column, rows in info.best.items():
        if column in table:
            yield from _order(table, column, rows)
    yield from _signs(table)


def table_numbers(table: Table) -> str:
    """Return the table as CSV, its numbers to ten digits."""
    return table.to_csv(index=False, lineterminator="\n", float_format="%.10g")


def without_measured(sentence: str) -> str:
    """Return a sentence without its measured numbers; labels and whole numbers stay.

    Numbers in brackets are details of what stands before them, and go whatever they are.
    """
    bare = _ASIDE.sub(lambda match: _NUMBER.sub("#", match[0]), sentence)
    return _MEASURED.sub("#", bare)


def _order(table: Table, column: str, marked: Sequence[int]) -> Iterator[str]:
    """Yield the marked rows of a column, and the order of the rows of each group by it."""
    best = [_row(table, place) for place in sorted(marked)]
    yield f"best {column}: {'; '.join(best)}"
    labels = _labels(table)
    if not labels or table[column].dtype.kind not in "fiu":
        return
    groups: dict[str, list[int]] = {}
    for place in range(len(table)):
        groups.setdefault(_named(table, labels[:-1], place), []).append(place)
    values = table[column].to_numpy(dtype=float)
    for group, places in groups.items():
        known = [place for place in places if np.isfinite(values[place])]
        order = sorted(known, key=lambda place: values[place])
        names = " < ".join(str(table[labels[-1]].iloc[place]) for place in order)
        yield f"{column}{f' ({group})' if group else ''}: {names}"


def _signs(table: Table) -> Iterator[str]:
    """Yield which paired differences have an interval that does not hold 0."""
    ends = ("difference low", "difference high")
    if not all(name in table for name in ends):
        return
    low, high = (table[name].to_numpy(dtype=float) for name in ends)
    for side, where in (("below", high < 0.0), ("above", low > 0.0)):
        rows = sorted(_row(table, int(place)) for place in np.flatnonzero(where))
        yield f"difference {side} 0: {'; '.join(rows) or 'none'}"


def _labels(table: Table) -> list[Any]:
    columns = list(table.columns)
    return columns[: columns.index(_GROUP_ENDS)] if _GROUP_ENDS in columns else []


def _row(table: Table, place: int) -> str:
    return _named(table, _labels(table), place) or f"row {place}"


def _named(table: Table, labels: Sequence[Any], place: int) -> str:
    return ", ".join(f"{name} {table[name].iloc[place]}" for name in labels)

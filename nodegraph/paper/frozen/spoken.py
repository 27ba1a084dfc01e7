"""How what a study says has changed since its lock: its conclusions, and its tables' numbers."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from nodegraph.paper.frozen.concluded import Said

Rows = list[list[str]]
"""The cells of a table, its head first."""

_LABELS = 3
"""Cells at the beginning of a row that are shown to say which one it is, at most."""


def conclusions_changed(was: Mapping[str, Any], said: Sequence[Said]) -> Iterator[str]:
    """Yield each conclusion that is no longer drawn, or was not before.

    Parameters
    ----------
    was
        As in a lock: sentences by the name of what says them.
    said
        By the run.
    """
    now = {one.name: list(one.sentences) for one in said if one.sentences}
    for name in {**was, **now}:
        before, here = was.get(name, []), now.get(name, [])
        yield from (f"{name}: no longer: {one}" for one in before if one not in here)
        yield from (f"{name}: now: {one}" for one in here if one not in before)


def numbers_changed(was: Mapping[str, str], said: Sequence[Said], least: float) -> Iterator[str]:
    """Yield for each table how many rows have other numbers, and the largest change.

    Parameters
    ----------
    was
        As in a lock: CSV by names.
    said
    least
        Relative size of a change that counts.
    """
    for one in said:
        if one.name in was:
            yield from (f"{one.name}: {text}" for text in _table(was[one.name], one.numbers, least))


def _table(was: str, now: str, least: float) -> Iterator[str]:
    before, here = (list(csv.reader(text.splitlines())) for text in (was, now))
    if before[:1] != here[:1]:
        heads = [", ".join(rows[0]) if rows else "none" for rows in (before, here)]
        yield f"had the columns {heads[0]}, now {heads[1]}"
    elif len(before) != len(here):
        yield f"had {len(before) - 1} rows, now {len(here) - 1}"
    else:
        width = max(map(len, before + here), default=0)
        yield from _rows(_filled(before, width), _filled(here, width), least)


def _filled(rows: Rows, width: int) -> Rows:
    """Return rows that are all of one width."""
    return [row + [""] * (width - len(row)) for row in rows]


def _rows(before: Rows, here: Rows, least: float) -> Iterator[str]:
    """Yield how many rows differ, and the cell that does most, if any do."""
    sizes = [max(map(_size, column)) for column in zip(*before[1:], strict=True)]
    rows: set[int] = set()
    largest, text = least, ""
    for place, (was, now) in enumerate(zip(before, here, strict=True)):
        for column, (one, other) in enumerate(zip(was, now, strict=True)):
            apart = _apart(one, other, sizes[column]) if one != other else 0.0
            if apart > least:
                rows.add(place)
            if apart > largest:
                labels = ", ".join(now[: min(column, _LABELS)])
                largest, text = apart, f"{before[0][column]} of {labels}: {one}, now {other}"
    if rows:
        yield f"{len(rows)} of {len(here) - 1} rows are others; most of all {text}"


def _apart(one: str, other: str, size: float) -> float:
    """Return how far two cells are apart in units of their column; infinity if not by numbers."""
    apart = abs(_number(one) - _number(other)) / (size or 1.0)
    return apart if math.isfinite(apart) else math.inf


def _size(cell: str) -> float:
    number = _number(cell)
    return abs(number) if math.isfinite(number) else 0.0


def _number(cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        return math.nan

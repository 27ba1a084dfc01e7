"""Differences between two tables, by columns and rows, and between two figures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph import listed
from nodegraph_tables.figures import StoredFigure
from nodegraph_tables.types import Table

if TYPE_CHECKING:
    from numpy.typing import NDArray

_MOST_NAMES = 5


def compare_tables(before: Table, now: Table) -> Iterator[str]:
    """Yield which columns differ, in how many rows and by how much.

    Rows are compared by their names, which are their cells in the first columns without fractions
    that tell all rows apart in both tables; if there are none, by their places.
    """
    names, names_now = tuple(map(str, before.columns)), tuple(map(str, now.columns))
    if names != names_now:
        yield from name_differences("columns", names, names_now)
    rows = _row_names(before, now)
    if rows is not None:
        were, are = rows
        if were != are:
            yield from name_differences("rows", were, are)
        places, places_now = ({name: place for place, name in enumerate(each)} for each in rows)
        both = [name for name in were if name in places_now]
        before = before.iloc[[places[name] for name in both]]
        now = now.iloc[[places_now[name] for name in both]]
    elif len(before) != len(now):
        yield f"had {len(before)} rows, now {len(now)}"
        return
    else:
        both = list(map(str, range(len(before))))
    for column in (name for name in before.columns if name in now.columns):
        was, values = before[column].to_numpy(), now[column].to_numpy()
        lone, lost = before[column].isna().to_numpy(), now[column].isna().to_numpy()
        differs, both_there = lone != lost, ~(lone | lost)
        differs[both_there] |= differences(was[both_there], values[both_there])
        if differs.any():
            yield f"{column}: {_change(was, values, differs, both)}"


def _row_names(before: Table, now: Table) -> tuple[list[str], list[str]] | None:
    """Return the names of the rows of both tables, or None if nothing tells them apart."""
    tables = (before, now)
    columns: list[object] = []
    for column in before.columns:
        if column not in now.columns or any(table[column].dtype.kind in "fc" for table in tables):
            continue
        columns.append(column)
        if all(not table.duplicated(columns).any() for table in tables):
            names = [
                [_row_name(columns, row) for row in table[columns].itertuples(index=False)]
                for table in tables
            ]
            return names[0], names[1]
    return None


def _row_name(columns: Sequence[object], row: Sequence[object]) -> str:
    """Return the labels of a row: ``fill=ridge length=15``; ``all`` of one that has none."""
    labels = (
        f"{column}={label}"
        for column, label in zip(columns, row, strict=True)
        if not _is_missing(label)
    )
    return " ".join(labels) or "all"


def compare_drawings(before: StoredFigure, now: StoredFigure) -> Iterator[str]:
    """Yield that two figures are not the same, if they are not."""
    if before.svg != now.svg:
        yield "the drawing is another"


def differences(was: NDArray[np.generic], now: NDArray[np.generic]) -> NDArray[np.bool_]:
    """Return where two arrays differ; NaN equals NaN."""
    differs = np.asarray(was != now, dtype=np.bool_)
    return differs & ~(np.asarray(was != was, np.bool_) & np.asarray(now != now, np.bool_))


def name_differences(what: str, before: Sequence[str], now: Sequence[str]) -> Iterator[str]:
    """Yield which names only one of two sequences has, and whether their order differs."""
    for when, names in (
        ("only before", [name for name in before if name not in set(now)]),
        ("only now", [name for name in now if name not in set(before)]),
    ):
        if names:
            yield f"{what} {when}: {listed(names, _MOST_NAMES)}"
    if set(before) == set(now):
        yield f"{what} in another order"


def _change(
    was: NDArray[np.generic],
    now: NDArray[np.generic],
    differs: NDArray[np.bool_],
    names: Sequence[str],
) -> str:
    """Return in how many rows a column differs, and the largest change, or the first of texts."""
    place = int(np.argmax(differs))
    count = np.count_nonzero(differs)
    most, form = "the first", ""
    if was.dtype.kind in "fiu" and now.dtype.kind in "fiu":
        form = ".6g"
        size = np.abs(now.astype(float) - was.astype(float))
        size[~np.isfinite(size)] = 0.0
        if size.any():
            place = int(np.argmax(size))
            most = "the most"
    texts = f"{_cell(was[place], form)}, now {_cell(now[place], form)}"
    if count == 1:
        return f"row {names[place]}: {texts}"
    return f"{count} of {len(names)} rows, {most} in {names[place]}: {texts}"


def _cell(value: object, form: str) -> str:
    return "missing" if _is_missing(value) else f"{value:{form}}"


def _is_missing(value: Any) -> bool:
    from pandas import isna

    return bool(np.all(isna(value)))

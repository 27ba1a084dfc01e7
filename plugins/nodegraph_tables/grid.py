"""The numbers of a comparison by method and group, as a terminal shows them."""

from __future__ import annotations

from statistics import fmean
from typing import TYPE_CHECKING, NamedTuple

from nodegraph import Grid
from nodegraph_tables.cells import ALL, columns_of
from nodegraph_tables.info import info_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    import pandas as pd

    from nodegraph_tables.cells import Cell, Column


class _Entry(NamedTuple):
    side: str
    head: str
    cell: Cell
    tied: bool


def grid_of(table: pd.DataFrame, title: str) -> Grid | None:
    """Return the columns of which the best numbers are marked; None for a table without any.

    Where there is one such column and several labels, the last label stands down the side, by
    mean place within the groups, and the others along the top.
    """
    info = info_of(table)
    columns = columns_of(table)
    labels = [column for column in columns if column.label]
    marked = [column for column in columns if column.name in info.best]
    if not labels or not marked:
        return None
    is_long = len(marked) == 1 and len(labels) > 1
    names = [", ".join(map(str, row)) for row in zip(*_cells(labels), strict=True)]
    sides = [str(cell) for cell in labels[-1].cells] if is_long else names
    heads = _heads(table, labels[:-1]) if is_long else [""] * len(names)
    entries = [
        _Entry(side, head or column.head, cell, place in info.tied.get(column.name, ()))
        for column in marked
        for place, (side, head, cell) in enumerate(zip(sides, heads, column.cells, strict=True))
    ]
    side = labels[-1].name if is_long else ", ".join(column.name for column in labels)
    unit = f" [{marked[0].unit}]" if marked[0].unit and is_long else ""
    return _grid(f"{title}{unit}", side, entries)


def _cells(columns: Sequence[Column]) -> list[list[Cell]]:
    return [column.cells for column in columns]


def _heads(table: pd.DataFrame, labels: Sequence[Column]) -> list[str]:
    """Return the labels of the groups, a line each, with the axis where they are numbers."""
    values = [table[column.name].tolist() for column in labels]
    return [
        "\n".join(
            str(cell) if isinstance(value, str) or str(cell) == ALL else f"{column.name} {cell}"
            for column, cell, value in zip(labels, cells, group, strict=True)
        )
        for cells, group in zip(
            zip(*_cells(labels), strict=True), zip(*values, strict=True), strict=True
        )
    ]


def _grid(title: str, side: str, entries: Sequence[_Entry]) -> Grid:
    heads = list(dict.fromkeys(entry.head for entry in entries))
    places: dict[str, list[int]] = {}
    for head in heads:
        for place, entry in enumerate(entry for entry in entries if entry.head == head):
            places.setdefault(entry.side, []).append(place)
    sides = sorted(places, key=lambda name: fmean(places[name]))
    at = {(sides.index(entry.side), 1 + heads.index(entry.head)): entry for entry in entries}
    columns = range(1, 1 + len(heads))
    rows = [
        (name, *(at[row, column].cell.text if (row, column) in at else "" for column in columns))
        for row, name in enumerate(sides)
    ]
    return Grid(
        title,
        (side, *heads),
        tuple(rows),
        best=tuple(place for place, entry in at.items() if entry.cell.best),
        tied=tuple(place for place, entry in at.items() if entry.tied),
    )

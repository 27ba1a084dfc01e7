"""The numbers of a comparison by method and group, as papers and terminals show them."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean
from typing import TYPE_CHECKING

from nodegraph import Grid
from nodegraph_tables.cells import ALL, CellText, cells_at, columns_of
from nodegraph_tables.info import info_of

if TYPE_CHECKING:
    import pandas as pd

    from nodegraph_tables.cells import Column
    from nodegraph_tables.info import TableInfo

Labels = tuple[str, ...]


@dataclass(frozen=True)
class Crosstab:
    """Labels down the side and along the top, and a cell for each pair of them.

    Attributes
    ----------
    side, top : tuple of str
        Names of the labels of a row, and of a column, from the outside in.
    rows, heads : tuple of tuple of str
    columns : tuple of list of CellText
    unit : str
        The unit of all numbers, as it is printed.
    """

    side: Labels
    top: Labels
    rows: tuple[Labels, ...]
    heads: tuple[Labels, ...]
    columns: tuple[list[CellText], ...]
    unit: str = ""


def crosstab(
    table: pd.DataFrame,
    rows: Sequence[str] = (),
    columns: Sequence[str] = (),
    *,
    most: int | None = None,
    in_print: bool = False,
) -> Crosstab | None:
    """Return the numbers whose best are marked; None for a table without any.

    Where there is one column of them, and several labels, the last label stands down the side, by
    mean place within the groups, and the others along the top.

    Parameters
    ----------
    table
    rows, columns
        Labels that stand down the side, and along the top, in place of these, or of
        `TableInfo.layout`. What neither names stands in the rows; in the columns, if only rows are
        named.
    most
        The columns of groups from which on the outer labels stand down the side.
    in_print
        See `columns_of`.

    Raises
    ------
    ValueError
        If a name is no label, or is given twice, or the table cannot be laid out anew.
    """
    info = info_of(table)
    shown = columns_of(table, in_print=in_print)
    labels = {column.name: column for column in shown if column.label}
    marked = [column for column in shown if column.name in info.best]
    is_asked = bool(rows or columns)
    if not is_asked:
        rows, columns = _layout_of(info, labels)
    # methods alone may stand along the top
    is_long = len(marked) == 1 and len(labels) > (not columns)
    if is_asked:
        _check(rows, columns, labels if is_long else ())
    if not labels or not marked:
        return None
    if not is_long:
        return Crosstab(
            side=tuple(labels),
            top=("",),
            rows=_texts(labels.values()),
            heads=tuple((column.name,) for column in marked),
            columns=tuple(column.cells for column in marked),
            unit=marked[0].unit,
        )
    more = bool(info.overall)
    side, top = _layout(labels, rows, columns, None if most is None else most + more)
    order = _order(labels)
    row_of, head_of = (_texts(labels[name] for name in names) for names in (side, top))
    row_of = row_of or ((),) * len(table)  # all labels stand along the top
    groups = {*list(labels)[:-1]}
    # what is over all groups has no place where some stand down the side, some along the top
    left_out = info.overall if groups & {*side} and groups & {*top} else ()
    pairs = enumerate(zip(row_of, head_of, strict=True))
    at = {pair: place for place, pair in pairs if place not in left_out}
    sides = sorted(
        dict.fromkeys(row for row, _ in at),
        key=lambda row: [order[n][t] for n, t in zip(side, row, strict=True)],
    )
    tops = sorted(
        dict.fromkeys(head for _, head in at),
        key=lambda head: [order[n][t] for n, t in zip(top, head, strict=True)],
    )
    value = marked[0]
    return Crosstab(
        side=side,
        top=top,
        rows=tuple(sides),
        heads=tuple(
            tuple(_head(table, *pair) for pair in zip(top, head, strict=True)) for head in tops
        ),
        columns=tuple(
            cells_at(table, value.name, [at.get((row, head)) for row in sides], in_print=in_print)
            for head in tops
        ),
        unit=value.unit,
    )


def _check(rows: Sequence[str], columns: Sequence[str], labels: Iterable[str]) -> None:
    named, there = [*rows, *columns], list(labels)
    if not there:
        raise ValueError("only a table with a row for each group and method can be laid out anew")
    for name in named:
        if name not in there:
            raise ValueError(f"the table has no label {name!r}; there is: {', '.join(there)}")
        if named.count(name) > 1:
            raise ValueError(f"{name!r} is named twice among rows and columns")


def seen_columns(table: pd.DataFrame) -> list[Column]:
    """Return the columns that a reader sees: of `TableInfo.layout`, else those of the table."""
    info, columns = info_of(table), columns_of(table)
    of = {column.name: column for column in columns}
    crossed = crosstab(table) if any(_layout_of(info, of)) else None
    if crossed is None:
        return columns
    value = next(column for column in columns if column.name in info.best)
    labels = (
        [CellText(row[at], "", best=False, tied=False) for row in crossed.rows]
        for at in range(len(crossed.side))
    )
    return [
        *(of[name]._replace(cells=cells) for name, cells in zip(crossed.side, labels, strict=True)),
        *(
            value._replace(name=", ".join(head), cells=cells, constant=False)
            for head, cells in zip(crossed.heads, crossed.columns, strict=True)
        ),
    ]


def _layout_of(info: TableInfo, names: Collection[str]) -> tuple[Labels, Labels]:
    """Return the layout of a table; none where it lacks a column that stands in it."""
    rows, columns = info.layout
    return (rows, columns) if {*rows, *columns}.issubset(names) else ((), ())


def _texts(columns: Iterable[Column]) -> tuple[Labels, ...]:
    return tuple(zip(*(map(str, column.cells) for column in columns), strict=True))


def _layout(
    labels: Mapping[str, Column], rows: Sequence[str], columns: Sequence[str], most: int | None
) -> tuple[Labels, Labels]:
    *groups, compared = labels
    if rows or columns:
        rest = [name for name in labels if name not in (*rows, *columns)]
        return ((*rows, *rest), tuple(columns)) if columns else (tuple(rows), tuple(rest))
    for outer in range(len(groups)):
        top = groups[outer:]
        if most is None or len(set(_texts(labels[name] for name in top))) <= most:
            return (*groups[:outer], compared), tuple(top)
    return (*groups[:-1], compared), (groups[-1],)


def _order(labels: Mapping[str, Column]) -> dict[str, dict[str, float]]:
    """Return the places of labels: of the last by its mean place in groups, of others as listed."""
    *groups, compared = labels
    order: dict[str, dict[str, float]] = {
        name: {text: place for place, text in enumerate(dict.fromkeys(map(str, column.cells)))}
        for name, column in labels.items()
    }
    within: dict[Labels, int] = {}
    places: dict[str, list[int]] = {}
    of_rows = _texts(labels[name] for name in groups) or ((),) * len(labels[compared].cells)
    for group, cell in zip(of_rows, labels[compared].cells, strict=True):
        within[group] = within.get(group, -1) + 1
        places.setdefault(str(cell), []).append(within[group])
    order[compared] = {text: fmean(each) for text, each in places.items()}
    return order


def _head(table: pd.DataFrame, name: str, text: str) -> str:
    """Return a label along the top, with its axis where it is a number, true or false."""
    is_number = table[name].dtype.kind in "biuf"
    return f"{name} {text}" if is_number and text != ALL else text


def grid_of(table: pd.DataFrame, title: str) -> Grid | None:
    """Return the crosstab of a table as text; None for a table without one."""
    crossed = crosstab(table)
    if crossed is None:
        return None
    cells = {
        (row, column): cell
        for column, cells in enumerate(crossed.columns, 1)
        for row, cell in enumerate(cells)
    }
    heads = ("\n".join(head) for head in crossed.heads)
    return Grid(
        f"{title} [{crossed.unit}]" if crossed.unit else title,
        (", ".join(crossed.side), *heads),
        tuple(
            (", ".join(labels), *(cells[row, at].text for at in range(1, 1 + len(crossed.heads))))
            for row, labels in enumerate(crossed.rows)
        ),
        best=tuple(place for place, cell in cells.items() if cell.best),
        tied=tuple(place for place, cell in cells.items() if cell.tied),
    )

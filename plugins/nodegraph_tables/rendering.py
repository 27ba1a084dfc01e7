"""Tables in a report, in a terminal, and as CSV and LaTeX files."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from html import escape
from typing import TYPE_CHECKING

from nodegraph import Rendered
from nodegraph_tables.authors_answer import in_authors_words
from nodegraph_tables.cells import CellText, Column
from nodegraph_tables.crosstab import grid_of, seen_columns
from nodegraph_tables.info import TableInfo, info_of, with_info
from nodegraph_tables.latex import latex_of, without_constants
from nodegraph_tables.lead import answer_html, lead_style
from nodegraph_tables.style import SHARE
from nodegraph_tables.types import Table

if TYPE_CHECKING:
    import pandas as pd

    from nodegraph import Provenance

_MOST_LINES = 200
"""Rows from which a table is cut in a terminal."""
_MOST_ROWS = 5_000
"""Rows that a page holds."""
_SHORT_TABLE = 14
"""Rows up to which a table is never folded."""
_SHOWN_ROWS = 18
_FEW_ROWS = 3
_FEW_NOTES = 2

_FORMULAS = ("=", "+", "-", "@", "\t", "\r")
_SHORT = 24
_MOST_BESIDE = 2
"""With more such columns, intervals stand below their means also where there is room."""


def render_table(table: Table, title: str) -> Rendered:
    """Return a table as HTML, plain text, CSV (full precision) and LaTeX (booktabs).

    A column whose numbers are all the same is left out, except in the CSV, and stated below. Texts
    in the CSV that a spreadsheet would take for a formula, as they begin with ``=``, ``+``, ``-``
    or ``@`` and are not numbers, begin with an apostrophe there.
    """
    return _rendered(table, "", title)


def render_table_in_run(table: Table, title: str, origin: Provenance) -> Rendered:
    """Return a table as `render_table` does, with the caption that the graph gives it."""
    info = info_of(table)
    told = replace(info, answer=in_authors_words(info.answer, origin.answer))
    return _rendered(with_info(table, told), origin.caption, title)


def _rendered(table: pd.DataFrame, words: str, title: str) -> Rendered:
    table = _with_named_rows(table)
    info = info_of(table)
    caption = words or info.title or title
    columns, constants = without_constants(seen_columns(table))
    notes = [*constants, *info.notes]
    csv = _csv(table)
    cards = bool(info.answer.cards)
    return Rendered(
        html=_html(caption, columns, info, notes, csv.decode()),
        text=_text(columns, notes),
        files={".csv": csv, ".tex": latex_of(table, caption).encode()},
        answer=info.answer.lines,
        lead=answer_html(info.answer, words) if cards else "",
        styles=(lead_style(),) if cards else (),
        grid=grid_of(table, info.title or caption),
        title=info.title,
        kind="table",
    )


def _csv(table: pd.DataFrame) -> bytes:
    from pandas.api.types import is_numeric_dtype

    guarded = table.rename(columns=_without_formula)
    for place, kind in enumerate(table.dtypes):
        if not is_numeric_dtype(kind):
            guarded.isetitem(place, list(map(_without_formula, table.iloc[:, place])))
    return guarded.to_csv(index=False, lineterminator="\n").encode()


def _without_formula(cell: object) -> object:
    if not isinstance(cell, str) or not cell.startswith(_FORMULAS):
        return cell
    try:
        float(cell)
    except ValueError:
        return f"'{cell}"
    return cell


def _with_named_rows(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table with the names of its rows, if it has any, as its first columns."""
    import pandas as pd

    if isinstance(table.index, pd.RangeIndex) and table.index.name is None:
        return table
    return with_info(table.reset_index(), info_of(table))


def _html(
    caption: str, columns: Sequence[Column], info: TableInfo, notes: Sequence[str], csv: str
) -> str:
    """Return the table for a page, whose script sorts, filters, folds and copies it."""
    rows = _rows(columns)
    labels = [column for column in columns if column.label]
    classes = [_column_classes(column, last=labels[-1:] == [column]) for column in columns]
    head = "".join(_head(*both) for both in zip(columns, classes, strict=True))
    groups = list(zip(*(tuple(map(str, column.cells)) for column in labels[:-1]), strict=True))
    compared = [column.cells for column in columns if column.name == info.compared]
    best = [at for at, row in enumerate(rows) if any(cell.best for cell in row)]
    tied = [at for at, row in enumerate(rows) if any(cell.tied for cell in row)]
    folded = _folded(groups, len(rows), best, tied, info.highlights)
    # where several columns have marks, one is about a cell
    marked = [column for column in columns if any(cell.best or cell.tied for cell in column.cells)]
    leads = {*best, *tied} if len(marked) == 1 else set()

    def row_class(place: int) -> str:
        begins = place > 0 and bool(groups) and groups[place] != groups[place - 1]
        kinds = {"group": begins, "tied": place in leads, "rest": place in folded}
        return _class([kind for kind, applies in kinds.items() if applies])

    body = "".join(
        f"<tr{row_class(place)}{_method(compared, place)}>{_row(row, columns, classes)}</tr>"
        for place, row in enumerate(rows[:_MOST_ROWS])
    )
    stacked = sum(column.has_intervals for column in columns) > _MOST_BESIDE
    kinds = ["table", *(["stacked"] if stacked else []), *(["folded"] if folded else [])]
    more = f' data-more="{len(folded)}"' if folded else ""
    kept = ["csv", *(["whole"] if any(info.layout) else [])]
    cut = [f"The first {_MOST_ROWS} of {len(rows)} rows; the CSV file has all."]
    if any(unit == SHARE for unit in info.units.values()):
        notes = [*notes, "Percentages are shares in the CSV file: 0.49 for 49 %."]
    return (
        f'<figure{_class(kinds)}{more}><div class="scroll"><table class="sortable">'
        f"<caption>{escape(caption)}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
        f"</div><template{_class(kept)}>{escape(csv, quote=False)}</template>"
        f"{_notes([*(cut if len(rows) > _MOST_ROWS else []), *notes])}</figure>"
    )


def _notes(notes: Sequence[str]) -> str:
    """Return remarks; many are folded."""
    items = "".join(f"<li>{escape(note)}</li>" for note in notes)
    if len(notes) > _FEW_NOTES:
        summary = "What the numbers mean"
        return f'<details><summary>{summary}</summary><ul class="quiet">{items}</ul></details>'
    return f'<ul class="quiet">{items}</ul>' if items else ""


def _folded(
    groups: Sequence[object],
    count: int,
    best: Sequence[int],
    all_tied: Sequence[int],
    highlights: Sequence[int],
) -> set[int]:
    """Return the rows that a folded table leaves out, none of a short one.

    Of each group it shows the best, those that are tied with it, and what else is highlighted; the
    first rows where nothing is marked.
    """
    if count <= _SHORT_TABLE:
        return set()
    starts = [at for at in range(count) if at == 0 or (groups and groups[at] != groups[at - 1])]
    few = _FEW_ROWS if len(starts) > 1 else _SHORT_TABLE
    most = max(1, _SHOWN_ROWS // len(starts))
    shown: set[int] = set()
    for start, end in zip(starts[:_SHOWN_ROWS], [*starts[1:], count], strict=False):
        tied = [at for at in all_tied if start <= at < end]
        marked = [*best, *tied[:1], *highlights, *tied]
        of_group = dict.fromkeys(at for at in marked if start <= at < end)
        shown |= {*[*(of_group or range(start, min(end, start + few)))][:most]}
    return {*range(count)} - shown


def _method(compared: Sequence[Sequence[CellText]], place: int) -> str:
    return "".join(f' data-method="{escape(cells[place].text, quote=True)}"' for cells in compared)


def _column_classes(column: Column, *, last: bool) -> list[str]:
    """Return the classes of a column; the last label stays in sight while the others scroll."""
    return [*(["number"] if column.numeric else []), *(["name"] if last else [])]


def _head(column: Column, classes: Sequence[str]) -> str:
    """Return a column's head, with its place in the CSV."""
    unit = f'<span class="unit"> [{escape(column.unit)}]</span>' if column.unit else ""
    # a long name may be broken where its words end
    name = escape(column.title).replace("_", "_<wbr>")
    return f'<th scope="col"{_class(classes)} data-column="{column.place}">{name}{unit}</th>'


def _row(cells: Iterable[CellText], columns: Iterable[Column], classes: Iterable[list[str]]) -> str:
    return "".join(
        f"<{tag}{_class([*kinds, *_cell_classes(cell, column)])}>{_cell_html(cell)}</{end}>"
        for cell, column, kinds in zip(cells, columns, classes, strict=True)
        for tag, end in [('th scope="row"', "th") if column.label else ("td", "td")]
    )


def _cell_classes(cell: CellText, column: Column) -> list[str]:
    """Return the classes of what is not broken into lines, and of numbers that are tied."""
    short = not column.numeric and 0 < len(cell.text) <= _SHORT
    return [*(["short"] if short else []), *(["tied"] if cell.tied else [])]


def _class(classes: Sequence[str]) -> str:
    return f' class="{" ".join(classes)}"' if classes else ""


def _cell_html(cell: CellText) -> str:
    text = f"<strong>{escape(cell.text)}</strong>" if cell.best else escape(cell.text)
    return f"{text} <br><small>{escape(cell.beside)}</small>" if cell.beside else text


def _text(columns: Sequence[Column], notes: Iterable[str]) -> str:
    rows = _rows(columns)
    grid = [
        [column.head for column in columns],
        *([f"{cell}{'*' * cell.best}" for cell in row] for row in rows[:_MOST_LINES]),
    ]
    widths = [max(len(text) for text in column) for column in zip(*grid, strict=True)]
    lines = [
        "  ".join(
            text.rjust(width) if column.numeric else text.ljust(width)
            for text, width, column in zip(texts, widths, columns, strict=True)
        ).rstrip()
        for texts in grid
    ]
    if len(rows) > _MOST_LINES:
        lines.append(f"... {len(rows) - _MOST_LINES} more rows in the CSV file")
    if any(cell.best for row in rows for cell in row):
        lines.append("* the best of its group")
    return "\n".join([*lines, *notes])


def _rows(columns: Sequence[Column]) -> list[tuple[CellText, ...]]:
    return list(zip(*(column.cells for column in columns), strict=True))

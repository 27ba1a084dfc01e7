"""Tables in a report, in a terminal, and as CSV and LaTeX files."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING, Any

from nodegraph import Rendered
from nodegraph_tables.cells import Cell, Column, columns_of
from nodegraph_tables.grid import grid_of
from nodegraph_tables.info import info_of, with_info
from nodegraph_tables.types import Table

if TYPE_CHECKING:
    import pandas as pd

_FOLDED_FROM = 200
"""Rows from which a table is folded in the page and cut in a terminal."""

_FORMULAS = ("=", "+", "-", "@", "\t", "\r")
_SHORT = 24
_MOST_BESIDE = 2
"""With more such columns, intervals stand below their means also where there is room."""

_LATEX = str.maketrans(
    {
        "\\": r"\textbackslash{}",
        "&": r"\&",
        "%": r"\%",
        "$": r"\$",
        "#": r"\#",
        "_": r"\_",
        "{": r"\{",
        "}": r"\}",
        "~": r"\textasciitilde{}",
        "^": r"\textasciicircum{}",
        "<": r"\textless{}",
        ">": r"\textgreater{}",
        # these two would be taken for an option where a row begins
        "[": "{[}",
        "*": "{*}",
        "\N{DAGGER}": r"\textdagger{}",
        "\N{SUPERSCRIPT TWO}": r"\textsuperscript{2}",
        "\N{SUPERSCRIPT THREE}": r"\textsuperscript{3}",
    }
)


def render_table(table: Table, title: str) -> Rendered:
    """Return a table as HTML, plain text, CSV (full precision) and LaTeX (booktabs).

    Texts in the CSV that a spreadsheet would take for a formula, as they begin with ``=``, ``+``,
    ``-`` or ``@`` and are no numbers, begin with an apostrophe there.
    """
    table = _with_named_rows(table)
    columns, info = columns_of(table), info_of(table)
    caption = info.title or title
    return Rendered(
        html=_html(caption, columns, info.notes),
        text=_text(columns, info.notes),
        files={
            ".csv": _csv(table),
            ".tex": _latex(caption, columns).encode(),
        },
        answer=info.answer,
        grid=grid_of(table, caption),
    )


def _csv(table: pd.DataFrame) -> bytes:
    from pandas.api.types import is_numeric_dtype

    guarded = table.rename(columns=_without_formula)
    for place, kind in enumerate(table.dtypes):
        if not is_numeric_dtype(kind):
            guarded.isetitem(place, list(map(_without_formula, table.iloc[:, place])))
    return guarded.to_csv(index=False, lineterminator="\n").encode()


def _without_formula(cell: Any) -> Any:
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


def _html(caption: str, columns: Sequence[Column], notes: Iterable[str]) -> str:
    labels = [column for column in columns if column.label]
    classes = [_column_classes(column, last=labels[-1:] == [column]) for column in columns]
    head = "".join(_head(*both) for both in zip(columns, classes, strict=True))
    rows = _rows(columns)
    groups = list(zip(*(tuple(map(str, column.cells)) for column in labels[:-1]), strict=True))
    body = "".join(
        f"<tr{_group_class(groups, place)}>{_row(row, columns, classes)}</tr>"
        for place, row in enumerate(rows)
    )
    stacked = " stacked" * (sum(len(column.places) > 1 for column in columns) > _MOST_BESIDE)
    table = (
        f'<figure class="table{stacked}"><table class="sortable">'
        f"<caption>{escape(caption)}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></figure>"
    )
    if len(rows) > _FOLDED_FROM:
        table = f"<details><summary>{len(rows)} rows</summary>{table}</details>"
    items = "".join(f"<li>{escape(note)}</li>" for note in notes)
    return table + (f'<ul class="quiet">{items}</ul>' if items else "")


def _column_classes(column: Column, *, last: bool) -> list[str]:
    """Return the classes of a column; the last label stays in sight while the others scroll."""
    return [*(["number"] if column.numeric else []), *(["name"] if last else [])]


def _head(column: Column, classes: Sequence[str]) -> str:
    """Return a column's head; a copy as CSV takes its names from the attribute."""
    names = escape(json.dumps(column.places), quote=True)
    unit = f'<span class="unit"> [{escape(column.unit)}]</span>' if column.unit else ""
    # a long name may be broken where its words end
    name = escape(column.name).replace("_", "_<wbr>")
    return f'<th scope="col"{_class(classes)} data-names="{names}">{name}{unit}</th>'


def _row(cells: Iterable[Cell], columns: Iterable[Column], classes: Iterable[list[str]]) -> str:
    return "".join(
        f"<{tag}{_class([*kinds, *_cell_classes(cell, column)])}{_exact(cell)}>"
        f"{_cell_html(cell)}</{end}>"
        for cell, column, kinds in zip(cells, columns, classes, strict=True)
        for tag, end in [('th scope="row"', "th") if column.label else ("td", "td")]
    )


def _cell_classes(cell: Cell, column: Column) -> list[str]:
    """Return the class of a text that is not broken into lines."""
    return ["short"] if not column.numeric and 0 < len(cell.text) <= _SHORT else []


def _class(classes: Sequence[str]) -> str:
    return f' class="{" ".join(classes)}"' if classes else ""


def _group_class(groups: Sequence[object], place: int) -> str:
    """Return the class of a row with which another group begins."""
    begins = place > 0 and groups and groups[place] != groups[place - 1]
    return ' class="group"' if begins else ""


def _cell_html(cell: Cell) -> str:
    text = f"<strong>{escape(cell.text)}</strong>" if cell.best else escape(cell.text)
    return f"{text} <br><small>{escape(cell.beside)}</small>" if cell.beside else text


def _exact(cell: Cell) -> str:
    """Return the attributes that keep all digits of numbers shown with fewer."""
    value = f' data-value="{cell.exact}"' if cell.exact else ""
    return value + (f' data-within="{",".join(cell.within)}"' if cell.within else "")


def _text(columns: Sequence[Column], notes: Iterable[str]) -> str:
    rows = _rows(columns)
    grid = [
        [column.head for column in columns],
        *([f"{cell}{'*' * cell.best}" for cell in row] for row in rows[:_FOLDED_FROM]),
    ]
    widths = [max(len(text) for text in column) for column in zip(*grid, strict=True)]
    lines = [
        "  ".join(
            text.rjust(width) if column.numeric else text.ljust(width)
            for text, width, column in zip(texts, widths, columns, strict=True)
        ).rstrip()
        for texts in grid
    ]
    if len(rows) > _FOLDED_FROM:
        lines.append(f"... {len(rows) - _FOLDED_FROM} more rows in the CSV file")
    if any(cell.best for row in rows for cell in row):
        lines.append("* the best of its group")
    return "\n".join([*lines, *notes])


def _latex(caption: str, columns: Sequence[Column]) -> str:
    alignment = "".join("r" if column.numeric else "l" for column in columns)
    rows = [" & ".join(_cell_latex(cell) for cell in row) + r" \\" for row in _rows(columns)]
    head = " & ".join(column.head.translate(_LATEX) for column in columns) + r" \\"
    # An empty line would end the caption's paragraph, which LaTeX refuses.
    caption = " ".join(caption.split())
    return "\n".join(
        [
            r"% needs \usepackage{booktabs}",
            r"\begin{table}",
            rf"\caption{{{caption.translate(_LATEX)}}}",
            rf"\begin{{tabular}}{{{alignment}}}",
            r"\toprule",
            head,
            r"\midrule",
            *rows,
            r"\bottomrule",
            r"\end{tabular}",
            r"\end{table}",
            "",
        ]
    )


def _cell_latex(cell: Cell) -> str:
    text = cell.text.translate(_LATEX)
    text = rf"\textbf{{{text}}}" if cell.best else text
    return f"{text} {cell.beside.translate(_LATEX)}".rstrip()


def _rows(columns: Sequence[Column]) -> list[tuple[Cell, ...]]:
    return list(zip(*(column.cells for column in columns), strict=True))

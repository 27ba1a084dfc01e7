"""How tables and figures appear: in the report, in a terminal, as files beside the report."""

from __future__ import annotations

import hashlib
import json
import re
import warnings
from collections.abc import Iterable, Sequence
from html import escape
from io import BytesIO
from threading import Lock
from typing import TYPE_CHECKING

from nodegraph import Rendered, Renderer, listed
from nodegraph_tables.cells import Cell, Column, columns_of
from nodegraph_tables.stored_figure import StoredFigure
from nodegraph_tables.types import Figure, Table

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.mathtext import MathTextParser, VectorParse
    from matplotlib.text import Text


def keep_what_is_no_formula(figure: Figure) -> None:
    r"""Have texts of a figure drawn as they stand whose ``$`` signs enclose no formula.

    Nodes should pass names through `nodegraph_mocap.figure_text`. Where one does not, a name such
    as ``$\frac$`` would cost the whole figure. A formula that can be set stays one: an author may
    have meant it.

    Warns
    -----
    UserWarning
        With the texts.
    """
    from matplotlib.mathtext import MathTextParser
    from matplotlib.text import Text

    parser = MathTextParser("path")
    texts = [one for one in figure.findobj(Text) if isinstance(one, Text)]
    broken = [one for one in texts if one.get_parse_math() and _is_broken(one, parser)]
    for text in broken:
        text.set_parse_math(False)
    if broken:
        told = listed(dict.fromkeys(" ".join(one.get_text().split()) for one in broken))
        warnings.warn(f"drawn as text, as no formula: {told}", stacklevel=2)


def _is_broken(text: Text, parser: MathTextParser[VectorParse]) -> bool:
    """Return whether matplotlib takes a line of a text for a formula and cannot set it."""
    return not text.get_usetex() and not all(
        _can_be_set(line, parser) for line in text.get_text().split("\n")
    )


def _can_be_set(line: str, parser: MathTextParser[VectorParse]) -> bool:
    from matplotlib.cbook import is_math_text

    if not is_math_text(line):
        return True
    try:
        parser.parse(line)
    except ValueError:
        return False
    return True


_FOLDED_FROM = 200
_SHORT = 24
_MOST_BESIDE = 2
"""With more such columns, intervals stand below their means also where there is room."""
_DRAWING = Lock()
"""Held while matplotlib's settings, which all threads share, are others than the user's."""

_TAG = re.compile(r"<[a-zA-Z][^>]*>")
_WIDTH = re.compile(r'<svg[^>]*\swidth="([\d.]+(?:pt|px))"')
_ID = re.compile(r"""(\sid="|href="#|url\(#)""")
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


def renderers() -> tuple[Renderer, ...]:
    """Return the renderers of the types that are not this package's own classes."""
    return (
        Renderer(Table, render_table),
        Renderer(Figure, render_figure),
        Renderer(StoredFigure, render_stored_figure),
    )


def render_table(table: Table, title: str) -> Rendered:
    """Return a table as HTML, plain text, CSV (full precision) and LaTeX (booktabs)."""
    table = _with_named_rows(table)
    columns = columns_of(table)
    notes = [str(one) for one in table.attrs.get("notes", ())]
    caption = str(table.attrs.get("title", title))
    return Rendered(
        html=_html(caption, columns, notes),
        text=_text(columns, notes),
        files={
            ".csv": table.to_csv(index=False, lineterminator="\n").encode(),
            ".tex": _latex(caption, columns).encode(),
        },
    )


def render_figure(figure: Figure, title: str) -> Rendered:
    """Return a figure as SVG in the page, and as SVG and PDF beside it; the same every time."""
    return render_stored_figure(StoredFigure(saved(figure, "svg"), saved(figure, "pdf")), title)


def render_stored_figure(figure: StoredFigure, title: str) -> Rendered:
    """Return a figure that was drawn before, the same as if it were drawn now."""
    drawing = _with_own_ids(figure.svg.decode())
    label = f'<svg role="img" aria-label="{escape(title, quote=True)}"'
    wide = _WIDTH.search(drawing)
    size = f' style="--wide: {wide[1]}"' if wide else ""
    html = f'<figure class="figure"{size}>{drawing.replace("<svg", label, 1)}</figure>'
    return Rendered(html=html, files={".svg": figure.svg, ".pdf": figure.pdf})


def saved(figure: Figure, form: str) -> bytes:
    """Return a figure as ``svg`` or ``pdf``; the same bytes for the same figure, in any thread."""
    import matplotlib as mpl

    target = BytesIO()
    undated = {"Date": None} if form == "svg" else {"CreationDate": None}
    # without a salt of its own, a drawing would have other ids each time
    with _DRAWING, mpl.rc_context({"svg.hashsalt": "nodegraph", "svg.fonttype": "none"}):
        keep_what_is_no_formula(figure)
        figure.savefig(target, format=form, metadata=undated, bbox_inches="tight")
    return target.getvalue()


def _with_named_rows(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table with its rows' names, if it has any, as its first columns."""
    import pandas as pd

    if isinstance(table.index, pd.RangeIndex) and table.index.name is None:
        return table
    named = table.reset_index()
    named.attrs = table.attrs
    return named


def _html(caption: str, columns: Sequence[Column], notes: Iterable[str]) -> str:
    labels = [one for one in columns if one.label]
    kinds = [_kinds(one, last=labels[-1:] == [one]) for one in columns]
    head = "".join(_head(one, kind) for one, kind in zip(columns, kinds, strict=True))
    rows = _rows(columns)
    groups = list(zip(*(tuple(map(str, one.cells)) for one in labels[:-1]), strict=True))
    body = "".join(
        f"<tr{_first(groups, place)}>{_row(row, columns, kinds)}</tr>"
        for place, row in enumerate(rows)
    )
    stacked = " stacked" * (sum(len(one.places) > 1 for one in columns) > _MOST_BESIDE)
    table = (
        f'<figure class="table{stacked}"><table class="sortable">'
        f"<caption>{escape(caption)}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></figure>"
    )
    if len(rows) > _FOLDED_FROM:
        table = f"<details><summary>{len(rows)} rows</summary>{table}</details>"
    said = "".join(f"<li>{escape(note)}</li>" for note in notes)
    return table + (f'<ul class="quiet">{said}</ul>' if said else "")


def _kinds(column: Column, *, last: bool) -> list[str]:
    """Return the classes of a column; the last label stays in sight while the others scroll."""
    return [*(["number"] if column.numeric else []), *(["name"] if last else [])]


def _head(column: Column, kinds: Sequence[str]) -> str:
    """Return a column's head; a copy as CSV takes its names from the attribute."""
    names = escape(json.dumps(column.places), quote=True)
    unit = f'<span class="unit"> [{escape(column.unit)}]</span>' if column.unit else ""
    # a long name may be broken where its words end
    name = escape(column.name).replace("_", "_<wbr>")
    return f'<th scope="col"{_classes(kinds)} data-names="{names}">{name}{unit}</th>'


def _row(cells: Iterable[Cell], columns: Iterable[Column], kinds: Iterable[list[str]]) -> str:
    return "".join(
        f"<{tag}{_classes([*kind, *_short(cell, column)])}{_exact(cell)}>{_marked(cell)}</{end}>"
        for cell, column, kind in zip(cells, columns, kinds, strict=True)
        for tag, end in [('th scope="row"', "th") if column.label else ("td", "td")]
    )


def _short(cell: Cell, column: Column) -> list[str]:
    """Return the class of a text that is not broken into lines."""
    return ["short"] if not column.numeric and 0 < len(cell.text) <= _SHORT else []


def _classes(kinds: Sequence[str]) -> str:
    return f' class="{" ".join(kinds)}"' if kinds else ""


def _first(groups: Sequence[object], place: int) -> str:
    """Return the class of a row with which another group begins."""
    begins = place > 0 and groups and groups[place] != groups[place - 1]
    return ' class="group"' if begins else ""


def _text(columns: Sequence[Column], notes: Iterable[str]) -> str:
    rows = _rows(columns)
    lines = [
        [one.head for one in columns],
        *([f"{cell}{'*' * cell.best}" for cell in row] for row in rows[:_FOLDED_FROM]),
    ]
    widths = [max(len(text) for text in column) for column in zip(*lines, strict=True)]
    told = [
        "  ".join(
            text.rjust(width) if column.numeric else text.ljust(width)
            for text, width, column in zip(line, widths, columns, strict=True)
        ).rstrip()
        for line in lines
    ]
    if len(rows) > _FOLDED_FROM:
        told.append(f"... {len(rows) - _FOLDED_FROM} more rows in the CSV file")
    if any(cell.best for row in rows for cell in row):
        told.append("* the best of its group")
    return "\n".join([*told, *notes])


def _latex(caption: str, columns: Sequence[Column]) -> str:
    kinds = "".join("r" if one.numeric else "l" for one in columns)
    rows = [" & ".join(_bold(cell) for cell in row) + r" \\" for row in _rows(columns)]
    head = " & ".join(one.head.translate(_LATEX) for one in columns) + r" \\"
    # An empty line would end the caption's paragraph, which LaTeX refuses.
    caption = " ".join(caption.split())
    return "\n".join(
        [
            r"% needs \usepackage{booktabs}",
            r"\begin{table}",
            rf"\caption{{{caption.translate(_LATEX)}}}",
            rf"\begin{{tabular}}{{{kinds}}}",
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


def _rows(columns: Sequence[Column]) -> list[tuple[Cell, ...]]:
    return list(zip(*(one.cells for one in columns), strict=True))


def _marked(cell: Cell) -> str:
    text = f"<strong>{escape(cell.text)}</strong>" if cell.best else escape(cell.text)
    return f"{text} <br><small>{escape(cell.beside)}</small>" if cell.beside else text


def _exact(cell: Cell) -> str:
    """Return the attributes that keep all digits of numbers shown with fewer."""
    value = f' data-value="{cell.exact}"' if cell.exact else ""
    return value + (f' data-within="{",".join(cell.within)}"' if cell.within else "")


def _bold(cell: Cell) -> str:
    text = cell.text.translate(_LATEX)
    text = rf"\textbf{{{text}}}" if cell.best else text
    return f"{text} {cell.beside.translate(_LATEX)}".rstrip()


def _with_own_ids(svg: str) -> str:
    """Return a drawing whose ids no other drawing on a page has, unless the two are equal."""
    drawing = svg[svg.index("<svg") :]
    mark = "f" + hashlib.sha256(drawing.encode()).hexdigest()[:12]
    return _TAG.sub(lambda tag: _ID.sub(rf"\g<1>{mark}-", tag[0]), drawing)

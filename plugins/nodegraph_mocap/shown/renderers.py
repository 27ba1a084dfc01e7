"""How tables and figures appear: in the report, in a terminal, as files beside the report."""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Iterable
from html import escape
from io import BytesIO
from threading import Lock
from typing import TYPE_CHECKING, Any

from nodegraph import Rendered, Renderer
from nodegraph_mocap.shown.stored_figure import StoredFigure
from nodegraph_mocap.tables import Figure, Table

if TYPE_CHECKING:
    import pandas as pd

_FOLDED_FROM = 200
_DRAWING = Lock()
"""Held while matplotlib's settings, which all threads share, are others than the user's."""

_TAG = re.compile(r"<[a-zA-Z][^>]*>")
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
    heads = _heads(table)
    cells = [[shown(value) for value in row] for row in table.itertuples(index=False, name=None)]
    numeric = [kind.kind in "iuf" for kind in table.dtypes]
    notes = [str(one) for one in table.attrs.get("notes", ())]
    caption = str(table.attrs.get("title", title))
    return Rendered(
        html=_html(caption, heads, cells, numeric, notes),
        text=_text(heads, cells, numeric, notes),
        files={
            ".csv": table.to_csv(index=False, lineterminator="\n").encode(),
            ".tex": _latex(caption, heads, cells, numeric).encode(),
        },
    )


def render_figure(figure: Figure, title: str) -> Rendered:
    """Return a figure as SVG in the page, and as SVG and PDF beside it; the same every time."""
    return render_stored_figure(StoredFigure(saved(figure, "svg"), saved(figure, "pdf")), title)


def render_stored_figure(figure: StoredFigure, title: str) -> Rendered:
    """Return a figure that was drawn before, the same as if it were drawn now."""
    drawing = _with_own_ids(figure.svg.decode())
    label = f'<svg role="img" aria-label="{escape(title, quote=True)}"'
    html = f'<figure class="figure">{drawing.replace("<svg", label, 1)}</figure>'
    return Rendered(html=html, files={".svg": figure.svg, ".pdf": figure.pdf})


def saved(figure: Figure, form: str) -> bytes:
    """Return a figure as ``svg`` or ``pdf``; the same bytes for the same figure, in any thread."""
    import matplotlib as mpl

    target = BytesIO()
    undated = {"Date": None} if form == "svg" else {"CreationDate": None}
    # without a salt of its own, a drawing would have other ids each time
    with _DRAWING, mpl.rc_context({"svg.hashsalt": "nodegraph", "svg.fonttype": "none"}):
        figure.savefig(target, format=form, metadata=undated, bbox_inches="tight")
    return target.getvalue()


def shown(value: Any) -> str:
    """Return a cell's value for a reader: four digits that count, nothing where there is none."""
    if value is None or type(value).__name__ in ("NAType", "NaTType"):
        return ""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return str(value)
    if math.isnan(value):
        return ""
    if isinstance(value, int) or (value.is_integer() and abs(value) < 1e6):
        return f"{value:.0f}" if isinstance(value, float) else str(value)
    if value != 0 and (abs(value) < 1e-3 or abs(value) >= 1e6):
        return f"{value:.2e}"
    return f"{value:.{max(0, min(4, 3 - math.floor(math.log10(abs(value)))))}f}"


def _heads(table: pd.DataFrame) -> list[str]:
    units = table.attrs.get("units", {})
    return [
        f"{column} [{units[column]}]" if units.get(column) else str(column)
        for column in table.columns
    ]


def _with_named_rows(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table with its rows' names, if it has any, as its first columns."""
    import pandas as pd

    if isinstance(table.index, pd.RangeIndex) and table.index.name is None:
        return table
    named = table.reset_index()
    named.attrs = table.attrs
    return named


def _html(
    caption: str,
    heads: list[str],
    cells: list[list[str]],
    numeric: list[bool],
    notes: Iterable[str],
) -> str:
    classes = [' class="number"' if one else "" for one in numeric]
    head = "".join(
        f'<th scope="col"{kind}>{escape(text)}</th>'
        for text, kind in zip(heads, classes, strict=True)
    )
    rows = "".join(
        "<tr>"
        + "".join(f"<td{kind}>{escape(text)}</td>" for text, kind in zip(row, classes, strict=True))
        + "</tr>"
        for row in cells
    )
    table = (
        f'<figure class="table"><table class="sortable"><caption>{escape(caption)}</caption>'
        f"<thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></figure>"
    )
    if len(cells) > _FOLDED_FROM:
        table = f"<details><summary>{len(cells)} rows</summary>{table}</details>"
    said = "".join(f"<li>{escape(note)}</li>" for note in notes)
    return table + (f'<ul class="quiet">{said}</ul>' if said else "")


def _text(
    heads: list[str], cells: list[list[str]], numeric: list[bool], notes: Iterable[str]
) -> str:
    rows = [heads, *cells[:_FOLDED_FROM]]
    widths = [max(len(row[i]) for row in rows) for i in range(len(heads))]
    lines = [
        "  ".join(
            text.rjust(width) if number else text.ljust(width)
            for text, width, number in zip(row, widths, numeric, strict=True)
        ).rstrip()
        for row in rows
    ]
    if len(cells) > _FOLDED_FROM:
        lines.append(f"... {len(cells) - _FOLDED_FROM} more rows in the CSV file")
    return "\n".join([*lines, *notes])


def _latex(caption: str, heads: list[str], cells: list[list[str]], numeric: list[bool]) -> str:
    columns = "".join("r" if one else "l" for one in numeric)
    rows = [" & ".join(text.translate(_LATEX) for text in row) + r" \\" for row in cells]
    head = " & ".join(text.translate(_LATEX) for text in heads) + r" \\"
    # An empty line would end the caption's paragraph, which LaTeX refuses.
    caption = " ".join(caption.split())
    return "\n".join(
        [
            r"% needs \usepackage{booktabs}",
            r"\begin{table}",
            rf"\caption{{{caption.translate(_LATEX)}}}",
            rf"\begin{{tabular}}{{{columns}}}",
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


def _with_own_ids(svg: str) -> str:
    """Return a drawing whose ids no other drawing on a page has, unless the two are equal."""
    drawing = svg[svg.index("<svg") :]
    mark = "f" + hashlib.sha256(drawing.encode()).hexdigest()[:12]
    return _TAG.sub(lambda tag: _ID.sub(rf"\g<1>{mark}-", tag[0]), drawing)

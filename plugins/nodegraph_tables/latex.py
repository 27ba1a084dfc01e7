"""Tables as a paper prints them: LaTeX with booktabs."""

from __future__ import annotations

import re
from itertools import groupby, zip_longest
from textwrap import wrap
from typing import TYPE_CHECKING

from nodegraph import listed
from nodegraph_tables.cells import ALL, columns_of
from nodegraph_tables.crosstab import Crosstab, crosstab
from nodegraph_tables.info import info_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    import pandas as pd

    from nodegraph_tables.cells import CellText, Column

_MOST_COLUMNS = 6
"""Columns of numbers with which a table is as wide as a page."""

_MOST_BESIDE = 2
"""With more columns, intervals stand below their means."""

_MOST_ACROSS, _MOST_LINES = 100, 30
"""A table of more characters across, but no more lines, stands sideways on its page."""

_SMALL = 0.8
"""Width of a letter of an interval below its mean, in letters of the table."""

_TIE = "\N{NO-BREAK SPACE}"
_ESCAPES = str.maketrans(
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
        _TIE: "~",
        "\N{DAGGER}": r"\textdagger{}",
        "\N{MINUS SIGN}": "$-$",
        "\N{SUPERSCRIPT MINUS}": r"\textsuperscript{$-$}",
        **{sign: rf"\textsuperscript{{{digit}}}" for digit, sign in enumerate("⁰¹²³⁴⁵⁶⁷⁸⁹")},
    }
)
_COMMAND = re.compile(r"\\[a-z]+(\[\w\])?|[{}$]")
_POWER = re.compile(r"(\d[\d.]*)e\+?(-?)0*(\d+)")
_MINUS = re.compile(r"(?<![\w.])-(?=\d)")


def latex_of(
    table: pd.DataFrame, caption: str, rows: Sequence[str] = (), columns: Sequence[str] = ()
) -> str:
    """Return a table for a paper.

    A table in which the best is marked has a row per method and a column per group, with the mean
    and its interval in each cell. Columns that are the same throughout are stated in the caption,
    and what the table's answer holds for.

    Parameters
    ----------
    table
    caption
    rows, columns
        Labels that stand down the side, and along the top: see `crosstab`.

    Raises
    ------
    ValueError
        If a name is no label, or is given twice, or the table cannot be laid out anew.
    """
    held = info_of(table).answer.held
    crossed = crosstab(table, rows, columns, most=_MOST_COLUMNS, in_print=True)
    if crossed is None:
        varying, constants = without_constants(columns_of(table, in_print=True), texts=True)
        return _document([caption, *constants, held], *_listed(varying))
    title = info_of(table).title or caption
    unit = f" [{crossed.unit}]" if crossed.unit else ""
    head = [f"{title}{unit}"] if caption == title else [caption, f"{title}{unit}"]
    crossed, constants = _without_constants(crossed)
    return _document([*head, *_legend(crossed), *constants, held], *_crossed(crossed))


def without_constants(
    columns: Sequence[Column], *, texts: bool = False
) -> tuple[list[Column], list[str]]:
    """Return the columns that differ between rows, and a sentence on the others.

    Parameters
    ----------
    columns
    texts
        Whether columns of text are left out, too.
    """

    def left_out(column: Column) -> bool:
        return column.constant or (
            texts and not column.numeric and len(column.cells) > 1 and len({*column.cells}) == 1
        )

    varying = [column for column in columns if not left_out(column)]
    if not any(column.numeric and not column.label for column in varying):
        return list(columns), []
    values = [
        (column.name, f"{column.cells[0]} {column.unit}".strip())
        for column in columns
        if left_out(column)
    ]
    return varying, _throughout(values)


def _throughout(values: Iterable[tuple[str, str]]) -> list[str]:
    together: dict[str, list[str]] = {}
    for name, value in values:
        together.setdefault(value or "empty", []).append(name)
    texts = [
        f"{listed(names)} {'is' if len(names) == 1 else 'are'} {value}"
        for value, names in together.items()
    ]
    return [f"{'; '.join(texts)} throughout."] if texts else []


def _without_constants(crossed: Crosstab) -> tuple[Crosstab, list[str]]:
    """Return a crosstab without labels that all rows, or all columns, have, and a sentence."""
    side, rows, fixed_side = _varying(crossed.side, crossed.rows)
    top, heads, fixed_top = _varying(crossed.top, crossed.heads)
    varying = Crosstab(side, top, rows, heads, crossed.columns, crossed.unit)
    return varying, _throughout([*fixed_top, *fixed_side])


def _varying(
    names: Sequence[str], labels: Sequence[Sequence[str]]
) -> tuple[tuple[str, ...], tuple[tuple[str, ...], ...], list[tuple[str, str]]]:
    fixed = [
        at
        for at in range(len(names) - 1)
        if len(labels) > 1 and len({each[at] for each in labels}) == 1
    ]
    kept = [at for at in range(len(names)) if at not in fixed]
    return (
        tuple(names[at] for at in kept),
        tuple(tuple(each[at] for at in kept) for each in labels),
        [(names[at], labels[0][at].removeprefix(f"{names[at]} ")) for at in fixed],
    )


def _legend(crossed: Crosstab) -> list[str]:
    """Return a sentence on what the marks mean that there are."""
    cells = [cell for column in crossed.columns for cell in column]
    besides = "".join(cell.beside for cell in cells)
    marks = {
        "in brackets: 95 % intervals": "[" in besides,
        "bold: the best": any(cell.best for cell in cells),
        "italic: may be the best": any(cell.tied for cell in cells),
        "\N{DAGGER}: clearly apart from the best, or the baseline": "\N{DAGGER}" in besides,
    }
    legend = "; ".join(text for text, applies in marks.items() if applies)
    return [f"{legend[0].upper()}{legend[1:]}."] if legend else []


def _document(caption: Sequence[str], columns: str, lines: Sequence[str]) -> str:
    sideways = _across(lines) > _MOST_ACROSS and len(lines) <= _MOST_LINES
    table = "sidewaystable" if sideways else "table"
    # an empty line would end the caption's paragraph, which LaTeX refuses
    sentences = (" ".join(text.split()) for text in caption if text.strip())
    ended = (text if text.endswith((".", "?", "!")) else f"{text}." for text in sentences)
    return "\n".join(
        [
            rf"% needs \usepackage{{booktabs,graphicx{',rotating' if sideways else ''}}}",
            rf"\begin{{{table}}}",
            r"\centering\small\setlength{\tabcolsep}{4pt}",
            rf"\caption{{{_text(' '.join(ended))}}}",
            # smaller where it would be wider or taller than the page, or the column of a journal
            r"\resizebox*{!}{\ifdim\totalheight>0.85\textheight 0.85\textheight"
            r"\else\totalheight\fi}{"
            r"\resizebox{\ifdim\width>\linewidth\linewidth\else\width\fi}{!}{"
            rf"\begin{{tabular}}{{{columns}}}",
            r"\toprule",
            *lines,
            r"\bottomrule",
            r"\end{tabular}}}",
            rf"\end{{{table}}}",
            "",
        ]
    )


def _across(lines: Iterable[str]) -> float:
    """Return about how many characters wide the lines of a table are."""
    rows = (line.split(" & ") for line in lines if " & " in line and r"\multicolumn" not in line)
    return sum(2 + max(map(_letters, column)) for column in zip_longest(*rows, fillvalue=""))


def _letters(cell: str) -> float:
    """Return how many letters of the size of the table are as wide as a cell."""
    size = _SMALL if cell.startswith(r"\scriptsize") else 1.0
    return size * max(len(_COMMAND.sub("", line)) for line in cell.split(r"\\"))


def _listed(columns: Sequence[Column]) -> tuple[str, list[str]]:
    """Return a row per row of the table."""
    rows = zip(*(column.cells for column in columns), strict=True)
    return "".join("r" if column.numeric else "l" for column in columns), [
        _line(map(_stacked, columns)),
        r"\midrule",
        *(
            _line(
                " ".join(filter(None, _parts(cell))) if column.numeric else _text(str(cell))
                for cell, column in zip(row, columns, strict=True)
            )
            for row in rows
        ),
    ]


def _stacked(column: Column) -> str:
    """Return the head of a column, in lines no longer than the longest of its words and cells."""
    unit = f" [{column.unit.replace(' ', _TIE)}]" if column.unit else ""
    head = f"{column.name}{unit}"
    longest = max(map(len, [*head.split(" "), *map(str, column.cells)]))
    lines = wrap(head, longest, break_long_words=False, break_on_hyphens=False)
    if len(lines) < 2:
        return _text(head)
    return rf"\shortstack[{'r' if column.numeric else 'l'}]{{" + r"\\".join(map(_text, lines)) + "}"


def _crossed(crossed: Crosstab) -> tuple[str, list[str]]:
    """Return a row per method, its intervals in the same row or in one of their own below."""
    intervals = any(cell.beside for column in crossed.columns for cell in column)
    beside = intervals and len(crossed.columns) <= _MOST_BESIDE
    wide = 2 if beside else 1
    stub = len(crossed.side)
    columns = "l" * stub + (r"r@{\ }l" if beside else "r") * len(crossed.columns)
    lines = list(_heads(crossed, wide))
    before: Sequence[str] = ()
    for at, labels in enumerate(crossed.rows):
        if before and labels[:-1] != before[:-1]:
            lines.append(r"\addlinespace")
        same = [a == b for a, b in zip(labels[:-1], before[:-1], strict=False)]
        shown = [
            "" if all(same[: place + 1]) and place < len(same) else _text(label)
            for place, label in enumerate(labels)
        ]
        cells = [column[at] for column in crossed.columns]
        if beside:
            lines.append(_line([*shown, *(part for cell in cells for part in _parts(cell))]))
        else:
            lines.append(_line([*shown, *map(_number, cells)]))
        if intervals and not beside:
            small = (rf"\scriptsize {_digits(cell.beside)}".rstrip() for cell in cells)
            lines.append(f"{_line([*[''] * stub, *small])}[2pt]")
        before = labels
    return columns, lines


def _heads(crossed: Crosstab, wide: int) -> Iterable[str]:
    """Yield the lines of the head: a label that several columns have stands over all of them."""
    stub = len(crossed.side)
    levels = len(crossed.top)
    for level in range(levels):
        last = level == levels - 1
        cells = [_text(name) for name in crossed.side] if last else [""] * stub
        rules, at = [], stub + 1
        for labels, alike in groupby(head[: level + 1] for head in crossed.heads):
            width = wide * len(list(alike))
            over_all = labels[level] == ALL and not last  # stands in the last line alone
            text = "" if over_all else _text(labels[level])
            cells.append(rf"\multicolumn{{{width}}}{{c}}{{{text}}}" if width > 1 else text)
            rules += [] if over_all else [rf"\cmidrule(lr){{{at}-{at + width - 1}}}"]
            at += width
        yield _line(cells)
        yield r"\midrule" if last else " ".join(rules)


def _line(cells: Iterable[str]) -> str:
    return " & ".join(cells).rstrip() + r" \\"


def _parts(cell: CellText) -> tuple[str, str]:
    return _number(cell), _digits(cell.beside)


def _number(cell: CellText) -> str:
    text = _digits(cell.text)
    if cell.best:
        return rf"\textbf{{{text}}}"
    return rf"\textit{{{text}}}" if cell.tied else text


def _digits(text: str) -> str:
    """Return numbers with signs and powers as they are printed."""
    signed = _MINUS.sub("\N{MINUS SIGN}", text)
    return _POWER.sub(r"$\1\\cdot10^{\2\3}$", _text(signed))


def _text(text: str) -> str:
    return text.translate(_ESCAPES)

"""The cells of a table as a reader sees them: rounded numbers, their intervals, the best marked."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from statistics import median_low
from typing import TYPE_CHECKING, Any, NamedTuple

from nodegraph_tables.info import info_of, with_info
from nodegraph_tables.numbers import chance_digits, without_rounding
from nodegraph_tables.style import CHANCE, SHARE, scale_of, unit_text

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    import pandas as pd

    from nodegraph_tables.info import Part

ALL = "all"
"""Stands for the labels of a row that is over all of them."""

_SIGNIFICANT = 0.05
_MOST_DECIMALS = 4
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_SMALLEST, _LARGEST = 1e-3, 1e6
"""Smaller and larger numbers are shown with a power of ten."""


class CellText(NamedTuple):
    """A cell as text, what belongs to it (an interval, a dagger), whether it is best or tied."""

    text: str
    beside: str
    best: bool
    tied: bool

    def __str__(self) -> str:
        return f"{self.text} {self.beside}".rstrip()


class Column(NamedTuple):
    """A column as it is shown.

    Attributes
    ----------
    name, unit : str
    place : int
        The place of the column in the table.
    numeric : bool
    label : bool
        Whether it identifies the rows.
    constant : bool
        Whether it is a number, and the same in all rows.
    cells : list of CellText
    """

    name: str
    unit: str
    place: int
    numeric: bool
    label: bool
    constant: bool
    cells: list[CellText]

    @property
    def head(self) -> str:
        """The name with the unit, if it has one."""
        return f"{self.title} [{self.unit}]" if self.unit else self.title

    @property
    def title(self) -> str:
        """The name; of a label that is a field, without that of its axis."""
        return self.name.rpartition(".")[2] if self.label else self.name

    @property
    def has_intervals(self) -> bool:
        """Whether there is anything next to the numbers."""
        return any(cell.beside for cell in self.cells)


def columns_of(table: pd.DataFrame, *, in_print: bool = False) -> list[Column]:
    """Return the columns that a reader sees.

    Columns that `TableInfo.cells` names are shown within the cells of another, as
    ``mean [low, high]``, with a dagger where their ``p`` is below 0.05; those of
    `TableInfo.unseen` are not shown.

    Parameters
    ----------
    table
    in_print
        Whether all numbers of a column, or of all columns in which the best is marked, have as
        many decimals as three digits of the median, and a power of a thousand in their unit where
        most are small or large; else each number has the digits that count.
    """
    info = info_of(table)
    cells = info.cells
    within = {*info.unseen, *(name for parts in cells.values() for name in parts.values())}
    return [
        _column(table, at, cells.get(name, {}), _form(table, name) if in_print else None)
        for at, name in enumerate(table.columns)
        if name not in within
    ]


def cells_at(
    table: pd.DataFrame, name: str, rows: Sequence[int | None], *, in_print: bool = False
) -> list[CellText]:
    """Return the cells of a column at some rows, an empty one for None, as of a table of its own.

    Parameters
    ----------
    table
    name
        Name of the column.
    rows
    in_print
        See `columns_of`.
    """
    info, places = info_of(table), [row for row in rows if row is not None]
    best, tied = (
        {name: tuple(at for at, row in enumerate(places) if row in marks.get(name, ()))}
        for marks in (info.best, info.tied)
    )
    part = with_info(table.iloc[places], replace(info, best=best, tied=tied, overall=()))
    at = list(table.columns).index(name)
    form = _form(table, name) if in_print else None
    cells = iter(_column(part, at, info.cells.get(name, {}), form).cells)
    return [
        CellText("", "", best=False, tied=False) if row is None else next(cells) for row in rows
    ]


class _Form(NamedTuple):
    """What all numbers of a column have in print: a power of ten, and so many decimals."""

    power: int = 0
    decimals: int | None = None


def _column(table: pd.DataFrame, at: int, parts: Mapping[Part, str], form: _Form | None) -> Column:
    name, column, info = table.columns[at], table.iloc[:, at], info_of(table)
    numeric = column.dtype.kind in "iuf"
    label = at == 0 and not numeric if info.labels is None else name in info.labels
    best, tied = set(info.best.get(name, ())), set(info.tied.get(name, ()))
    unit = info.units.get(name, "")
    power = form.power if form and not label else 0
    scale = scale_of(unit) * 10.0**-power if numeric else 1.0
    values = _scaled(column, scale)
    decimals = None if label or not numeric else form.decimals if form else _decimals(values)
    show = partial(shown, decimals=decimals, fixed=form is not None)
    texts = [_labelled(value) if label else show(value) for value in values]
    if unit == CHANCE:
        texts = [chance_digits(p) if text else "" for p, text in zip(values, texts, strict=True)]
    if label:
        texts = [
            ALL if not text and row in info.overall else text for row, text in enumerate(texts)
        ]
    rows = zip(texts, _beside(table, parts, show, texts, scale), strict=True)
    cells = [
        CellText(text, beside, row in best, row in tied) for row, (text, beside) in enumerate(rows)
    ]
    constant = numeric and not label and len(set(cells)) == 1 and len(cells) > 1
    constant = constant and column.nunique(dropna=False) == 1
    times = f"10{str(power).translate(_SUPERSCRIPTS)} " if power else ""
    printed = f"{times}{unit_text(unit)}".rstrip()
    return Column(str(name), printed, at, numeric, label, constant, cells)


def _scaled(column: pd.Series, scale: float) -> list[Any]:
    """Return multiples without what rounding adds: 100 x 0.07 is 7, and 1e-31 beside 30 is 0."""
    values = without_rounding(column.tolist())
    return values if scale == 1.0 else [round(scale * float(value), 12) for value in values]


def _decimals(values: Iterable[object]) -> int | None:
    """Return the number of decimals of a column, so that its decimal points are aligned.

    It gives three significant digits to the smallest of the numbers that are shown without a
    power of ten; None for whole numbers, and where there are no numbers.
    """
    sizes = [abs(x) for x in values if isinstance(x, float) and math.isfinite(x)]
    plain = [size for size in sizes if _SMALLEST <= size < _LARGEST]
    if not plain or all(size.is_integer() for size in sizes):
        return None
    return max(0, min(_MOST_DECIMALS, 2 - math.floor(math.log10(min(plain)))))


def _form(table: pd.DataFrame, name: str) -> _Form:
    """Return the form of a column's numbers in print."""
    info = info_of(table)
    names = list(info.best) if name in info.best else [name]
    unit = info.units.get(name, "")
    sizes = [
        scale_of(unit) * abs(value)
        for name in names
        for value in table[name].tolist()
        if isinstance(value, float) and math.isfinite(value) and value
    ]
    if not sizes or all(size.is_integer() for size in sizes):
        return _Form()
    digits = math.floor(math.log10(median_low(sizes)))
    is_plain = unit in (SHARE, CHANCE) or -2 <= digits < 6
    power = 0 if is_plain else 3 * math.floor((digits + 1) / 3)
    return _Form(power, max(0, 2 - digits + power))


def _labelled(value: object) -> str:
    """Return a label as the graph writes it."""
    if isinstance(value, bool):
        return str(value)
    return f"{value:.12g}" if isinstance(value, float) and math.isfinite(value) else shown(value)


def shown(value: object, decimals: int | None = None, *, fixed: bool = False) -> str:
    """Return a value as a reader sees it; an empty text for a missing value.

    Parameters
    ----------
    value
    decimals
        Decimals of a number. Default: four significant digits.
    fixed
        Whether zero and small numbers have them, too.
    """
    if value is None or type(value).__name__ in ("NAType", "NaTType"):
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if not isinstance(value, (int, float)):
        return str(value)
    if math.isnan(value):
        return ""
    if fixed and decimals is not None and abs(value) < _LARGEST:
        return f"{round(value, decimals) + 0.0:.{decimals}f}"
    if isinstance(value, int) or value == 0:
        return f"{value:.0f}" if isinstance(value, float) else str(value)
    if decimals is None and value.is_integer() and abs(value) < _LARGEST:
        return f"{value:.0f}"
    if not _SMALLEST <= abs(value) < _LARGEST:
        return f"{value:.2e}"
    if decimals is None:
        decimals = max(0, min(_MOST_DECIMALS, 3 - math.floor(math.log10(abs(value)))))
    return f"{value:.{decimals}f}"


def _beside(
    table: pd.DataFrame,
    parts: Mapping[Part, str],
    show: Callable[[object], str],
    means: Sequence[str],
    scale: float,
) -> list[str]:
    """Return what belongs to the numbers of a column: ``[low, high]`` and the dagger.

    An interval that is no wider than the digits of its number is left out.
    """
    texts = [""] * len(table)
    if "low" in parts and "high" in parts:
        ends = (_scaled(table[parts[end]], scale) for end in ("low", "high"))
        both = [(show(low), show(high)) for low, high in zip(*ends, strict=True)]
        texts = [
            f"[{low}, {high}]" if low and high and not low == high == mean else ""
            for (low, high), mean in zip(both, means, strict=True)
        ]
    if "p" in parts:
        texts = [
            f"{text} \N{DAGGER}".lstrip() if p < _SIGNIFICANT else text
            for text, p in zip(texts, table[parts["p"]], strict=True)
        ]
    return texts

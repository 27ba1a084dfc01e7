"""What a reader sees in the cells of a table: numbers, their intervals, the best of them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

from nodegraph_tables.style import unit_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    import pandas as pd

_APART = 0.05
_MOST_DECIMALS = 4
_SMALLEST, _LARGEST = 1e-3, 1e6
"""Smaller and larger numbers are shown with a power of ten."""


class Cell(NamedTuple):
    """A cell as text, what belongs to it (an interval, a dagger), and whether it is the best.

    `exact` has all digits of a number that is shown with fewer, `within` those of the numbers
    that belong to it.
    """

    text: str
    beside: str
    exact: str
    within: tuple[str, ...]
    best: bool

    def __str__(self) -> str:
        return f"{self.text} {self.beside}".rstrip()


class Column(NamedTuple):
    """A column as it is shown.

    Attributes
    ----------
    name, unit : str
    places : tuple of (int, str)
        Where the columns of the table are, and what they are called, whose values stand in its
        cells: its own first.
    numeric : bool
    label : bool
        Whether it says which row it is.
    cells : list of Cell
    """

    name: str
    unit: str
    places: tuple[tuple[int, str], ...]
    numeric: bool
    label: bool
    cells: list[Cell]

    @property
    def head(self) -> str:
        """The name with the unit, if it has one."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


def columns_of(table: pd.DataFrame) -> list[Column]:
    """Return the columns that a reader sees.

    Columns that ``attrs["cells"]`` names beside a column are shown within its cells, as
    ``mean [low, high]``, with a dagger where their ``p`` is below 0.05. The labels of the rows
    are the columns that ``attrs["labels"]`` names, or else the first one where it is text.
    """
    beside: Mapping[Any, Mapping[str, Any]] = table.attrs.get("cells", {})
    within = {name for parts in beside.values() for name in parts.values()}
    return [
        _column(table, at, beside.get(name, {}))
        for at, name in enumerate(table.columns)
        if name not in within
    ]


def _column(table: pd.DataFrame, at: int, parts: Mapping[str, Any]) -> Column:
    name, values = table.columns[at], table.iloc[:, at]
    numeric = values.dtype.kind in "iuf"
    named = table.attrs.get("labels")
    label = name in named if named is not None else at == 0 and not numeric
    best = set(table.attrs.get("best", {}).get(name, ()))
    listed = values.tolist()
    decimals = None if label or not numeric else _decimals(listed)
    inner = [table[one].tolist() for one in parts.values()]
    where = {one: place for place, one in enumerate(table.columns)}
    places = [(at, str(name)), *((where[one], str(one)) for one in parts.values())]
    rows = zip(listed, _beside(table, parts, decimals), strict=True)
    cells = [
        Cell(
            text := _labelled(value) if label else shown(value, decimals),
            said,
            _exact(value, text, said),
            tuple(_whole(column[row]) for column in inner),
            row in best,
        )
        for row, (value, said) in enumerate(rows)
    ]
    unit = unit_text(str(table.attrs.get("units", {}).get(name) or ""))
    return Column(str(name), unit, tuple(places), numeric, label, cells)


def _decimals(values: Iterable[Any]) -> int | None:
    """Return with how many decimals the numbers of a column stand, so that their points meet.

    Three digits of the smallest count, of those that are shown without a power of ten; None for
    whole numbers, and where there are none.
    """
    known = [abs(one) for one in values if _is_float(one) and math.isfinite(one)]
    plain = [one for one in known if _SMALLEST <= one < _LARGEST]
    if not plain or all(one.is_integer() for one in known):
        return None
    return max(0, min(_MOST_DECIMALS, 2 - math.floor(math.log10(min(plain)))))


def _is_float(value: Any) -> bool:
    return isinstance(value, float)


def _labelled(value: Any) -> str:
    """Return a label as the graph has it."""
    return f"{value:.12g}" if _is_float(value) and math.isfinite(value) else shown(value)


def shown(value: Any, decimals: int | None = None) -> str:
    """Return a cell's value for a reader, nothing where there is none.

    Parameters
    ----------
    value
    decimals
        Of a number; without, four digits that count.
    """
    if value is None or type(value).__name__ in ("NAType", "NaTType"):
        return ""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return str(value)
    if math.isnan(value):
        return ""
    if isinstance(value, int) or value == 0:
        return f"{value:.0f}" if isinstance(value, float) else str(value)
    if decimals is None and value.is_integer() and abs(value) < _LARGEST:
        return f"{value:.0f}"
    if not _SMALLEST <= abs(value) < _LARGEST:
        return f"{value:.2e}"
    if decimals is None:
        decimals = max(0, min(_MOST_DECIMALS, 3 - math.floor(math.log10(abs(value)))))
    return f"{value:.{decimals}f}"


def _exact(value: Any, text: str, beside: str) -> str:
    """Return all digits of a number of which a reader sees fewer, or more than the number."""
    if not isinstance(value, float) or not math.isfinite(value):
        return ""
    return repr(float(value)) if beside or float(text) != value else ""


def _whole(value: Any) -> str:
    """Return all digits of a number within a cell."""
    known = isinstance(value, (int, float)) and not math.isnan(value)
    return repr(float(value)) if known else ""


def _beside(table: pd.DataFrame, parts: Mapping[str, Any], decimals: int | None) -> list[str]:
    """Return what belongs to the numbers of a column: ``[low, high]`` and the dagger."""
    texts = [""] * len(table)
    if "low" in parts and "high" in parts:
        ends = zip(table[parts["low"]], table[parts["high"]], strict=True)
        both = [(shown(float(low), decimals), shown(float(high), decimals)) for low, high in ends]
        texts = [f"[{low}, {high}]" if low and high else "" for low, high in both]
    if "p" in parts:
        apart = [p < _APART for p in table[parts["p"]]]
        texts = [
            f"{text} \N{DAGGER}".lstrip() if one else text
            for text, one in zip(texts, apart, strict=True)
        ]
    return texts

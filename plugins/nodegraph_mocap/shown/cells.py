"""What a reader sees in the cells of a table: numbers, their intervals, the best of them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    import pandas as pd

_APART = 0.05


class Cell(NamedTuple):
    """A cell as text, what belongs to it (an interval, a dagger), and whether it is the best.

    `exact` has all digits of a number that is shown with fewer.
    """

    text: str
    beside: str
    exact: str
    best: bool

    def __str__(self) -> str:
        return f"{self.text} {self.beside}".rstrip()


class Column(NamedTuple):
    """A column as it is shown."""

    head: str
    numeric: bool
    cells: list[Cell]


def columns_of(table: pd.DataFrame) -> list[Column]:
    """Return the columns that a reader sees.

    Columns that ``attrs["cells"]`` names beside a column are shown within its cells, as
    ``mean [low, high]``, with a dagger where their ``p`` is below 0.05.
    """
    units, beside = table.attrs.get("units", {}), table.attrs.get("cells", {})
    within = {name for parts in beside.values() for name in parts.values()}
    places = {name: set(rows) for name, rows in table.attrs.get("best", {}).items()}
    return [
        Column(
            f"{name} [{units[name]}]" if units.get(name) else str(name),
            table.dtypes.iloc[at].kind in "iuf",
            [
                Cell(shown(value), said, _exact(value, said), row in places.get(name, ()))
                for row, (value, said) in enumerate(
                    zip(table.iloc[:, at].tolist(), _beside(table, beside.get(name)), strict=True)
                )
            ],
        )
        for at, name in enumerate(table.columns)
        if name not in within
    ]


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


def _exact(value: Any, beside: str) -> str:
    """Return all digits of a number of which a reader sees fewer, or more than the number."""
    if not isinstance(value, float) or not math.isfinite(value):
        return ""
    return repr(float(value)) if beside or float(shown(value)) != value else ""


def _beside(table: pd.DataFrame, columns: dict[str, str] | None) -> list[str]:
    """Return what belongs to the numbers of a column: ``[low, high]`` and the dagger."""
    texts = [""] * len(table)
    if columns is None:
        return texts
    if "low" in columns and "high" in columns:
        ends = zip(table[columns["low"]], table[columns["high"]], strict=True)
        both = [(shown(float(low)), shown(float(high))) for low, high in ends]
        texts = [f"[{low}, {high}]" if low and high else "" for low, high in both]
    if "p" in columns:
        apart = [p < _APART for p in table[columns["p"]]]
        texts = [
            f"{text} \N{DAGGER}".lstrip() if one else text
            for text, one in zip(texts, apart, strict=True)
        ]
    return texts

"""Figures side by side: one table per case, a row per engine, with ratios to ours."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

OURS = "nodegraph"


class Tables:
    """Collects figures by case, row and column, and prints them."""

    def __init__(self) -> None:
        self._cases: dict[str, dict[str, dict[str, float]]] = defaultdict(dict)

    def put(self, case: str, name: str, column: str, figure: float) -> None:
        """Note one figure; the row `OURS` is what the others are compared with."""
        self._cases[case].setdefault(name, {})[column] = figure

    def lines(self) -> Iterator[str]:
        """Yield the tables as text."""
        for case, rows in self._cases.items():
            yield ""
            yield case
            yield from _aligned(_cells(rows))


def _cells(rows: dict[str, dict[str, float]]) -> list[list[str]]:
    columns = list(dict.fromkeys(column for row in rows.values() for column in row))
    ours = rows.get(OURS, {})
    compared = [column for column in columns if column in ours and len(rows) > 1]
    cells = [["", *columns, *(f"{column}, ratio" for column in compared)]]
    for name, row in rows.items():
        figures = [_shown(row.get(column)) for column in columns]
        ratios = [
            _shown(row[column] / ours[column] if column in row else None) for column in compared
        ]
        cells.append([name, *figures, *ratios])
    return cells


def _shown(figure: float | None) -> str:
    return "-" if figure is None else f"{figure:,.{0 if abs(figure) >= 100 else 2}f}"


def _aligned(cells: list[list[str]]) -> Iterator[str]:
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    for row in cells:
        first, *rest = (text.rjust(width) for text, width in zip(row, widths, strict=True))
        yield "  ".join([row[0].ljust(len(first)), *rest])

"""The numbers of a comparison by method and group, as a terminal shows them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nodegraph import Grid
from nodegraph_tables.crosstab import crosstab

if TYPE_CHECKING:
    import pandas as pd


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

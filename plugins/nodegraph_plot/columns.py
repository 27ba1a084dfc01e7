"""The columns and axes of gathered tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nodegraph import listed

if TYPE_CHECKING:
    from nodegraph import Across
    from nodegraph_mocap import Table


def first_float(table: Table) -> str:
    """Return the name of the first column of floats.

    Raises
    ------
    ValueError
        If there is none.
    """
    for name, kind in table.dtypes.items():
        if kind.kind == "f":
            return str(name)
    raise ValueError(f"the table has no column of floats; it has {listed(table.columns)}")


def check_number(table: Table, name: str, scores: Across[Table]) -> None:
    """Raise a ValueError if a table has no such column, or one that holds no numbers."""
    if name not in table:
        raise ValueError(
            f"no column or axis {name!r}; there are the columns {listed(table.columns)} "
            f"and the axes {axis_labels(scores)}"
        )
    if table[name].dtype.kind not in "iufb":
        raise ValueError(f"column {name!r} holds no numbers")


def axis_labels(scores: Across[Table]) -> str:
    """Return the gathered axes as text."""
    return ", ".join(scores.axes) or "none"

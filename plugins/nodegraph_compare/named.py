"""Names of columns and axes: those that settings take, and whether the tables have them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from nodegraph import Across, ColumnOf, LabelOf, nearest

if TYPE_CHECKING:
    from collections.abc import Iterator

    from nodegraph_mocap import Table

OneColumn = Annotated[str | None, ColumnOf("scores")]
OneName = Annotated[str | None, ColumnOf("scores", or_axis=True)]
OneLabel = Annotated[str | None, LabelOf("scores", axis="compare")]
Names = Annotated[tuple[str, ...], ColumnOf("scores", or_axis=True)]


def check_known(scores: Across[Table], name: str, *, what: str = "axis or column") -> None:
    """Check that a name is a gathered axis, or a column of every table.

    Parameters
    ----------
    scores
        The gathered tables.
    name
        Of what is looked for.
    what
        What the name is called in the message; ``metric`` for what must be a column.

    Raises
    ------
    ValueError
        If a table has no such column; the message says which, and what there is instead.
    """
    axes = () if what == "metric" else scores.axes
    if name in axes:
        return
    for where, table in placed(scores):
        if name not in table.columns:
            there = "axes and columns" if axes else "columns"
            near = nearest(name, (*axes, *table.columns), what=there)
            raise ValueError(f"no {what} {name!r}{where}; {near}")


def placed(scores: Across[Table]) -> Iterator[tuple[str, Table]]:
    """Yield each table, and the words that say which it is: `` in the table of trial=0``."""
    for labels, table in scores:
        told = ", ".join(f"{axis}={label}" for axis, label in labels.items() if label != "")
        yield f" in the table of {told}" if told else "", table

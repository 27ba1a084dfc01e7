"""How tables and figures are kept: a table exactly or not at all, a figure as its drawing."""

from __future__ import annotations

from typing import Any

from nodegraph import Storage
from nodegraph_mocap.shown.stored_figure import StoredFigure
from nodegraph_mocap.tables import Figure, Table


def storages() -> tuple[Storage, ...]:
    """Return the storages of the types that are not this package's own classes."""
    return (
        Storage(Table, table_apart, table_together, lend=lent_table),
        Storage(Figure, figure_apart, figure_together, faithful=False),
    )


def table_apart(table: Table) -> dict[str, Any]:
    """Return what a table is made of; see `nodegraph_mocap.shown.stored_table`."""
    from nodegraph_mocap.shown.stored_table import take_apart

    return take_apart(table)


def table_together(parts: dict[str, Any]) -> Table:
    """Return the table again."""
    from nodegraph_mocap.shown.stored_table import put_together

    return put_together(parts)


def lent_table(table: Table) -> Table:
    """Return a copy that a reader may write to, its columns in memory one after the other.

    A table that was just computed may lie in memory in other ways than one from the store. The
    sums of its columns would then differ in their last bit.
    """
    return table.copy(deep=True)


def figure_apart(figure: Figure) -> tuple[bytes, bytes]:
    """Return the drawing of a figure as SVG and PDF."""
    from nodegraph_mocap.shown.renderers import saved

    return saved(figure, "svg"), saved(figure, "pdf")


def figure_together(drawing: tuple[bytes, bytes]) -> StoredFigure:
    """Return the drawing, which stands in for the figure wherever it is only shown."""
    return StoredFigure(*drawing)

"""Storage of tables and figures: a table exactly or not at all, a figure as its drawing."""

from __future__ import annotations

from nodegraph import Storage
from nodegraph_tables.figures import StoredFigure, store_figure
from nodegraph_tables.types import Figure, Table


def storages() -> tuple[Storage, ...]:
    """Return the storages of tables and figures."""
    return (
        Storage(Table, _table_parts, _table, lend=_lend_table),
        # the drawing can only be shown in place of the figure
        Storage(Figure, _figure_files, lambda files: StoredFigure(*files), faithful=False),
    )


# pandas is imported with the first table, not with the plugin


def _table_parts(table: Table) -> dict[str, object]:
    from nodegraph_tables.stored_table import take_apart

    return take_apart(table)


def _table(parts: dict[str, object]) -> Table:
    from nodegraph_tables.stored_table import put_together

    return put_together(parts)


def _lend_table(table: Table) -> Table:
    """Return a copy that a reader may write to, its columns in memory one after the other.

    A table that was just computed may lie in memory in other ways than one from the store. The
    sums of its columns would then differ in their last bit.
    """
    return table.copy(deep=True)


def _figure_files(figure: Figure) -> tuple[bytes, bytes]:
    drawing = store_figure(figure)
    return drawing.svg, drawing.pdf

"""What readers of tables get, and what is stored of figures: their drawings."""

from __future__ import annotations

from nodegraph_tables.figures import store_figure
from nodegraph_tables.types import Figure, Table


def lend_table(table: Table) -> Table:
    """Return a copy that a reader may write to, its columns in memory one after the other.

    A table that was just computed may lie in memory in other ways than one from the store. The
    sums of its columns would then differ in their last bit.
    """
    return table.copy(deep=True)


def figure_files(figure: Figure) -> tuple[bytes, bytes]:
    """Return the drawing of a figure, as SVG and as PDF."""
    drawing = store_figure(figure)
    return drawing.svg, drawing.pdf

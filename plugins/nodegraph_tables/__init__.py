"""Tables and figures: their types, storage, appearance, and the conclusions that they hold."""

from collections.abc import Callable, Iterable, Mapping

from nodegraph import Comparison, Conclusion, Renderer, Storage, hookimpl
from nodegraph_tables.comparisons import comparisons, differences, name_differences
from nodegraph_tables.figures import StoredFigure, render_figure, render_stored_figure
from nodegraph_tables.info import BetterEnd, TableInfo, Take, info_of, with_info
from nodegraph_tables.lead import Card, Lead
from nodegraph_tables.poses import Poses, difference, poses_of
from nodegraph_tables.style import figure_text
from nodegraph_tables.types import Figure, Table

__all__ = [
    "BetterEnd",
    "Card",
    "Figure",
    "Lead",
    "Poses",
    "StoredFigure",
    "Table",
    "TableInfo",
    "Take",
    "difference",
    "differences",
    "figure_text",
    "info_of",
    "name_differences",
    "poses_of",
    "with_info",
]


@hookimpl
def nodegraph_renderers() -> Iterable[Renderer]:
    """Return how tables and figures appear in a report."""
    from nodegraph_tables.rendering import render_table, render_table_in_run

    return (
        Renderer(Table, render_table, render_table_in_run),
        Renderer(Figure, render_figure),
        Renderer(StoredFigure, render_stored_figure),
    )


@hookimpl
def nodegraph_comparisons() -> Iterable[Comparison]:
    """Return how tables and figures are compared."""
    return comparisons()


@hookimpl
def nodegraph_conclusions() -> Iterable[Conclusion]:
    """Return what a study concludes from tables."""
    from nodegraph_tables.conclusions import conclude_table, table_numbers

    return (Conclusion(Table, conclude_table, table_numbers),)


@hookimpl
def nodegraph_storages() -> Iterable[Storage]:
    """Return how tables and figures are stored."""
    from nodegraph_tables.storage import storages

    return storages()


@hookimpl
def nodegraph_specimens() -> Mapping[type, Callable[[], Mapping[str, object]]]:
    """Return small tables and figures, on which nodes are tested."""
    from nodegraph_tables.specimens import figure_specimens, table_specimens

    return {Table: table_specimens, Figure: figure_specimens}

"""Tables and figures: their types, storage, appearance, and the conclusions that they hold."""

from collections.abc import Iterable

from nodegraph import Comparison, Conclusion, Renderer, Storage, hookimpl
from nodegraph_tables.comparisons import differing, names_apart
from nodegraph_tables.stored_figure import StoredFigure
from nodegraph_tables.style import figure_text
from nodegraph_tables.types import Figure, Table

__all__ = ["Figure", "StoredFigure", "Table", "differing", "figure_text", "names_apart"]


@hookimpl
def nodegraph_renderers() -> Iterable[Renderer]:
    """Return how tables and figures appear in a report."""
    from nodegraph_tables.renderers import renderers

    return renderers()


@hookimpl
def nodegraph_comparisons() -> Iterable[Comparison]:
    """Return how tables and figures are compared."""
    from nodegraph_tables.comparisons import comparisons

    return comparisons()


@hookimpl
def nodegraph_conclusions() -> Iterable[Conclusion]:
    """Return what a study concludes from tables."""
    from nodegraph_tables.conclusions import conclusions

    return conclusions()


@hookimpl
def nodegraph_storages() -> Iterable[Storage]:
    """Return how tables and figures are stored."""
    from nodegraph_tables.storage import storages

    return storages()

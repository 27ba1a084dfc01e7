"""Tables and figures: their types, storage, appearance, conclusions, and tables for papers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nodegraph import Kind, hookimpl, late
from nodegraph_tables.answer import Answer, Card, Finding
from nodegraph_tables.comparisons import (
    compare_drawings,
    compare_tables,
    differences,
    name_differences,
)
from nodegraph_tables.figures import StoredFigure, figure_files, render_figure, render_stored_figure
from nodegraph_tables.info import BetterEnd, TableInfo, Take, info_of, with_info
from nodegraph_tables.poses import Poses, difference, poses_of
from nodegraph_tables.style import figure_text
from nodegraph_tables.text import Text, Word
from nodegraph_tables.types import Figure, Table, lend_table

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

__all__ = [
    "Answer",
    "BetterEnd",
    "Card",
    "Figure",
    "Finding",
    "Poses",
    "StoredFigure",
    "Table",
    "TableInfo",
    "Take",
    "Text",
    "Word",
    "difference",
    "differences",
    "figure_text",
    "info_of",
    "name_differences",
    "poses_of",
    "with_info",
]


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., object]]:
    """Return the plugin's nodes."""
    from nodegraph_tables.write_tex import write_tex

    return (write_tex,)


@hookimpl
def nodegraph_kinds() -> Iterable[Kind]:
    """Return how tables and figures appear, are stored and compared, and what tables conclude."""
    return (
        Kind(
            Table,
            render=late("nodegraph_tables.rendering:render_table"),
            render_in_run=late("nodegraph_tables.rendering:render_table_in_run"),
            take_apart=late("nodegraph_tables.stored_table:take_apart"),
            put_together=late("nodegraph_tables.stored_table:put_together"),
            lend=lend_table,
            compare=compare_tables,
            conclude=late("nodegraph_tables.conclusions:conclude_table"),
            numbers=late("nodegraph_tables.conclusions:table_numbers"),
            data=late("nodegraph_tables.conclusions:table_data"),
            specimens=late("nodegraph_tables.specimens:table_specimens"),
        ),
        Kind(
            Figure,
            render=render_figure,
            take_apart=figure_files,
            # the drawing can only be shown in place of the figure
            put_together=lambda files: StoredFigure(*files),
            faithful=False,
            specimens=late("nodegraph_tables.specimens:figure_specimens"),
        ),
        Kind(StoredFigure, render=render_stored_figure, compare=compare_drawings),
    )

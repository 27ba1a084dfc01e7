"""Compare methods over many trials: paired tables, intervals and figures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph import Kind, hookimpl, late

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., object]]:
    """Return the plugin's nodes."""
    from nodegraph_compare.bayes.node import bayes
    from nodegraph_compare.curve.node import curve
    from nodegraph_compare.ranks.node import ranks
    from nodegraph_compare.table.node import table

    return (bayes, curve, ranks, table)


@hookimpl
def nodegraph_kinds() -> Iterable[Kind]:
    """Return how the overview of a comparison appears."""
    from nodegraph_compare.overview.value import Overview

    module = "nodegraph_compare.overview.render"
    return (
        Kind(
            Overview,
            render=late(f"{module}:render_overview"),
            render_in_run=late(f"{module}:render_overview_in_run"),
        ),
    )


@hookimpl
def nodegraph_bibtex() -> str:
    """Return the BibTeX entries that the plugin's nodes cite."""
    return (Path(__file__).parent / "references.bib").read_text(encoding="utf-8")

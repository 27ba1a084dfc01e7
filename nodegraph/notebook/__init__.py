"""Self-contained HTML of graphs and runs for notebooks."""

from __future__ import annotations

import re
from importlib.resources import files

from nodegraph.draw.from_graph import drawing_for_page, labels_text
from nodegraph.execute.results import Run
from nodegraph.formatting import duration
from nodegraph.graph import Graph
from nodegraph.report.from_run import compose
from nodegraph.report.notes import note_kinds
from nodegraph.report.page import from_template, source, standalone_page, titled

_MOST = 24
_FEW = 3
_LONGEST_LABELS = 72
_PALETTE = re.compile(r"^\.nodegraph-picture \{([^}]*)\}", re.MULTILINE)
_LIGHT = '[data-jp-theme-light="true"], .vscode-light, html[theme="light"]'
_DARK = '[data-jp-theme-light="false"], .vscode-dark, html[theme="dark"]'
"""Selectors by which JupyterLab, Visual Studio Code and Colab mark a page of another theme."""


def graph_html(graph: Graph) -> str:
    """Return the title, axes and drawing of a graph as HTML."""
    return from_template(
        "nodegraph.notebook",
        "graph.html",
        style=_style(),
        title=graph.title,
        axes=_axes(graph),
        drawing=drawing_for_page(graph),
        nodes=len(graph.nodes),
    )


def run_html(run: Run) -> str:
    """Return the outcome of a run's steps and its report as HTML.

    A result with scripts is a page in a frame: a notebook may show a cell several times in one
    page, where names of scripts would clash.
    """
    graph = run.plan.graph
    study = compose(run).study
    return from_template(
        "nodegraph.notebook",
        "run.html",
        style=_style(),
        study=study,
        counts=run.counts(),
        time=duration(run.seconds),
        axes=_axes(graph),
        kinds=note_kinds(study),
        results=titled(study.sections),
        most=_MOST,
        few=_FEW,
        standalone_page=standalone_page,
    )


def _axes(graph: Graph) -> dict[str, str]:
    return {name: labels_text(axis.labels, _LONGEST_LABELS) for name, axis in graph.axes.items()}


def _style() -> str:
    """Return the style sheet of the fragment, with the drawing's colours.

    These follow the reader's light or dark scheme, unless the notebook has a theme of its own.
    """
    picture = files("nodegraph.draw").joinpath("picture.css").read_text(encoding="utf-8")
    (colours,) = _PALETTE.findall(picture)
    return "\n".join(
        (
            f".nodegraph-notebook {{ color-scheme: light dark; {colours} }}",
            f":is({_LIGHT}) .nodegraph-notebook {{ color-scheme: light; }}",
            f":is({_DARK}) .nodegraph-notebook {{ color-scheme: dark; }}",
            "@media print { .nodegraph-notebook { color-scheme: light; } }",
            source("notebook.css", "nodegraph.notebook"),
        )
    )


__all__ = ["graph_html", "run_html"]

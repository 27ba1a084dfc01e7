"""Graphs and runs as HTML that a notebook shows."""

from nodegraph.notebook.show import graph_html, run_html

__all__ = ["graph_html", "run_html"]

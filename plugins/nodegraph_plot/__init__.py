"""Draw recordings: trajectories over time, faces from the front, faces that play."""

from __future__ import annotations

from importlib.resources import files
from typing import TYPE_CHECKING

from nodegraph import hookimpl

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., object]]:
    """Return the plugin's nodes."""
    from nodegraph_plot.error_map import error_map
    from nodegraph_plot.faces import faces
    from nodegraph_plot.playback import playback
    from nodegraph_plot.scatter import scatter
    from nodegraph_plot.selection import selection
    from nodegraph_plot.shapes import shapes
    from nodegraph_plot.spectra import spectra
    from nodegraph_plot.trajectories import trajectories

    return (error_map, faces, playback, scatter, selection, shapes, spectra, trajectories)


@hookimpl
def nodegraph_bibtex() -> str:
    """Return what the figures cite."""
    return files(__name__).joinpath("references.bib").read_text(encoding="utf-8")

"""Draw recordings: trajectories over time and faces from the front."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from nodegraph import hookimpl

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., Any]]:
    """Return the plugin's nodes."""
    from nodegraph_plot.faces import faces
    from nodegraph_plot.trajectories import trajectories

    return (faces, trajectories)

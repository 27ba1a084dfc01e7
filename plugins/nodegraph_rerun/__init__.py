"""Write recordings for the viewer Rerun."""

from collections.abc import Callable, Iterable
from typing import Any

from nodegraph import hookimpl


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., Any]]:
    """Return the nodes of this package."""
    from nodegraph_rerun import writing

    return (writing.write_rrd,)

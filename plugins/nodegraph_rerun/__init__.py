"""Write recordings for the viewer Rerun."""

from collections.abc import Callable, Iterable

from nodegraph import hookimpl


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., object]]:
    """Return the nodes of this package."""
    from nodegraph_rerun import writing

    return (writing.write_rrd,)

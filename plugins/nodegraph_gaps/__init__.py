"""Hide samples of a recording, so that what a fill puts there can be compared with them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from nodegraph import hookimpl


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., Any]]:
    """Return the nodes that make gaps."""
    from nodegraph_gaps.cut import cut

    return (cut,)

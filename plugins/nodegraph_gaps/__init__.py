"""Damage of known place: gaps cut into a recording, with the truth beside it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from nodegraph import hookimpl


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., Any]]:
    """Return the nodes of this package."""
    from nodegraph_gaps.cut import cut

    return (cut,)

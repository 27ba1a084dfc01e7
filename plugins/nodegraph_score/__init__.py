"""Score what a method made against the truth: a table with a row per unit."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from nodegraph import hookimpl

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., Any]]:
    """Return the plugin's nodes."""
    from nodegraph_score.gaps import gaps

    return (gaps,)

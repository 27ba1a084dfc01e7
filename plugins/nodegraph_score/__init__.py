"""Score what a method made against the truth: a table with a row per unit."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from nodegraph import Contract, hookimpl

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., Any]]:
    """Return the plugin's nodes."""
    from nodegraph_score.gaps import gaps

    return (gaps,)


@hookimpl
def nodegraph_contracts() -> Mapping[str, Iterable[Contract]]:
    """Return what every score promises."""
    from nodegraph_score.contracts import CONTRACTS

    return {"score": CONTRACTS}

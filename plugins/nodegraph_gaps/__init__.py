"""Hide samples of a recording, so that what a fill puts there can be compared with them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from nodegraph import Contract, hookimpl


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., object]]:
    """Return the nodes that make gaps."""
    from nodegraph_gaps.cut import cut
    from nodegraph_gaps.dropout import dropout
    from nodegraph_gaps.from_matrix import from_matrix

    return (cut, dropout, from_matrix)


@hookimpl
def nodegraph_contracts() -> Mapping[str, Iterable[Contract]]:
    """Return what every node that makes gaps promises."""
    from nodegraph_gaps.contracts import CONTRACTS

    return {"gaps": CONTRACTS}

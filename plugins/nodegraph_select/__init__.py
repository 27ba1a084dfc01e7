"""Choose the most informative markers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from importlib.resources import files

from nodegraph import Contract, hookimpl


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., object]]:
    """Return the plugin's nodes."""
    from nodegraph_select.greedy import greedy
    from nodegraph_select.pfa import pfa
    from nodegraph_select.qr import qr
    from nodegraph_select.random import random
    from nodegraph_select.variance import variance

    return (greedy, pfa, qr, random, variance)


@hookimpl
def nodegraph_bibtex() -> str:
    """Return what the nodes cite."""
    return files(__name__).joinpath("references.bib").read_text(encoding="utf-8")


@hookimpl
def nodegraph_contracts() -> Mapping[str, Iterable[Contract]]:
    """Return what every selection promises."""
    from nodegraph_select.contracts import CONTRACTS

    return {"select": CONTRACTS}

"""Make one recording of several: of what several methods make of one take."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from importlib.resources import files

from nodegraph import Contract, hookimpl


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., object]]:
    """Return the nodes that combine."""
    from nodegraph_combine.ensemble import ensemble
    from nodegraph_combine.mean import mean
    from nodegraph_combine.median import median

    return (ensemble, mean, median)


@hookimpl
def nodegraph_bibtex() -> str:
    """Return the references that the nodes cite."""
    return files(__name__).joinpath("references.bib").read_text(encoding="utf-8")


@hookimpl
def nodegraph_contracts() -> Mapping[str, Iterable[Contract]]:
    """Return what every node that combines promises."""
    from nodegraph_combine.contracts import CONTRACTS

    return {"combine": CONTRACTS}

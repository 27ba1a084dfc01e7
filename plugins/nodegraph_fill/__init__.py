"""Fill the gaps of a recording."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from importlib.resources import files
from typing import Any

from nodegraph import Contract, hookimpl


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., Any]]:
    """Return the fills."""
    from nodegraph_fill.guenter import guenter
    from nodegraph_fill.lin_ouhyoung import lin_ouhyoung
    from nodegraph_fill.linear import linear
    from nodegraph_fill.muscle import muscle
    from nodegraph_fill.waters import waters

    return (guenter, lin_ouhyoung, linear, muscle, waters)


@hookimpl
def nodegraph_bibtex() -> str:
    """Return what the fills cite."""
    return files(__name__).joinpath("references.bib").read_text(encoding="utf-8")


@hookimpl
def nodegraph_contracts() -> Mapping[str, Iterable[Contract]]:
    """Return what every fill promises."""
    from nodegraph_fill.contracts import CONTRACTS

    return {"fill": CONTRACTS}

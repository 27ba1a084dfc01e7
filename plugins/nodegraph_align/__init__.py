"""Align faces and put their head motion back."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from importlib.resources import files
from typing import Any

from nodegraph import Contract, hookimpl


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., Any]]:
    """Return the nodes that align."""
    from nodegraph_align.generalized import generalized
    from nodegraph_align.huber import huber
    from nodegraph_align.procrustes import procrustes
    from nodegraph_align.restore import restore
    from nodegraph_align.trimmed import trimmed

    return (procrustes, trimmed, huber, generalized, restore)


@hookimpl
def nodegraph_bibtex() -> str:
    """Return what the nodes cite."""
    return files(__name__).joinpath("references.bib").read_text(encoding="utf-8")


@hookimpl
def nodegraph_contracts() -> Mapping[str, Iterable[Contract]]:
    """Return what every alignment promises."""
    from nodegraph_align.contracts import CONTRACTS

    return {"align": CONTRACTS}

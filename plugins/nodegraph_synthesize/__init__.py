"""Synthetic faces with known ground truth, and known damage for any recording."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from nodegraph import Contract, hookimpl


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., object]]:
    """Return the nodes of this package."""
    from nodegraph_synthesize.face import synthesize_face
    from nodegraph_synthesize.impulses import add as add_impulses
    from nodegraph_synthesize.noise import add as add_noise

    return (synthesize_face, add_noise, add_impulses)


@hookimpl
def nodegraph_contracts() -> Mapping[str, Iterable[Contract]]:
    """Return the contracts of nodes that add noise or impulses."""
    from nodegraph_synthesize.contracts import CONTRACTS

    return CONTRACTS


@hookimpl
def nodegraph_bibtex() -> str:
    """Return the BibTeX of this package."""
    return (Path(__file__).parent / "references.bib").read_text(encoding="utf-8")

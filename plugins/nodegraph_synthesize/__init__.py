"""Made faces: recordings of which everything is known."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from nodegraph import hookimpl


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., Any]]:
    """Return the nodes of this package."""
    from nodegraph_synthesize.face import synthesize_face

    return (synthesize_face,)


@hookimpl
def nodegraph_bibtex() -> str:
    """Return what the nodes of this package cite."""
    return (Path(__file__).parent / "references.bib").read_text(encoding="utf-8")

"""Estimators of scikit-learn as nodes: ``use: sklearn:sklearn.impute.KNNImputer``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph import hookimpl

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping


@hookimpl
def nodegraph_node_finders() -> Mapping[str, Callable[[str], Callable[..., object]]]:
    """Return how an estimator's name becomes a node."""
    from nodegraph_sklearn.estimators import node_of_estimator

    return {"sklearn": node_of_estimator}


@hookimpl
def nodegraph_bibtex() -> str:
    """Return the BibTeX entries that the plugin's nodes cite."""
    return (Path(__file__).parent / "references.bib").read_text(encoding="utf-8")

"""Choose, rename, name and relate markers; cut, resample and join recordings."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from importlib.resources import files

from nodegraph import Contract, hookimpl


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., object]]:
    """Return the nodes of this package."""
    from nodegraph_markers.crop import crop
    from nodegraph_markers.infer import infer
    from nodegraph_markers.join import join
    from nodegraph_markers.keep import keep
    from nodegraph_markers.label import label
    from nodegraph_markers.marks import apply_marks
    from nodegraph_markers.rename import rename
    from nodegraph_markers.resample import resample

    return (keep, rename, infer, label, crop, resample, join, apply_marks)


@hookimpl
def nodegraph_bibtex() -> str:
    """Return what the nodes cite."""
    return files(__name__).joinpath("references.bib").read_text(encoding="utf-8")


@hookimpl
def nodegraph_contracts() -> Mapping[str, Iterable[Contract]]:
    """Return what every node that chooses or names markers promises."""
    from nodegraph_markers.contracts import CONTRACTS

    return {"markers": CONTRACTS}

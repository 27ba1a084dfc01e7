"""Track: take the names off a recording's points, and follow unlabelled points through time."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from importlib.resources import files

from nodegraph import Contract, hookimpl


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., object]]:
    """Return the trackers, and what gives them points."""
    from nodegraph_track.assignment import assignment
    from nodegraph_track.nearest import nearest
    from nodegraph_track.neighbours import neighbours
    from nodegraph_track.points_literal import literal
    from nodegraph_track.points_scatter import scatter
    from nodegraph_track.points_unnamed import unnamed

    return (assignment, nearest, neighbours, scatter, unnamed, literal)


@hookimpl
def nodegraph_bibtex() -> str:
    """Return what the trackers cite."""
    return files(__name__).joinpath("references.bib").read_text(encoding="utf-8")


@hookimpl
def nodegraph_contracts() -> Mapping[str, Iterable[Contract]]:
    """Return what every tracker promises."""
    from nodegraph_track.contracts import CONTRACTS

    return {"track": CONTRACTS}

"""Build blendshape models, pose them, and find the weights of a recording."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from importlib.resources import files

from nodegraph import Contract, hookimpl


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., object]]:
    """Return the plugin's nodes."""
    from nodegraph_blendshapes.animate_mesh import mesh
    from nodegraph_blendshapes.from_frames import from_frames
    from nodegraph_blendshapes.from_head import from_head
    from nodegraph_blendshapes.from_pca import from_pca
    from nodegraph_blendshapes.pose import pose
    from nodegraph_blendshapes.solve.weights import solve_weights

    return (from_frames, from_head, from_pca, pose, mesh, solve_weights)


@hookimpl
def nodegraph_bibtex() -> str:
    """Return what the nodes cite."""
    return files(__name__).joinpath("references.bib").read_text(encoding="utf-8")


@hookimpl
def nodegraph_contracts() -> Mapping[str, Iterable[Contract]]:
    """Return what every node of a family promises."""
    from nodegraph_blendshapes.contracts import ANIMATE, BLENDSHAPES
    from nodegraph_blendshapes.solve.contracts import CONTRACTS

    return {"blendshapes": BLENDSHAPES, "animate": ANIMATE, "solve": CONTRACTS}

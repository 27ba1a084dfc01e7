"""Score what a method made against the truth: a table with a row per unit."""

from __future__ import annotations

from importlib.resources import files
from typing import TYPE_CHECKING

from nodegraph import Contract, hookimpl

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., object]]:
    """Return the plugin's nodes."""
    from nodegraph_score.alignment import alignment
    from nodegraph_score.alignment_plot import alignment_plot
    from nodegraph_score.calibration import calibration
    from nodegraph_score.distance import distance
    from nodegraph_score.gaps import gaps
    from nodegraph_score.head_motion import head_motion
    from nodegraph_score.impulses import impulses
    from nodegraph_score.realism import realism
    from nodegraph_score.roughness import roughness
    from nodegraph_score.smoothness import smoothness
    from nodegraph_score.steps import steps
    from nodegraph_score.tracking import tracking
    from nodegraph_score.tuning import tuning
    from nodegraph_score.unselected import unselected
    from nodegraph_score.weights_mse import weights_mse

    return (
        alignment,
        alignment_plot,
        calibration,
        distance,
        gaps,
        head_motion,
        impulses,
        realism,
        roughness,
        smoothness,
        steps,
        tracking,
        tuning,
        unselected,
        weights_mse,
    )


@hookimpl
def nodegraph_bibtex() -> str:
    """Return what the scores cite."""
    return files(__name__).joinpath("references.bib").read_text(encoding="utf-8")


@hookimpl
def nodegraph_contracts() -> Mapping[str, Iterable[Contract]]:
    """Return what every score promises."""
    from nodegraph_score.contracts import CONTRACTS

    return {"score": CONTRACTS}

"""Smooth trajectories over time."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from importlib.resources import files
from typing import TYPE_CHECKING

from nodegraph import Contract, hookimpl

if TYPE_CHECKING:
    from nodegraph_mocap import Trajectories


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., Trajectories]]:
    """Return the nodes that smooth."""
    from nodegraph_smooth.bspline import bspline
    from nodegraph_smooth.butterworth import butterworth
    from nodegraph_smooth.dct import dct
    from nodegraph_smooth.gcv import gcv
    from nodegraph_smooth.kalman import kalman
    from nodegraph_smooth.kalman_filter import kalman_filter
    from nodegraph_smooth.least_squares import least_squares
    from nodegraph_smooth.one_euro import one_euro
    from nodegraph_smooth.polynomial import polynomial
    from nodegraph_smooth.savgol import savgol
    from nodegraph_smooth.whittaker import whittaker

    return (
        bspline,
        butterworth,
        dct,
        gcv,
        kalman,
        kalman_filter,
        least_squares,
        one_euro,
        polynomial,
        savgol,
        whittaker,
    )


@hookimpl
def nodegraph_bibtex() -> str:
    """Return what the smoothings cite."""
    return files(__name__).joinpath("references.bib").read_text(encoding="utf-8")


@hookimpl
def nodegraph_contracts() -> Mapping[str, Iterable[Contract]]:
    """Return what every smoothing promises."""
    from nodegraph_smooth.contracts import CONTRACTS

    return {"smooth": CONTRACTS}

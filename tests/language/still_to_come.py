"""Stands in for methods that are not installed, with the ports that graphs count on."""

from __future__ import annotations

from typing import Literal, NamedTuple

from nodegraph import Across, node
from nodegraph_mocap import Animation, Figure, Selection, Table, Trajectories
from nodegraph_mocap.face_model import BlendshapeModel, HeadMotion, Weights
from nodegraph_mocap.head import Head


class Aligned(NamedTuple):
    aligned: Trajectories
    head_motion: HeadMotion
    reference: Trajectories


class Solved(NamedTuple):
    weights: Weights
    residuals: Table


class Curve(NamedTuple):
    table: Table
    figure: Figure


@node("align.procrustes")
def procrustes(recording: Trajectories, reference: Trajectories | None = None) -> Aligned:
    raise AssertionError


@node("select.pfa")
def pfa(recording: Trajectories, *, k: int) -> Selection:
    raise AssertionError


@node("solve.weights")
def solve(recording: Trajectories, model: BlendshapeModel) -> Solved:
    raise AssertionError


@node("score.weights_mse")
def weights_mse(estimate: Weights, reference: Weights, selection: Selection | None = None) -> Table:
    raise AssertionError


@node("compare.curve")
def curve(
    scores: Across[Table],
    floor: Across[Table] | None = None,
    *,
    x: str,
    metric: str,
    compare: str,
    mark: Literal["none", "minimum", "shared"] = "none",
) -> Curve:
    raise AssertionError


@node("animate.mesh")
def mesh(weights: Weights, head: Head) -> Animation:
    raise AssertionError

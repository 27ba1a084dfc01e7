"""Stands in for methods that are not installed, with the ports that graphs count on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

from nodegraph import Across, InputFile, Value, node
from nodegraph_mocap import Figure, Table, Trajectories
from nodegraph_mocap.face_model import BlendshapeModel, HeadMotion, Weights
from nodegraph_mocap.head import Head


@dataclass(frozen=True)
class Selection(Value):
    markers: tuple[str, ...]


@dataclass(frozen=True)
class Animation(Value):
    head: Head


class Model(NamedTuple):
    model: BlendshapeModel
    neutral: Trajectories


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


@node("read.model")
def read_model(*, path: InputFile) -> Model:
    raise AssertionError


@node("align.procrustes")
def procrustes(recording: Trajectories, reference: Trajectories | None = None) -> Aligned:
    raise AssertionError


@node("select.pfa")
def pfa(recording: Trajectories, *, k: int) -> Selection:
    raise AssertionError


@node("markers.keep")
def keep(recording: Trajectories, selection: Selection | None = None) -> Trajectories:
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


@node("markers.label")
def label(recording: Trajectories, reference: Trajectories) -> Trajectories:
    raise AssertionError


@node("despike.impulse")
def impulse(recording: Trajectories) -> Trajectories:
    raise AssertionError


@node("smooth.bspline")
def bspline(recording: Trajectories) -> Trajectories:
    raise AssertionError


@node("animate.mesh")
def mesh(weights: Weights, head: Head) -> Animation:
    raise AssertionError

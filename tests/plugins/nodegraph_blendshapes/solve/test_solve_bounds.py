"""What may be said of bounds, and what it means."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

import nodegraph as ng
from nodegraph_blendshapes.solve.weights import limits


@pytest.mark.parametrize(
    ("bounds", "low", "high"),
    [
        ((0.0, 1.0), 0.0, 1.0),
        ([-1, 2], -1.0, 2.0),
        ((-0.5, 0.0), -0.5, 0.0),
        ("nonnegative", 0.0, math.inf),
        ("none", -math.inf, math.inf),
    ],
)
def test_bounds(bounds: Any, low: float, high: float) -> None:
    assert limits(bounds) == (low, high)


@pytest.mark.parametrize(
    "bounds",
    [(1.0, 0.0), (0.0, 0.0), (0.1, 1.0), (-1.0, -0.5), (0.0, math.inf), (math.nan, 1.0),
     (0.0, 0.5, 1.0), (), "positive", ""],
)  # fmt: skip
def test_nonsense_is_named(bounds: Any) -> None:
    with pytest.raises(ValueError, match="two numbers, the lower first and 0, the face at rest"):
        limits(bounds)


GRAPH = """\
nodegraph: 1
inputs: {path: "sample:actor_a"}
nodes:
  capture: {use: read.recording, with: {path: $path}}
  model: {use: read.model, with: {path: $path}}
  weights: {use: solve.weights, in: {recording: capture, model: model}, with: {bounds: BOUNDS}}
"""


@pytest.mark.parametrize("bounds", ["[1, 0]", "[.nan, 1]"])
def test_a_graph_with_nonsense_is_not_loaded_and_says_the_same(bounds: str, tmp_path: Path) -> None:
    graph = tmp_path / "graph.yaml"
    graph.write_text(GRAPH.replace("BOUNDS", bounds))
    with pytest.raises(ng.GraphError) as error:
        ng.load(graph)
    with pytest.raises(ValueError, match="bounds must be") as direct:
        limits((1.0, 0.0))
    rule = str(direct.value).removeprefix("bounds ").partition(";")[0]
    assert f"graph.yaml:6:88: weights: setting 'bounds' of solve.weights {rule}, got [" in str(
        error.value
    )


@pytest.mark.parametrize("bounds", ["[-1, 2]", "nonnegative", "none"])
def test_a_graph_with_bounds_is_loaded(bounds: str, tmp_path: Path) -> None:
    graph = tmp_path / "graph.yaml"
    graph.write_text(GRAPH.replace("BOUNDS", bounds))
    ng.load(graph)

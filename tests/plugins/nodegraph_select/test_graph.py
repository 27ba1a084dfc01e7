"""A graph compares all selections at one number of markers, and what jobs do changes nothing."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import nodegraph as ng
from nodegraph.equality import difference

GRAPH = """\
nodegraph: 1
inputs: {path: "sample:actor_a"}
axes: {k: [6, 15]}
nodes:
  capture: {use: read.recording, with: {path: $path}}
  model: {use: read.model, with: {path: $path}}
  face: {use: align.procrustes, in: {recording: capture, reference: model.neutral}}
  chosen:
    in: face
    alternatives: {select.*: {}, pfa: {use: select.pfa, with: {runs: 12}}}
    with: {k: $k}
  kept: {use: markers.keep, in: {recording: face, selection: chosen}}
report: [kept]
"""
METHODS = {"pfa", "random", "variance", "qr", "greedy"}


@pytest.fixture(scope="module")
def graph(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("graph") / "selections.yaml"
    file.write_text(GRAPH)
    return file


def selections(graph: Path, jobs: int) -> dict[Any, Any]:
    run = ng.run(graph, jobs=jobs, cache=False)
    return {
        (method, k): run["chosen"].at(chosen=method, k=k) for method in METHODS for k in (6, 15)
    }


def test_every_method_in_one_family_and_on_one_and_two_jobs(graph: Path) -> None:
    first, second = selections(graph, 1), selections(graph, 2)
    assert not difference(first, second)
    for (method, k), selection in first.items():
        if method != "pfa":
            assert len(selection.chosen) in (k, k + 1)
    assert set(ng.load(graph).axes["chosen"].labels) == METHODS

"""The two hardest graphs of the language load and plan as they are written."""

from __future__ import annotations

from pathlib import Path

import nodegraph as ng
from nodegraph.plan import plan

HERE = Path(__file__).with_name("language")
ACTORS, SIZES = 3, 12


def test_marker_selection_plans_shared_steps_once() -> None:
    graph = ng.load(HERE / "marker_selection.yaml")
    planned = plan(graph)
    steps = {name: len(set(cells.values())) for name, cells in planned.cells.items()}
    per_actor = dict.fromkeys(("capture", "model", "face", "complete"), ACTORS)
    per_size = dict.fromkeys(("chosen", "kept", "selected", "mse"), ACTORS * SIZES)
    assert steps == {**per_actor, **per_size, "fig2": 1}
    assert graph.nodes["fig2"].gathered == ("actor", "k")
    assert graph.axes["k"].labels == tuple(range(5, 61, 5))
    first = next(step for step in planned.steps if step.node == "chosen")
    assert first.settings["k"] == 5


def test_pipeline_plans_one_step_a_node_and_gathers_the_stages() -> None:
    graph = ng.load(HERE / "pipeline.yaml")
    planned = plan(graph)
    assert len(planned.steps) == len(graph.nodes) == 10
    figure = next(step for step in planned.steps if step.node == "fig9")
    stages = figure.inputs["recordings"]
    names = ("captured", "recovered", "smooth")
    assert [at for at, _ in stages.entries] == [{"recordings": name} for name in names]  # type: ignore[union-attr]

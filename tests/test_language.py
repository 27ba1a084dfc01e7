"""The two hardest graphs of the language load and plan as they are written."""

from __future__ import annotations

from pathlib import Path

import pytest

import nodegraph as ng
from nodegraph.plan import plan
from nodegraph.registry import default_registry

HERE = Path(__file__).with_name("language")
STAND_INS = HERE / "still_to_come.py"
ACTORS, SIZES = 3, 12


def test_marker_selection_plans_shared_steps_once() -> None:
    graph = ng.load(HERE / "marker_selection.yaml", plugins=[STAND_INS])
    made = plan(graph)
    steps = {name: len(set(cells.values())) for name, cells in made.cells.items()}
    per_actor = dict.fromkeys(("capture", "model", "face", "complete"), ACTORS)
    per_size = dict.fromkeys(("chosen", "kept", "selected", "mse"), ACTORS * SIZES)
    assert steps == {**per_actor, **per_size, "fig2": 1}
    assert graph.nodes["fig2"].gathered == ("actor", "k")
    assert graph.axes["k"].labels == tuple(range(5, 61, 5))
    first = next(step for step in made.steps if step.node == "chosen")
    assert first.settings["k"] == 5


def test_pipeline_plans_one_step_a_node_and_gathers_the_stages() -> None:
    graph = ng.load(HERE / "pipeline.yaml", plugins=[STAND_INS])
    made = plan(graph)
    assert len(made.steps) == len(graph.nodes) == 10
    figure = next(step for step in made.steps if step.node == "fig9")
    stages = figure.inputs["recordings"]
    assert [at for at, _ in stages.entries] == [("captured",), ("recovered",), ("smooth",)]  # type: ignore[union-attr]


@pytest.mark.parametrize("name", ["marker_selection", "pipeline"])
def test_nodes_that_are_not_installed_are_named_with_their_lines(name: str) -> None:
    file = HERE / f"{name}.yaml"
    installed = {one.node.name for one in default_registry()}
    expected = {
        (number, use)
        for number, line in enumerate(file.read_text().splitlines(), 1)
        if "use: " in line
        and (use := line.partition("use: ")[2].partition("}")[0].partition(",")[0]) not in installed
    }
    if not expected:
        assert ng.load(file)
        return
    with pytest.raises(ng.GraphError) as caught:
        ng.load(file)
    found = {
        (problem.place.line, problem.message.partition("'")[2].rstrip("'"))
        for problem in caught.value.problems
    }
    assert found == expected

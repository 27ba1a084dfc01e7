"""What a renderer may ask of the run: the steps behind a gathered value."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import pytest

from nodegraph import Across, Kind, Provenance, Rendered, Unit, hookimpl, node
from nodegraph.execute.results import Run
from nodegraph.execute.run import execute
from nodegraph.graph import build
from nodegraph.graphfile import read_graph_text
from nodegraph.plan import plan
from nodegraph.plugin.loading import Plugin as Loaded
from nodegraph.plugin.registry import Registry
from nodegraph.report.from_run import compose

GRAPH = """\
nodegraph: 1
axes: {trial: [1, 2], length: [5, 15], reach: {near: 1.0, far: 2.0}}
nodes:
  source: {use: origin.source, with: {value: $trial}}
  fill: {in: source, alternatives: {up: {use: origin.up}, down: {use: origin.down}}}
  cut: {use: origin.cut, in: fill, with: {length: $length, reach: $reach}}
  score: {use: origin.score, in: {estimate: fill, truth: source}}
  table: {use: origin.gather, in: score}
report: [table]
"""
OWN = """\
nodegraph: 1
axes: {trial: [1, 2]}
nodes:
  source: {use: origin.source, with: {value: $trial}}
  higher: {use: origin.up, in: source}
  fill:
    in: source
    alternatives: {up: {use: origin.up, in: higher}, down: {use: origin.down}}
  score: {use: origin.score, in: {estimate: fill, truth: source}}
  table: {use: origin.gather, in: score}
report: [table]
"""


class Total(float):
    pass


@node("origin.source")
def source(*, value: float = 1.0) -> float:
    return value


@node("origin.up")
def up(value: float) -> float:
    """Add one."""
    return value + 1.0


@node("origin.down")
def down(value: float) -> float:
    return value - 1.0


@node("origin.cut")
def cut(
    value: float, *, length: Annotated[float, Unit("frames")], reach: Annotated[float, Unit("mm")]
) -> float:
    """Cut a value.

    Parameters
    ----------
    value
    length
        How much.
    reach
        How far.
    """
    return value - length - reach


@node("origin.score")
def score(estimate: float, truth: float) -> float:
    return estimate - truth


@node("origin.gather")
def gather(scores: Across[float]) -> Total:
    return Total(sum(scores.values()))


class Plugin:
    """Keeps the origins that its renderer gets."""

    def __init__(self) -> None:
        self.origins: list[Provenance] = []

    @hookimpl
    def nodegraph_kinds(self) -> list[Kind]:
        def render_in_run(value: Total, title: str, origin: Provenance) -> Rendered:
            self.origins.append(origin)
            return Rendered("", "shown", lead="<p>at a glance</p>")

        return [Kind(Total, lambda value, title: Rendered("", "alone"), render_in_run)]


def origin_in(text: str) -> tuple[Run, Provenance]:
    """Return the run of a graph, and the origin of its table."""
    plugin = Plugin()
    registry = Registry.of([source, up, down, cut, score, gather])
    registry.loaded.append(Loaded("origins", plugin))
    graph = build(read_graph_text(text, "origin.yaml", Path()), registry)
    run = execute(plan(graph), keep=list(graph.nodes))
    study = compose(run).study
    assert [section.rendered.text for section in study.sections] == ["shown"]
    return run, plugin.origins[0]


@pytest.fixture
def origin() -> Provenance:
    return origin_in(GRAPH)[1]


def test_the_inputs_of_a_score_are_those_of_its_combination(origin: Provenance) -> None:
    assert origin.node == "table"
    assert origin.inputs({"trial": 2, "fill": "up"}) == {"estimate": 3.0, "truth": 2.0}
    assert origin.inputs({"trial": 1, "fill": "down", "gap": 7}) == {"estimate": 0.0, "truth": 1.0}
    assert origin.inputs({"trial": 3, "fill": "up"}) is None
    assert origin.inputs({"fill": "up"}) is None
    assert origin.open_axes({"fill": "up", "gap": 7}) == {"trial": (1, 2)}


def test_the_time_of_a_method_is_that_of_all_steps_that_it_alone_needs() -> None:
    run, origin = origin_in(OWN)
    seconds = {(step.node, *step.labels.values()): end.seconds for step, end in run.settled()}
    assert origin.seconds("fill") == {
        "up": [seconds["fill", at, "up"] + seconds["higher", at] for at in (1, 2)],
        "down": [seconds["fill", at, "down"] for at in (1, 2)],
    }


def test_methods_have_times_names_and_commands(origin: Provenance) -> None:
    assert set(origin.seconds("fill")) == {"up", "down"}
    assert not origin.seconds("trial")
    assert not origin.summaries("trial")
    assert origin.summaries("fill") == {"up": "Add one.", "down": ""}
    command = origin.command({"trial": 2, "fill": "up"})
    assert "--until score" in command
    assert "trial=2" in command


def test_axes_have_the_meaning_of_the_setting_that_takes_their_labels() -> None:
    run, _ = origin_in(GRAPH)
    meanings = {axis.name: axis.meaning for axis in compose(run).study.axes}
    assert meanings["length"] == "How much."
    assert meanings["trial"] == meanings["fill"] == ""
    # labels that are names stand for values with a unit
    assert meanings["reach"] == "How far."

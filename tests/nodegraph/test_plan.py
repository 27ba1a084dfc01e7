"""Steps of a plan: combinations, order, gathered inputs, skipped combinations."""

from __future__ import annotations

from collections.abc import Callable

import networkx as nx
import pytest

from nodegraph import Absent, Across, node
from nodegraph.execute.results import Run
from nodegraph.graph import Graph
from nodegraph.plan import Output, Plan
from nodegraph.plan import plan as make_plan

TEXT = """
axes: {trial: {count: 3}, length: [5, 15]}
nodes:
  capture: {use: read.number}
  gaps: {use: gaps.cut, in: capture, with: {length: $length, seed: $trial}}
  fill: {in: gaps, alternatives: {hold: fill.hold, scale: fill.scale, pass: {}}}
  error: {use: score.gaps, in: {estimate: fill, truth: gaps.truth, hidden: gaps.hidden}}
  table: {use: compare.table, in: error}
"""


def counts(plan: Plan) -> dict[str, int]:
    return {name: len(set(cells.values())) for name, cells in plan.cells.items()}


def test_every_combination_has_one_step(graph_of: Callable[..., Graph]) -> None:
    plan = make_plan(graph_of(TEXT))
    assert counts(plan) == {"capture": 1, "gaps": 6, "fill": 18, "error": 18, "table": 1}
    assert len(plan.steps) == 44
    assert [step.index for step in plan.steps] == list(range(44))
    cells = plan.cells["error"]
    assert set(cells) == {
        (trial, length, fill)
        for trial in range(3)
        for length in (5, 15)
        for fill in ("hold", "scale", "pass")
    }
    step = plan.steps[cells[2, 15, "scale"]]
    assert step.labels == {"trial": 2, "length": 15, "fill": "scale"}
    assert step.name == "error(trial=2, length=15, fill=scale)"
    assert step.inputs["hidden"] == Output(plan.cells["gaps"][2, 15], 2)
    assert plan.steps[plan.cells["capture"][()]].name == "capture"


def test_a_step_comes_after_what_it_needs(graph_of: Callable[..., Graph]) -> None:
    for step in make_plan(graph_of(TEXT)).steps:
        assert all(needed < step.index for needed in step.needed)


def test_the_network_of_steps_has_what_each_step_needs(graph_of: Callable[..., Graph]) -> None:
    plan = make_plan(graph_of(TEXT))
    error = plan.steps[plan.cells["error"][2, 15, "scale"]]
    steps = [plan.steps[index] for index in sorted(nx.ancestors(plan.network, error.index))]
    assert [step.name for step in steps] == [
        "capture",
        "gaps(trial=2, length=15)",
        "fill(trial=2, length=15, fill=scale)",
    ]


def test_a_branch_is_finished_before_the_next_begins(graph_of: Callable[..., Graph]) -> None:
    plan = make_plan(graph_of(TEXT))
    errors = [step.index for step in plan.steps if step.node == "error"]
    gaps = [step.index for step in plan.steps if step.node == "gaps"]
    assert sum(index < errors[0] for index in gaps) == 1
    assert sum(index < errors[3] for index in gaps) == 2


def test_equal_calls_are_one_step(graph_of: Callable[..., Graph]) -> None:
    plan = make_plan(
        graph_of(
            """
            axes: {k: {a: 1, b: 1, c: 2}}
            nodes:
              one: {use: read.number, with: {start: $k}}
              two: {use: read.number, with: {start: 1}}
              three: {use: read.number}
              four: {use: fill.hold, in: one}
              five: {alternatives: {x: {use: fill.hold, in: one}, y: {use: fill.hold, in: two}}}
            """
        )
    )
    assert counts(plan) == {"one": 2, "two": 1, "three": 1, "four": 2, "five": 2}
    assert len(plan.steps) == 4
    assert len(plan.cells["five"]) == 6


def test_an_alternative_does_not_repeat_along_its_siblings_axes(
    graph_of: Callable[..., Graph],
) -> None:
    plan = make_plan(
        graph_of(
            """
            axes: {power: [1, 2, 3]}
            nodes:
              n: {use: read.number}
              fill:
                in: n
                alternatives: {a: fill.hold, b: {use: fill.scale, with: {power: $power}}}
            """
        )
    )
    assert len(plan.cells["fill"]) == 6
    assert counts(plan)["fill"] == 4


def test_a_gathering_port_is_fed_in_the_order_of_the_labels(
    graph_of: Callable[..., Graph],
) -> None:
    plan = make_plan(graph_of(TEXT))
    fed = plan.steps[plan.cells["table"][()]].inputs["scores"]
    assert isinstance(fed, Across)
    assert fed.axes == ("trial", "length", "fill")
    assert [tuple(labels.values()) for labels, _ in fed] == list(plan.cells["error"])


def test_a_gathering_port_knows_every_label_of_its_axes(graph_of: Callable[..., Graph]) -> None:
    plan = make_plan(
        graph_of(
            f"""{TEXT.rstrip()}
  some: {{use: compare.table, in: {{from: error, at: {{trial: 1}}}}}}
  two:
    use: compare.table
    in:
      scores:
        pass: {{from: error, at: {{fill: pass, length: 5, trial: 1}}}}
        hold: {{from: error, at: {{fill: hold, length: 5, trial: 1}}}}
  own:
    use: compare.table
    in:
      scores:
        mine: {{from: error, at: {{fill: pass, length: 5, trial: 1}}}}
        hold: {{from: error, at: {{fill: hold, length: 5, trial: 1}}}}
"""
        )
    )
    known = {}
    for name in ("some", "two", "own"):
        fed = plan.steps[next(iter(plan.cells[name].values()))].inputs["scores"]
        assert isinstance(fed, Across)
        known[name] = fed.known
    assert known["some"] == {"length": (5, 15), "fill": ("hold", "scale", "pass")}
    assert known["two"] == {"scores": ("hold", "scale", "pass")}
    assert known["own"] == {"scores": ("mine", "hold")}


@pytest.mark.parametrize(
    ("capture", "scores", "sources"),
    [
        ("with: {start: $actor}", "error", ("actor",)),
        ("alternatives: {a: read.number, b: {use: read.number, with: {start: 2}}}", "error",
         ("capture",)),
        ("with: {start: 3}", "error", ()),
        ("with: {start: 3}", "{mine: error, other: again}", ("scores", "actor")),
        ("with: {start: 3}", "{mine: error, gappy: gaps.gappy}", ()),
    ],
)  # fmt: skip
def test_a_gathering_port_knows_along_which_axes_the_data_differ(
    graph_of: Callable[..., Graph], capture: str, scores: str, sources: tuple[str, ...]
) -> None:
    use = "" if "alternatives" in capture else "use: read.number, "
    plan = make_plan(
        graph_of(
            f"""
            axes: {{actor: [1.0, 2.0], trial: {{count: 2}}}}
            nodes:
              capture: {{{use}{capture}}}
              gaps: {{use: gaps.cut, in: capture, with: {{seed: $trial, length: 1}}}}
              fill: {{in: gaps, alternatives: {{hold: fill.hold, scale: fill.scale}}}}
              error: {{use: strict.positive, in: fill}}
              again: {{use: read.number, with: {{start: $actor}}}}
              table: {{use: compare.table, in: {{scores: {scores}}}}}
            """
        )
    )
    fed = plan.steps[next(iter(plan.cells["table"].values()))].inputs["scores"]
    assert isinstance(fed, Across)
    assert fed.sources == sources


def test_a_gathering_port_knows_the_fields_of_labels(graph_of: Callable[..., Graph]) -> None:
    """Those of axes along which the data differ, and those along which they are treated."""
    plan = make_plan(
        graph_of(
            """
            axes:
              actor: {a: {file: 1.0, age: 30}, b: {file: 2.0, age: 40, hair: brown}}
              cut: {short: {frames: 1, kind: easy}, long: {frames: 2, kind: hard}}
            nodes:
              capture: {use: read.number, with: {start: $actor}}
              gaps: {use: gaps.cut, in: capture, with: {length: $cut.frames}}
              error: {use: strict.positive, in: gaps}
              table: {use: compare.table, in: error}
            """
        )
    )
    fed = plan.steps[next(iter(plan.cells["table"].values()))].inputs["scores"]
    assert isinstance(fed, Across)
    assert fed.fields == {
        "actor.age": {"a": 30, "b": 40},
        "cut.frames": {"short": 1, "long": 2},
        "cut.kind": {"short": "easy", "long": "hard"},
    }


@pytest.mark.parametrize(
    ("scale", "unused"),
    [
        ("{use: fill.scale, with: {power: $power}}", {"hold": ("power", "k"), "scale": ("k",)}),
        ("{use: fill.scale, with: {power: $k, max_gap: $power}}", {"hold": ("power", "k")}),
        ("fill.scale", {"hold": ("power", "k"), "scale": ("power", "k")}),
    ],
)
def test_a_gathering_port_knows_which_axes_an_entry_does_not_have(
    run_of: Callable[..., Run], scale: str, unused: dict[str, tuple[str, ...]]
) -> None:
    """Those of the settings of another method, or of no method that is run."""
    run = run_of(
        f"""
        axes: {{power: [1, 2], k: [1, 2, 3], trial: {{count: 2}}}}
        nodes:
          n: {{use: read.number, with: {{start: $trial}}}}
          fill:
            in: n
            alternatives:
              hold: fill.hold
              scale: {scale}
              other: {{use: fill.scale, with: {{power: $power, max_gap: $k}}}}
          table: {{use: compare.table, in: fill}}
        report: [table]
        """,
    )
    scores = run["table"].value.scores
    assert len(scores.unused) == len(scores)
    for (labels, _), names in zip(scores, scores.unused, strict=True):
        assert names == unused.get(labels["fill"], ())


@node("fill.near", lookahead=lambda settings: settings["reach"], ends=False)
def near(recording: float, *, reach: int = 0) -> float:
    return recording


@node(
    "fill.far",
    cite="hold2001",
    adapted="from One 2001: all of it",
    lookahead=None,
    ends=lambda settings: settings["bend"],
)
def far(recording: float, *, bend: bool = True) -> float:
    return recording


def test_a_gathering_port_knows_what_the_methods_declare(graph_of: Callable[..., Graph]) -> None:
    text = """
        axes: {reach: [2, 7], bend: [true, false]}
        nodes:
          n: {use: read.number}
          fill:
            in: n
            alternatives:
              near: {use: fill.near, with: {reach: $reach}}
              far: {use: fill.far}
              bent: {use: fill.far, with: {bend: $bend}}
              scale: {use: fill.scale}
          table: {use: compare.table, in: fill}
        """
    plan = make_plan(graph_of(text, more=(near, far)))
    gathered = plan.steps[plan.cells["table"][()]].inputs["scores"]
    assert isinstance(gathered, Across)
    adapted = "from One 2001: all of it"
    assert gathered.methods == {
        "fill": {
            "near": {"axes": ("reach",), "lookahead": 7, "ends": False},
            "far": {"adapted": adapted, "lookahead": None, "ends": True},
            "bent": {"adapted": adapted, "axes": ("bend",), "lookahead": None, "ends": None},
            "scale": {},
        }
    }


def test_a_gathering_port_knows_the_units_of_labels(
    graph_of: Callable[..., Graph],
) -> None:
    plan = make_plan(graph_of(TEXT))
    (step,) = (plan.steps[at] for at in plan.cells["table"].values())
    gathered = next(each for each in step.inputs.values() if isinstance(each, Across))
    assert (gathered.units, gathered.files) == ({"length": "frames"}, ())


def test_skipped_combinations_have_no_step(graph_of: Callable[..., Graph]) -> None:
    plan = make_plan(
        graph_of(f"{TEXT}skip: [{{trial: 0, fill: [hold, pass]}}, {{trial: 2, length: 15}}]")
    )
    assert counts(plan) == {"capture": 1, "gaps": 5, "fill": 11, "error": 11, "table": 1}
    assert plan.skipped["gaps"] == {(2, 15): "skip: trial = 2, length = 15"}
    assert plan.skipped["fill"][0, 5, "hold"] == "skip: trial = 0, fill = hold or pass"
    fed = plan.steps[plan.cells["table"][()]].inputs["scores"]
    assert isinstance(fed, Across)
    assert len(fed.entries) == 11
    assert (
        Absent(
            {"trial": 2, "length": 15, "fill": "scale"}, "skipped", "skip: trial = 2, length = 15"
        )
        in fed.absent
    )


def test_what_reads_a_skipped_combination_is_skipped(graph_of: Callable[..., Graph]) -> None:
    plan = make_plan(
        graph_of(
            """
            axes: {k: [1, 2]}
            nodes:
              a: {use: read.number, with: {start: $k}}
              b: {use: fill.hold, in: {from: a, at: {k: 2}}}
              c: {use: compare.table, in: b}
              d: {use: compare.table, in: a}
              e: {use: compare.beside, in: {scores: b, reference: a}}
            skip: [{k: 2}]
            """
        )
    )
    assert counts(plan) == {"a": 1, "b": 0, "c": 0, "d": 1, "e": 0}
    assert plan.skipped["b"] == {(): "skip: k = 2"}
    assert plan.skipped["c"] == {(): "everything that it gathers is left out"}
    assert set(plan.skipped["e"]) == {(1,), (2,)}


def test_a_long_chain_needs_no_deep_stack(graph_of: Callable[..., Graph]) -> None:
    lines = [f"  n{i}: {{use: fill.hold, in: n{i - 1}}}" for i in range(1, 3000)]
    plan = make_plan(graph_of("nodes:\n  n0: {use: read.number}\n" + "\n".join(lines)))
    assert [step.node for step in plan.steps] == [f"n{i}" for i in range(3000)]

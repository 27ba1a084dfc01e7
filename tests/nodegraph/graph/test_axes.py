"""Which axes a node has; what is matched and what is gathered."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import pytest

from nodegraph import Across
from nodegraph.execute.results import Run
from nodegraph.graph import Graph
from tests.nodegraph.conftest import ProblemsOf

TEXT = """
axes: {i: [1, 2], j: [10, 20], k: [100, 200]}
nodes:
  a: {use: read.number, with: {start: $i}}
  b: {use: fill.scale, in: a, with: {power: $j}}
  c: {use: read.number, with: {start: $k}}
"""


def pairs(gathered: Across[object]) -> list[tuple[tuple[object, ...], object]]:
    return [(tuple(labels.values()), value) for labels, value in gathered]


def axes_of(graph: Graph, name: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    return graph.nodes[name].axes, graph.nodes[name].gathered


@pytest.mark.parametrize(
    ("node", "axes", "gathered"),
    [
        ("{use: fill.hold, in: b}", ("i", "j"), ()),
        ("{use: fill.scale, in: b, with: {power: $k}}", ("i", "j", "k"), ()),
        ("{use: compare.table, in: b}", (), ("i", "j")),
        ("{use: compare.table, in: b, over: [i]}", ("j",), ("i",)),
        ("{use: compare.table, in: b, over: [j, i]}", (), ("i", "j")),
        ("{use: compare.table, in: b, over: []}", ("i", "j"), ()),
        ("{use: compare.beside, in: {scores: b, reference: a}}", ("i",), ("j",)),
        ("{use: compare.beside, in: {scores: b, reference: c}}", ("k",), ("i", "j")),
        (
            "{use: compare.beside, in: {scores: b, reference: a}, with: {weight: $k}}",
            ("i", "k"),
            ("j",),
        ),
        (
            "{use: compare.beside, in: {scores: b, reference: c}, with: {weight: $j}}",
            ("j", "k"),
            ("i",),
        ),
        ("{use: compare.table, in: {scores: b, floor: c}}", (), ("i", "j", "k")),
        ("{use: compare.table, in: {scores: {from: b, at: {i: 1}}}}", (), ("j",)),
        ("{use: fill.hold, in: {from: b, at: {i: 1}}}", ("j",), ()),
        ("{use: plot.stages, in: {recordings: {x: a, y: b}}}", (), ("i", "j")),
        ("{use: plot.stages, in: {recordings: {x: a, y: b}, reference: a}}", ("i",), ("j",)),
        ("{use: plot.stages, in: {recordings: {x: a, y: b}}, over: [j]}", ("i",), ("j",)),
    ],
)
def test_plain_ports_and_settings_are_matched_and_the_rest_is_gathered(
    graph_of: Callable[..., Graph], node: str, axes: tuple[str, ...], gathered: tuple[str, ...]
) -> None:
    assert axes_of(graph_of(f"{TEXT}  x: {node}\n"), "x") == (axes, gathered)


def test_two_inputs_that_share_an_axis_are_taken_together_and_others_multiply(
    run_of: Callable[..., Run],
) -> None:
    run = run_of(
        """
        axes: {i: [p, q], j: [r, s]}
        nodes:
          a: {use: text.write, with: {text: $i}}
          b: {use: text.join, in: a, with: {mark: $j}}
          c: {use: text.join, in: {first: a, second: b}}
        """
    )
    assert [(tuple(at.values()), value) for at, value in run["c"]] == [
        (("p", "r"), "(p+(prNone))"),
        (("p", "s"), "(p+(psNone))"),
        (("q", "r"), "(q+(qrNone))"),
        (("q", "s"), "(q+(qsNone))"),
    ]


def test_gathering_without_over_takes_everything(run_of: Callable[..., Run]) -> None:
    seen = run_of(f"{TEXT}  x: {{use: compare.table, in: b}}\n")["x"].value.scores
    assert seen.axes == ("i", "j")
    assert pairs(seen) == [((1, 10), 10), ((1, 20), 20), ((2, 10), 20), ((2, 20), 40)]


def test_over_limits_gathering(run_of: Callable[..., Run]) -> None:
    run = run_of(f"{TEXT}  x: {{use: compare.table, in: b, over: [i]}}\n")
    assert {at["j"]: pairs(seen.scores) for at, seen in run["x"]} == {
        10: [((1,), 10), ((2,), 20)],
        20: [((1,), 20), ((2,), 40)],
    }


def test_axes_of_a_plain_port_are_matched_label_by_label(run_of: Callable[..., Run]) -> None:
    run = run_of(f"{TEXT}  x: {{use: compare.beside, in: {{scores: b, reference: a}}}}\n")
    assert {at["i"]: (seen.truth, pairs(seen.scores)) for at, seen in run["x"]} == {
        1: (1, [((10,), 10), ((20,), 20)]),
        2: (2, [((10,), 20), ((20,), 40)]),
    }


def test_labelled_sources_lie_along_an_axis_named_after_the_port(
    run_of: Callable[..., Run],
) -> None:
    text = f"{TEXT}  x: {{use: plot.stages, in: {{recordings: {{before: a, after: b, 3: c}}}}}}\n"
    seen = run_of(text, only={"i": (1,), "k": (100,)})["x"].value.scores
    assert seen.axes == ("recordings", "i", "j", "k")
    assert pairs(seen) == [
        (("before", 1, "", ""), 1),
        (("after", 1, 10, ""), 10),
        (("after", 1, 20, ""), 20),
        (("3", "", "", 100), 100),
    ]


def test_labelled_sources_match_the_axes_of_plain_ports(run_of: Callable[..., Run]) -> None:
    text = f"{TEXT}  x: {{use: plot.stages, in: {{recordings: {{u: c, v: b}}, reference: a}}}}\n"
    run = run_of(text, only={"k": (100,)})
    assert {at["i"]: pairs(seen.scores) for at, seen in run["x"]} == {
        1: [(("u", "", 100), 100), (("v", 10, ""), 10), (("v", 20, ""), 20)],
        2: [(("u", "", 100), 100), (("v", 10, ""), 20), (("v", 20, ""), 40)],
    }


def test_labelled_sources_may_be_fixed(run_of: Callable[..., Run]) -> None:
    fixed = "{recordings: {u: {from: b, at: {i: 2}}, v: {from: b, at: {i: 1, j: 10}}}}"
    seen = run_of(f"{TEXT}  x: {{use: plot.stages, in: {fixed}}}\n")["x"].value.scores
    assert pairs(seen) == [(("u", 10), 20), (("u", 20), 40), (("v", ""), 10)]


def test_a_port_named_like_an_axis_that_it_gathers_is_an_error(problems_of: ProblemsOf) -> None:
    text = """
        axes: {recordings: [1, 2]}
        nodes:
          a: {use: read.number, with: {start: $recordings}}
          x: {use: plot.stages, in: {recordings: {u: @@a, v: a}}}
        """
    (problem,) = problems_of(text)
    assert "'recordings'" in problem.message


@pytest.mark.parametrize(
    ("node", "expected", "instead"),
    [
        ("{use: compare.table, in: b, over: [@@k]}", "x: no axis 'k' to gather", "i, j"),
        ("{use: compare.table, in: b, over: [@@{a: 1}]}", "x: no axis", "i, j"),
        (
            "{use: compare.beside, in: {scores: b, reference: a}, over: [@@i]}",
            "x: 'i' is an axis of its plain ports or settings",
            "cannot be gathered",
        ),
        ("{use: fill.hold, in: b, over: [@@i]}", "x: 'over' needs a port that gathers", ""),
        ("{use: fill.hold, in: {from: @@b, at: {k: 1}}}", "'b' has no axis 'k'", "axes of b: i, j"),
        (
            "{use: fill.hold, in: {from: @@b, at: {i: 7}}}",
            "axis 'i' has no label 7",
            "labels: 1, 2",
        ),
        ("{use: fill.hold, in: {from: @@b, at: {i: '1'}}}", "axis 'i' has no label '1'", "1, 2"),
    ],
)
def test_an_unknown_axis_or_label(
    problems_of: ProblemsOf, node: str, expected: str, instead: str
) -> None:
    problems = problems_of(f"{TEXT}  d: {{use: fill.hold, in: c}}\n  x: {node}\n")
    assert expected in problems[0].message
    assert instead in problems[0].instead


def test_axes_of_methods_that_the_command_leaves_out_stay(run_of: Callable[..., Run]) -> None:
    text = TEXT + (
        "  f: {in: b, alternatives: {hold: {use: fill.hold}, scale: "
        "{use: fill.scale, with: {power: $k}}}}\n"
        "  x: {use: compare.table, in: {scores: {from: f, at: {i: 1, k: 200, f: $first}}}}\n"
        "skip: [{j: 10, k: 200}]\n"
    )
    run = run_of(text, only={"f": ("hold",)})
    assert run.plan.graph.nodes["f"].axes == ("i", "j", "k", "f")
    at_20 = [step for labels, step in run.plan.cells["f"].items() if labels[:2] == (1, 20)]
    assert len(at_20) == 2
    assert len(set(at_20)) == 1
    assert pairs(run["x"].value.scores) == [((20,), run["f"].at(i=1, j=20, k=200, f="hold"))]


def test_what_does_not_depend_on_an_axis_runs_once(
    run_of: Callable[..., Run], calls: list[str]
) -> None:
    run_of(
        """
        axes: {length: [1, 2, 3], unused_by_number: {a: 1, b: 2}}
        nodes:
          a: {use: read.number}
          b: {use: gaps.cut, in: a, with: {length: $length, seed: $unused_by_number}}
        """
    )
    assert (calls.count("read.number"), calls.count("gaps.cut")) == (1, 6)


@pytest.mark.parametrize(
    ("axis", "expected"),
    [
        ("[5, 6]", {5: 5, 6: 6}),
        ("{a: 5, b: 6}", {"a": 5, "b": 6}),
        ("{count: 2}", {0: 0, 1: 1}),
        ("{range: [5, 6, 1]}", {5: 5, 6: 6}),
    ],
)
def test_every_form_of_axis_reaches_the_node(
    run_of: Callable[..., Run], axis: str, expected: Mapping[object, float]
) -> None:
    run = run_of(f"axes: {{k: {axis}}}\nnodes: {{a: {{use: read.number, with: {{start: $k}}}}}}")
    assert {at["k"]: value for at, value in run["a"]} == expected


def test_one_axis_may_hold_several_settings_in_lockstep(run_of: Callable[..., Run]) -> None:
    run = run_of(
        """
        axes: {actor: {ME: {start: 1, power: 10}, MB: {start: 2, power: 20}}}
        nodes:
          a: {use: read.number, with: {start: $actor.start}}
          b: {use: fill.scale, in: a, with: {power: $actor.power}}
        """
    )
    assert {at["actor"]: value for at, value in run["b"]} == {"ME": 10, "MB": 40}

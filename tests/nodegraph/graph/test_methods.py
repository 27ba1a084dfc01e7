"""Alternatives: mapping, list, family, family with own labels, pass."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from nodegraph import Across, node
from nodegraph.errors import GraphError
from nodegraph.execute.results import Run
from nodegraph.graph import Graph
from nodegraph.node.ports import Port
from tests.nodegraph.conftest import ProblemsOf


@node("fill.twice")
def twice(recording: float, *, max_gap: int | None = None) -> float:
    return 2 * recording


@node("fill.needs")
def needs(recording: float, reference: float) -> float:
    return recording


@node("fill.optional")
def optional(recording: float, reference: float | None = None) -> float:
    return recording


@node("fill.words")
def words(recording: float) -> str:
    return ""


@node("mean.all")
def mean(parts: Across[float]) -> float:
    return sum(parts.values()) / len(parts)


def methods(graph: Graph, name: str = "fill") -> dict[str, str]:
    return {label: method.node.name for label, method in graph.nodes[name].methods.items()}


@pytest.mark.parametrize(
    ("alternatives", "expected"),
    [
        ("{one: {use: fill.hold}, two: fill.scale}", {"one": "fill.hold", "two": "fill.scale"}),
        ("[fill.scale, fill.hold]", {"scale": "fill.scale", "hold": "fill.hold"}),
        ("[toys:fill.hold]", {"toys:hold": "fill.hold"}),
        ("[fill.hold, pass]", {"hold": "fill.hold", "pass": "pass"}),
        ("fill.*", {"hold": "fill.hold", "scale": "fill.scale"}),
        ("[fill.*]", {"hold": "fill.hold", "scale": "fill.scale"}),
        ("{fill.*: }", {"hold": "fill.hold", "scale": "fill.scale"}),
        (
            "{fill.*: {}, hold: {use: fill.scale, with: {power: 3}}, most: fill.scale, pass: {}}",
            {"hold": "fill.scale", "scale": "fill.scale", "most": "fill.scale", "pass": "pass"},
        ),
        ("{hold: fill.scale, fill.*: {}}", {"hold": "fill.scale", "scale": "fill.scale"}),
        ("{without: {use: pass}, hold: fill.hold}", {"without": "pass", "hold": "fill.hold"}),
    ],
)
def test_alternatives_have_every_form(
    graph_of: Callable[..., Graph], alternatives: str, expected: dict[str, str]
) -> None:
    graph = graph_of(
        f"nodes: {{n: {{use: read.number}}, fill: {{in: n, alternatives: {alternatives}}}}}"
    )
    assert methods(graph) == expected
    assert graph.axes["fill"].labels == tuple(expected)
    assert graph.nodes["fill"].axes == ("fill",)


def test_a_third_party_method_joins_its_family(graph_of: Callable[..., Graph]) -> None:
    text = "nodes: {n: {use: read.number}, fill: {in: n, alternatives: fill.*}}"
    assert list(methods(graph_of(text, more=[twice]))) == ["hold", "scale", "twice"]
    assert list(methods(graph_of(text, more=[optional]))) == ["hold", "optional", "scale"]


@pytest.mark.parametrize(
    ("method", "family", "instead"),
    [
        (needs, "@@fill.*", "(recording: float, reference: float) -> float differs from"),
        (words, "fill.*", "(recording: float) -> str differs from (recording: float) -> float"),
    ],
)
def test_a_method_that_differs_from_its_family_is_named(
    problems_of: ProblemsOf, method: Callable[..., object], family: str, instead: str
) -> None:
    text = f"nodes: {{n: {{use: read.number}}, fill: @@{{in: n, alternatives: {family}}}}}"
    problems = problems_of(text, more=[method])
    name = f"fill.{method.__name__}"
    assert problems[0].message == f"{name!r} cannot be an alternative to 'fill.hold'"
    assert problems[0].instead.startswith(instead)


def test_shared_wires_and_settings_hold_for_all_and_own_ones_come_on_top(
    run_of: Callable[..., Run],
) -> None:
    run = run_of(
        """
        nodes:
          n: {use: read.number, with: {start: 10}}
          m: {use: read.number, with: {start: 20}}
          fill:
            in: n
            with: {power: 3}
            alternatives:
              shared: fill.scale
              own: {use: fill.scale, with: {power: 5}}
              other: {use: fill.scale, in: m}
              named: {use: fill.scale, in: {recording: m}}
        """
    )
    values = {label["fill"]: value for label, value in run["fill"]}
    assert values == {"shared": 30, "own": 50, "other": 60, "named": 60}


def test_a_setting_for_the_whole_family(graph_of: Callable[..., Graph]) -> None:
    graph = graph_of(
        """
        nodes:
          n: {use: read.number}
          fill: {in: n, alternatives: {fill.*: {with: {max_gap: 3}}}}
        """
    )
    settings = {
        label: method.settings.values[()] for label, method in graph.nodes["fill"].methods.items()
    }
    assert {label: values["max_gap"] for label, values in settings.items()} == {
        "hold": 3,
        "scale": 3,
    }


def test_a_setting_beside_a_family_goes_to_the_methods_that_have_it(
    graph_of: Callable[..., Graph],
) -> None:
    text = "nodes: {n: {use: read.number}, fill: {in: n, with: {power: 3}, alternatives: fill.*}}"
    fill = graph_of(text).nodes["fill"]
    values = {label: method.settings.values[()] for label, method in fill.methods.items()}
    assert values["scale"]["power"] == 3
    assert "power" not in values["hold"]
    with pytest.raises(GraphError) as caught:
        graph_of(text.replace("power", "max_gpa"))
    assert [problem.message for problem in caught.value.problems] == [
        f"fill ({label}): fill.{label} has no setting 'max_gpa'" for label in ("hold", "scale")
    ]


def test_a_shared_setting_that_an_alternative_lacks_is_an_error(problems_of: ProblemsOf) -> None:
    problems = problems_of(
        """
        nodes:
          n: {use: read.number}
          fill: {in: n, with: {power: @@3}, alternatives: [fill.hold, fill.scale]}
        """
    )
    assert problems[0].message == "fill (hold): fill.hold has no setting 'power'"


def test_pass_hands_on_its_input_named_and_typed_as_its_siblings(
    run_of: Callable[..., Run],
) -> None:
    run = run_of(
        """
        nodes:
          n: {use: read.number, with: {start: 5}}
          cut: {in: n, with: {length: 2}, alternatives: {gaps.*: {}, pass: {}}}
          after: {use: fill.hold, in: cut.gappy}
        """
    )
    assert {at["cut"]: value for at, value in run["after"]} == {"cut": 4.0, "pass": 6.0}
    passing = run.plan.graph.nodes["cut"].methods["pass"].node
    assert passing.outputs == (Port("gappy", float),)
    assert run["cut"].at(cut="pass") == 5.0


def test_pass_may_have_a_wire_of_its_own_and_nothing_else(
    run_of: Callable[..., Run], problems_of: ProblemsOf
) -> None:
    text = """
        nodes:
          n: {use: read.number, with: {start: 5}}
          m: {use: read.number, with: {start: 7}}
          fill: {in: n, with: {max_gap: 3}, alternatives: {fill.*: {}, pass: {in: m}}}
        """
    assert run_of(text)["fill"].at(fill="pass") == 7
    problems_of(text.replace("{in: m}", "{in: {second: @@m}}"))
    problems_of(text.replace("{in: m}", "{with: {max_gap: @@3}}"))


def test_the_source_of_pass_must_have_its_siblings_type(problems_of: ProblemsOf) -> None:
    problems = problems_of(
        """
        nodes:
          n: {use: read.number}
          t: {use: text.write}
          fill: {in: n, alternatives: {hold: fill.hold, pass: {in: @@t}}}
        """
    )
    assert "fill (pass)" in problems[0].message


def test_pass_beside_methods_that_gather_is_an_error(problems_of: ProblemsOf) -> None:
    text = """
        nodes:
          n: {alternatives: [read.number]}
          all: {in: n, alternatives: {mean.*: {}, pass: @@{}}}
        """
    marked = text.replace("pass: @@{}", "@@pass: {}")
    assert "'pass' hands on one value" in problems_of(marked, more=[mean])[0].message


def test_pass_alone_has_no_sibling(problems_of: ProblemsOf) -> None:
    problems = problems_of("nodes: {n: {use: read.number}, p: {in: n, alternatives: {@@pass: {}}}}")
    assert "'pass' needs another alternative" in problems[0].message


def test_alternatives_may_need_different_ports(run_of: Callable[..., Run]) -> None:
    run = run_of(
        """
        axes: {k: [1, 2]}
        nodes:
          n: {use: read.number, with: {start: 10}}
          m: {use: read.number, with: {start: $k}}
          fill:
            alternatives:
              a: {use: fill.hold, in: n}
              b: {use: fill.needs, in: {recording: n, reference: m}}
        """,
        more=[needs],
    )
    assert run["fill"].axes == ("k", "fill")
    assert len(set(run.plan.cells["fill"].values())) == 3


def test_a_number_cannot_be_the_label_of_an_alternative(problems_of: ProblemsOf) -> None:
    problems = problems_of(
        "nodes: {n: {use: read.number}, f: {in: n, alternatives: {@@3: fill.hold, b: fill.scale}}}"
    )
    assert problems[0].instead == "write a name, such as order_3"

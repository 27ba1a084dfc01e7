"""The number of combinations is checked before anything is computed for each of them."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from nodegraph import GraphError, node
from nodegraph.graph import Graph
from tests.nodegraph.conftest import ProblemsOf


def test_two_axes_of_ten_thousand_labels_are_an_error_with_their_sizes(
    problems_of: ProblemsOf,
) -> None:
    (problem,) = problems_of(
        """
        axes: {j: {count: 10000}, k: {range: [1, 10000, 1]}}
        nodes:
          a: {use: read.number, with: {start: $j}}
          b: @@{use: gaps.cut, in: a, with: {length: 3, seed: $k}}
          c: {use: compare.table, in: b}
        """
    )
    assert problem.message == (
        "b: 100,000,000 combinations, j (10,000) x k (10,000); "
        "a graph may have 5,000,000, and this one has 200,010,000"
    )
    assert "--axis or --only" in problem.instead


def test_settings_of_one_node_alone_are_not_multiplied_out(problems_of: ProblemsOf) -> None:
    text = """
        axes: {j: {count: 100000}, k: {count: 100000}}
        nodes:
          a: @@{use: gaps.cut, in: n, with: {length: @@$j, seed: $k}}
          n: {use: read.number}
        """
    wrong, many = sorted(problems_of(text), key=lambda problem: problem.place.column, reverse=True)
    assert "should be greater than or equal to 1, got 0" in wrong.message
    assert many.message.startswith("a: 10,000,000,000 combinations, j (100,000) x k (100,000)")


def test_many_nodes_add_up_and_the_largest_is_named(problems_of: ProblemsOf) -> None:
    nodes = "\n".join(f"  b{i}: {{use: fill.hold, in: a}}" for i in range(30))
    text = f"""
axes: {{j: {{count: 200000}}, k: [1, 2]}}
nodes:
  a: {{use: read.number, with: {{start: $j}}}}
  z: @@{{use: fill.scale, in: a, with: {{power: $k}}}}
{nodes}
"""
    (problem,) = problems_of(text)
    assert problem.message == (
        "z: 400,000 combinations, j (200,000) x k (2); "
        "a graph may have 5,000,000, and this one has 6,600,000"
    )


def test_what_is_gathered_for_each_combination_counts(problems_of: ProblemsOf) -> None:
    (problem,) = problems_of(
        """
        axes: {j: {count: 3000}, k: {count: 3000}}
        nodes:
          a: {use: read.number, with: {start: $j}}
          b: {use: read.number, with: {start: $k}}
          c: @@{use: compare.beside, in: {scores: a, reference: b}}
        """
    )
    assert problem.message.startswith("c: 9,000,000 combinations, k (3,000) x j (3,000)")


def test_labels_that_are_not_run_do_not_count(graph_of: Callable[..., Graph]) -> None:
    text = """
        axes: {j: {count: 3000}, k: {count: 3000}}
        nodes:
          a: {use: gaps.cut, in: n, with: {length: 1, seed: $k}}
          n: {use: read.number, with: {start: $j}}
        """
    with pytest.raises(GraphError, match="9,000,000 combinations"):
        graph_of(text)
    assert graph_of(text, axes={"j": [1, 2]}).nodes["a"].axes == ("j", "k")
    assert graph_of(text, only={"k": (1,)})


def test_a_number_without_end_is_not_written_out(problems_of: ProblemsOf) -> None:
    axes = ", ".join(f"k{i}: {{count: 1000}}" for i in range(900))
    marks = ", ".join(f"k{i}: $k{i}" for i in range(900))
    text = f"axes: {{{axes}}}\nnodes: {{a: @@{{use: set.any, with: {{named: {{{marks}}}}}}}}}"

    @node("set.any")
    def anything(*, named: dict[str, int]) -> float:
        return 0.0

    (problem,) = problems_of(text, more=[anything])
    assert problem.message.startswith("a: endless combinations, k0 (1,000) x k1 (1,000) x")


@pytest.mark.parametrize("axis", [range(10**9), range(10**30), {"count": 10**9}, [0] * 1_000_001])
def test_an_endless_axis_is_not_listed_first(graph_of: Callable[..., Graph], axis: object) -> None:
    text = "axes: {k: [1]}\nnodes: {a: {use: read.number, with: {start: $k}}}"
    with pytest.raises(GraphError, match=r"--axis k: .*1,000,000") as caught:
        graph_of(text, axes={"k": axis})
    assert len(caught.value.problems) == 1


def test_a_used_graph_counts_with_the_axes_it_gets(messages_of: Callable[..., list[str]]) -> None:
    (message,) = messages_of(
        """
        axes: {k: {count: 3000}}
        nodes:
          n: {use: read.number, with: {start: $k}}
          clean: {use: clean.yaml, in: n}
        """,
        clean="""
        inputs: {x: float}
        axes: {j: {count: 3000}}
        nodes: {cut: @@{use: gaps.cut, in: $x, with: {seed: $j}}}
        outputs: {cut: cut}
        """,
    )
    assert message.startswith("clean.cut: 9,000,000 combinations, k (3,000) x clean.j (3,000)")

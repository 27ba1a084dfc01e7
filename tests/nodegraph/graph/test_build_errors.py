"""All errors of a graph are reported, each at its place with what there is instead."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from nodegraph import GraphError, InputFile, node
from nodegraph.errors import Problem
from nodegraph.graph import Graph
from tests.nodegraph.conftest import ProblemsOf


@pytest.mark.parametrize(
    ("text", "expected", "instead"),
    [
        ("nodes: {a: {use: @@read.numbr}}", "no node 'read.numbr'", "did you mean 'read.number'"),
        (
            "axes: {m: [read.number]}\nnodes: {a: {use: @@$m}}",
            "name nodes, not the value of $m",
            "list them in the node: alternatives: [x.a, x.b]",
        ),
        (
            "inputs: {m: read.number}\nnodes: {a: {alternatives: [pass, @@$m]}}",
            "name nodes, not the value of $m",
            "alternatives: ",
        ),
        ("nodes: {a: {use: @@pass}}", "'pass' stands only among alternatives", ""),
        ("nodes: {a: {use: @@sub.yaml}}", "sub.yaml: no such graph file", "in that folder"),
        (
            "nodes: {a: {use: read.number}, b: {use: fill.hold, in: @@aa}}",
            "b: no node 'aa'",
            "did you mean 'a'",
        ),
        (
            "nodes: {a: {use: read.number}, b: {use: fill.hold, in: @@read.number}}",
            "b: no node 'read'",
            "write a",
        ),
        (
            "nodes: {a: {use: read.number}, b: {use: gaps.cut, in: a}, "
            "c: {use: fill.hold, in: @@b.gapy}}",
            "c: b (gaps.cut) has no output 'gapy'",
            "did you mean 'gappy'? there is: gappy, truth, hidden",
        ),
        (
            "nodes: {a: {use: read.number}, "
            "b: {use: fill.hold, in: {recordin: @@a, recording: a}}}",
            "b: fill.hold has no input port 'recordin'",
            "did you mean 'recording'",
        ),
        ("nodes: {a: {use: read.number, in: @@b}, b: {use: read.number}}", "has no input port", ""),
        (
            "nodes: {a: {use: @@fill.hold}}",
            "a: port recording: float of fill.hold is not fed",
            "write in: {recording: node}",
        ),
        (
            "nodes: {n: {use: read.number}, a: {use: @@fill.hold}}",
            "a: port recording: float of fill.hold is not fed",
            "write in: {recording: n.output}",
        ),
        (
            "nodes: {a: {use: text.write}, b: {use: fill.hold, in: @@a}}",
            "b: a (text.write): 'recording' takes float, not str",
            "",
        ),
        (
            "nodes: {a: {use: read.number}, b: {use: gaps.cut, in: a}, "
            "c: {use: fill.hold, in: @@b.truth}}",
            "'truth' gives the truth to 'recording', which must not see it",
            "write recording: b.gappy; the truth feeds truth ports",
        ),
        (
            "nodes: {a: {use: read.number}, b: {use: fill.hold, in: {recording: @@{x: a}}}}",
            "port 'recording' takes one value, not a mapping of several",
            "",
        ),
        (
            "inputs: {x: 1}\nnodes: {a: {use: read.number, with: {start: $x}}, "
            "b: {use: fill.hold, in: @@$x}}",
            "$x names a value; a port is fed by a node",
            "",
        ),
        (
            "nodes: {a: {use: read.number, with: {start: @@$x}}}",
            "no input or axis 'x'",
            "there is none",
        ),
        (
            "axes: {size: [1, 2]}\n"
            "nodes: {a: {use: read.number, with: {start: @@$sise}}, "
            "b: {use: read.number, with: {start: $size}}}",
            "no input or axis 'sise'",
            "did you mean '$size'? there is: $size",
        ),
        (
            "inputs: {xx: 1, y: @@2}\nnodes: {a: {use: read.number, with: {start: @@$x}}, "
            "b: {use: read.number, with: {start: $xx}}}",
            "nothing uses the input 'y'",
            "$y",
        ),
        ("axes: {k: @@[1]}\nnodes: {a: {use: read.number}}", "nothing uses the axis 'k'", "$k"),
        (
            "nodes: {a: {use: read.number}}\nskip: [@@{k: 1}]",
            "skip: no axis 'k'",
            "axes none",
        ),
        (
            "nodes: {a: {alternatives: [text.write]}}\nskip: [@@{a: read}]",
            "skip: axis 'a' has no label 'read'",
            "labels: write",
        ),
        (
            "nodes: {a: {alternatives: [text.write]}}\nskip: [@@{a: {b: c}}]",
            "skip: axis 'a' has no label {'b': 'c'}",
            "labels: write",
        ),
        (
            "axes: {j: [1], k: [2]}\nnodes: {a: {use: read.number, with: {start: $k}}, "
            "b: {use: read.number, with: {start: $j}}}\nskip: [@@{j: 1, k: 2}]",
            "skip: no node has the axes j and k together",
            "",
        ),
        ("nodes: {a: {use: read.number}}\nreport: [@@b]", "report: no node 'b'", "there is: a"),
        ("nodes: {a: {use: read.number}}\nknown: [@@a.b]", "known: a (read.number) has no", ""),
        ("nodes: {a: {use: read.number}}\noutputs: {x: @@b}", "outputs: no node 'b'", ""),
        (
            "nodes: {a: {use: read.number}}\nrequires: [@@no-such-package-here>=1]",
            "requires no-such-package-here>=1, but it is not installed",
            "pip install",
        ),
        (
            "nodes: {a: {use: read.number}}\nrequires: [@@'pyyaml<1']",
            "is installed",
            "pip install",
        ),
        (
            "nodes: {a: {use: read.number}}\nrequires: [@@{a: 1}]",
            "is not a package",
            "write a package as pip takes it",
        ),
    ],
)
def test_an_error_is_reported_once_at_its_place(
    problems_of: ProblemsOf, text: str, expected: str, instead: str
) -> None:
    problems = problems_of(text)
    assert expected in problems[0].message
    assert instead in problems[0].instead


def test_a_cycle_is_reported_with_its_nodes(problems_of: ProblemsOf) -> None:
    problems = problems_of(
        """
        nodes:
          a: {use: fill.hold, in: @@c}
          b: {use: fill.hold, in: a}
          c: {use: fill.hold, in: b.output}
          d: {use: fill.hold, in: c}
        """
    )
    assert problems[0].message == "'a' feeds itself: a -> b -> c -> a"


def test_every_cycle_is_reported_and_other_errors_too(problems_of: ProblemsOf) -> None:
    problems = problems_of(
        """
        axes: {k: [1, 2]}
        nodes:
          a: {use: fill.hold, in: @@a}
          b: {use: fill.scale, in: @@c, with: {power: $k}}
          c: {use: fill.hold, in: b, with: {max_gap: @@x}}
          d: {use: fill.hold, in: @@nowhere}
          e: {use: compare.table, in: c, over: [k]}
        """
    )
    assert [problem.message.partition(":")[0] for problem in problems] == [
        "'a' feeds itself",
        "'b' feeds itself",
        "c",
        "d",
    ]


def test_nothing_is_reported_that_follows_from_another_error(problems_of: ProblemsOf) -> None:
    problems_of(
        """
        axes: {k: [1, 2], j: [3, 4]}
        nodes:
          a: {use: @@fill.hodl, with: {power: $k}}
          b: {use: fill.scale, in: @@nowhere, with: {power: $j}}
          c: {use: compare.table, in: a, over: [k]}
          d: {use: fill.hold, in: {from: a, at: {k: 1}}}
          e: {use: compare.table, in: b, over: [m]}
          f: {use: compare.beside, in: {scores: a, reference: b}, with: {weight: $k}}
        skip: [{k: 1, j: 3}]
        """
    )


def test_an_alternative_is_named_where_its_wire_does_not_fit(problems_of: ProblemsOf) -> None:
    problems = problems_of(
        """
        nodes:
          a: {use: text.write}
          n: {use: read.number}
          b: {in: n, alternatives: {one: {use: fill.hold}, two: {use: fill.scale, in: @@a}}}
        """
    )
    assert problems[0].message.startswith("b (two): a (text.write): ")


def test_a_port_must_exist_in_every_alternative(problems_of: ProblemsOf) -> None:
    problems = problems_of(
        """
        nodes:
          n: {use: read.number}
          b: {in: n, alternatives: [gaps.cut, fill.hold]}
          c: {use: fill.hold, in: @@b.gappy}
        """
    )
    assert problems[0].message == "c: b (fill.hold) has no output 'gappy'"


def test_a_mistake_that_alternatives_share_is_reported_once(problems_of: ProblemsOf) -> None:
    problems = problems_of(
        """
        nodes:
          b: {in: @@m, alternatives: {one: fill.hold, two: fill.hold, three: gaps.cut}}
          c: {alternatives: {one: text.write, two: text.write}}
          d: {use: fill.hold, in: @@c}
        """
    )
    assert [problem.message for problem in problems] == [
        "b (one): no node 'm'",
        "d: c (text.write): 'recording' takes float, not str",
    ]


def test_each_first_output_must_fit_every_reader(problems_of: ProblemsOf) -> None:
    problems = problems_of(
        """
        nodes:
          b: {alternatives: [read.number, text.write]}
          c: {use: fill.hold, in: @@b}
        """
    )
    assert "b (text.write)" in problems[0].message


EVERY_KIND = """
    @@titel: an unknown key
    notes: @@[not, text]
    inputs: {@@a-b: 1, unused: @@2, text: word}
    axes:
      none: @@[]
      twice: [1, @@1]
      scalar: @@5
      endless: {count: @@1000000000}
      unread: @@[1]
      fields: {x: {a: 1}, y: {b: 2}}
      good: [1, 2]
    nodes:
      n: {use: read.number}
      cut: {use: gaps.cut, in: n, with: {length: $good}}
      unknown: {use: @@read.numbre, with: {start: $none, other: @@$nothing}, in: @@nowhere}
      setting: {use: read.number, with: {strat: @@$twice, start: @@x}}
      axis: {use: fill.scale, in: n, with: {power: $scalar, max_gap: @@1.5}}
      variable: {use: fill.scale, in: n, with: {power: @@$nothing, max_gap: @@fast}}
      empty: {use: fill.scale, in: n, with: {power: $endless, max_gap: @@x}}
      bounds: {use: gaps.cut, in: @@nowhere, with: {length: @@0, seed: @@1.5}}
      field: {use: gaps.cut, in: n, with: {length: @@@@$fields.a, seed: @@$text.part}}
      port: {use: fill.hold, in: {recording: @@cut.gap, other: @@n}}
      truth: {use: fill.hold, in: @@cut.truth}
      type: {use: text.join, in: {first: @@n, second: @@nowhere.x.y}}
      unfed: {use: @@score.gaps, in: {estimate: n, truth: cut.truth}}
      several: {use: fill.hold, in: {recording: @@{a: n, b: @@missing}}}
      value: {use: fill.hold, in: @@$text}
      keys: {@@us: read.number, use: read.number}
      neither: @@{in: n}
      family: {use: @@fill.*, in: n}
      no_family: {in: n, alternatives: @@fil.*}
      no_label: {alternatives: @@[]}
      labels: {in: n, alternatives: {x: {use: @@fill.hodl}, @@3: fill.hold}}
      lacking: {in: n, with: {power: @@3}, alternatives: [fill.hold, fill.scale]}
      passing: {use: @@pass, in: n}
      one: {use: fill.hold, in: @@two}
      two: {use: fill.hold, in: one}
      at_axis: {use: fill.hold, in: {from: @@cut, at: {god: 1}}}
      at_label: {use: fill.hold, in: {from: @@cut, at: {good: 3}}}
      at_form: {use: fill.hold, in: {from: cut, at: @@[good]}}
      over: {use: compare.table, in: cut, over: [@@bad]}
      matched: {use: compare.beside, in: {scores: cut, reference: cut}, over: [@@good]}
      plain: {use: fill.hold, in: n, over: [@@good]}
      file: {use: read.file, with: {path: @@nowhere.txt}}
      file_too: {use: set.two, with: {path: @@nowhere.txt, number: @@x}}
      again: {use: read.number}
      @@again: {use: read.number}
      @@good: {use: read.number}
      graph: {use: @@nowhere.yaml, in: @@nobody}
    skip: [@@@@{nothing: 1, good: 9}, @@{good: 7}, @@[good]]
    known: [@@nobody, n]
    requires: [@@no-such-package-here, numpy]
    outputs: {out: @@n.put}
    report: [@@nobody, @@"not a reference"]
    """


def test_every_kind_of_error_is_reported_at_once(problems_of: ProblemsOf) -> None:
    @node("set.two")
    def two(*, path: InputFile, number: float) -> float:
        return 0.0

    problems = problems_of(EVERY_KIND, more=[two])
    assert len({problem.message for problem in problems}) == 64


def test_the_text_of_an_error_has_place_message_and_hint(graph_of: Callable[..., Graph]) -> None:
    with pytest.raises(GraphError) as caught:
        graph_of("nodes:\n  a: {use: read.numbr}")
    assert str(caught.value) == (
        "toy.yaml:3:12: no node 'read.numbr'\n"
        "    did you mean 'read.number'? there is: read.file, read.number; nodes of a plugin file "
        "need --plugin FILE"
    )


def test_a_family_takes_no_label_and_a_plugin_needs_a_name(
    problems_of: Callable[..., list[Problem]],
) -> None:
    text = """
        nodes:
          a: {use: read.number}
          b: {in: a, alternatives: {one: @@fill.*, two: {use: @@strict.*}}}
          c: {in: a, use: @@":fill.hold"}
        """
    family, other, nameless = problems_of(text)
    assert "'fill.*' has a label for each of its methods" in family.message
    assert other.instead == "write {strict.*: {}}"
    assert "no node ':fill.hold'" in nameless.message

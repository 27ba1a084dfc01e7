"""Errors in graphs used as nodes are reported once, at their place, with all others."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from nodegraph import GraphError, node
from nodegraph.graph import build
from nodegraph.graphfile import read_graph_file
from nodegraph.plugin.registry import Registry
from tests.nodegraph.graph.conftest import MessagesOf

CLEAN = """
    inputs: {recording: float, factor: 2.0}
    nodes:
      twice: {use: fill.scale, in: $recording, with: {power: $factor}}
    outputs: {recording: twice}
    """
OUTER = """
    nodes:
      n: {use: read.number}
      w: {use: text.write}
      clean: {use: clean.yaml, in: n}
    """


def outer(clean: str) -> str:
    return OUTER.replace("{use: clean.yaml, in: n}", clean)


@pytest.mark.parametrize(
    ("clean", "expected"),
    [
        (
            "{use: @@./claen.yaml, in: n}",
            "./claen.yaml: no such graph file | did you mean 'clean.yaml'? in that folder",
        ),
        (
            "{use: @@nowhere/clean.yml, in: n}",
            "nowhere/clean.yml: no such graph file | in that folder there is none",
        ),
        ("@@{use: ., alternatives: [fill.hold], in: n}", "has both 'use' and 'alternatives'"),
        (
            "{use: clean.yaml, in: {recoding: @@n, recording: n}}",
            "clean: clean.yaml has no input port 'recoding' | did you mean 'recording'? ports",
        ),
        (
            "{use: clean.yaml, in: {factor: @@n, recording: n}}",
            "clean: clean.yaml has no input port 'factor' | it is a setting: with: {factor: value}",
        ),
        (
            "{use: clean.yaml, in: n, with: {facter: @@3}}",
            "clean: clean.yaml has no setting 'facter' | did you mean 'factor'? settings: factor",
        ),
        (
            "{use: clean.yaml, in: n, with: {recording: @@3}}",
            "clean: clean.yaml has no setting 'recording' | it is a port: in: {recording: node}",
        ),
        (
            "{use: @@clean.yaml}",
            "clean: port recording: float of clean.yaml is not fed | write in: {recording: node}",
        ),
        (
            "{use: clean.yaml, in: @@w}",
            "clean: w (text.write): 'recording' takes float, not str",
        ),
        ("{use: clean.yaml, in: @@nowhere}", "clean: no node 'nowhere' | there is: n, w, clean"),
        ("{use: clean.yaml, in: @@n.put}", "clean: n (read.number) has no output 'put'"),
        ("{use: clean.yaml, in: {from: @@n, at: {k: 1}}}", "'n' has no axis 'k'"),
        (
            "{use: clean.yaml, in: {recording: @@{a: n, b: n}}}",
            "clean: port 'recording' takes one value, not a mapping of several",
        ),
        (
            "{use: clean.yaml, in: n, with: {factor: @@fast}}",
            "clean.twice: setting 'power' of fill.scale should be a valid number, got 'fast'",
        ),
        ("{use: clean.yaml, in: n, with: {factor: @@$k}}", "no input or axis 'k'"),
        ("{use: clean.yaml, in: n, over: [@@k]}", "clean: 'over' needs a port that gathers"),
        (
            "{in: n, alternatives: {a: {use: clean.yaml, with: {facter: @@3}}, b: fill.hold}}",
            "clean (a): clean.yaml has no setting 'facter'",
        ),
        (
            "{in: n, with: {factor: @@3}, alternatives: {a: clean.yaml, b: fill.hold}}",
            "clean (b): fill.hold has no setting 'factor'",
        ),
        ("{use: fill.hold, in: @@good.recordin}\n      good: {use: clean.yaml, in: n}",
         "clean: good (clean.yaml) has no output 'recordin' | did you mean 'recording'?"),
        ("{use: fill.hold, in: @@good.twice}\n      good: {use: clean.yaml, in: n}",
         "clean: good (clean.yaml) has no output 'twice'"),
        (
            "{use: clean.yaml, in: after}\n      after: {use: fill.hold, in: @@clean}",
            "'after' feeds itself: after -> clean.twice -> clean -> after",
        ),
        ("{use: fill.hold, in: @@$n}", "clean: $n names a value; a port is fed by a node"),
    ],
)  # fmt: skip
def test_an_error_in_the_use_of_a_graph(messages_of: MessagesOf, clean: str, expected: str) -> None:
    (message,) = messages_of(outer(clean), clean=CLEAN)
    assert expected in message


USES = """
    nodes:
      n: {use: read.number}
      w: {use: text.write}
      one: {use: clean.yaml}
      two: {use: clean.yaml}
      three: {alternatives: {a: {use: clean.yaml}}}
      after: {use: fill.hold, in: one.whatever}
    """


@pytest.mark.parametrize(
    ("clean", "expected"),
    [
        ("nodes: {a: {use: @@read.numbr}}\noutputs: {a: a}", "no node 'read.numbr'"),
        ("inputs: {x: @@3}\nnodes: {a: {use: read.number}}\noutputs: {a: a}",
         "nothing uses the input 'x' | write $x as a setting's value"),
        ("axes: {k: @@[1]}\nnodes: {a: {use: read.number}}\noutputs: {a: a}",
         "nothing uses the axis 'k'"),
        ("nodes: {a: {use: read.number}}\noutputs: {a: @@b}", "outputs: no node 'b'"),
        ("nodes: {a: {use: read.number}}\noutputs: {a: @@a.b}", "outputs: a (read.number) has no"),
        ("nodes: {a: {use: read.number}}\noutputs: {x: {from: @@a, at: {k: 1}}}", "no axis 'k'"),
        ("nodes: {a: {use: read.number}}\noutputs: {@@a-b: a}", "'a-b' cannot be a name"),
        ("inputs: {x: 3}\nnodes: {a: {use: fill.hold, in: @@$x}}\noutputs: {a: a}",
         "a: $x names a value; a port is fed by a node"),
        ("inputs: {x: Flaot}\nnodes: {a: {use: fill.hold, in: @@$x}}\noutputs: {a: a}",
         "'x' is a port only if 'Flaot' is the name of a port's type"),
        ("nodes: {n: {use: read.number}, a: {use: fill.hold, in: n}}\noutputs: {a: @@n}",
         "output 'a' is not the node of that name | outside, both would have one name"),
        ("nodes: {a: {alternatives: [read.number, text.write]}}\noutputs: {x: @@a}",
         "output 'x' has no one type: float (read.number), str (text.write)"),
        ("nodes: {a: {use: read.file, with: {path: @@no.txt}}}\noutputs: {a: a}",
         "a: no such file: no.txt"),
        ("nodes: {a: {use: @@missing.yaml}}\noutputs: {a: a}", "missing.yaml: no such graph file"),
    ],
)  # fmt: skip
def test_an_error_inside_is_reported_once_with_its_inner_names(
    messages_of: MessagesOf, clean: str, expected: str
) -> None:
    (message,) = messages_of(USES, clean=clean)
    assert expected in message


@pytest.mark.parametrize(
    ("port", "nodes", "expected"),
    [
        ("@@float", "a: {use: read.number}", "nothing uses the input 'x' | write in: $x"),
        ("float", "b: {use: fill.hold, in: $x}, a: {use: read.number, with: {start: @@$x}}",
         "$x is a port (float), not a value | write in: $x"),
        ("float", "b: {use: fill.hold, in: $x}, a: {use: fill.hold, in: @@$xx}",
         "did you mean '$x'"),
        ("float", "a: {use: fill.hold, in: @@$x.y}", "a: $x (float) has no output 'y'"),
        ("float", "a: {use: fill.hold, in: {from: @@$x, at: {k: 1}}}", "'$x' has no axis 'k'"),
        ("str", "a: {use: fill.hold, in: @@$x}", "a: $x (str): 'recording' takes float, not str"),
    ],
)  # fmt: skip
def test_an_error_at_a_port_is_reported_once(
    messages_of: MessagesOf, port: str, nodes: str, expected: str
) -> None:
    fed = USES.replace("clean.yaml}", f"clean.yaml, in: {'w' if port == 'str' else 'n'}}}")
    (message,) = messages_of(
        fed, clean=f"inputs: {{x: {port}}}\nnodes: {{{nodes}}}\noutputs: {{a: a}}"
    )
    assert expected in message


def test_a_port_cannot_be_declared_as_known(messages_of: MessagesOf) -> None:
    (message,) = messages_of(
        outer("{use: clean.yaml, in: n}"), clean=CLEAN.rstrip() + "\n    known: [@@$recording]\n"
    )
    assert message.startswith("known: $recording comes from outside")


def test_a_graph_without_outputs_is_reported_where_it_is_used(messages_of: MessagesOf) -> None:
    text = "nodes: {a: {use: @@clean.yaml}, b: {use: @@clean.yaml}}"
    messages = messages_of(text, clean="nodes: {a: {use: read.number}}")
    assert messages[0].startswith("a: clean.yaml has no 'outputs'")


@pytest.mark.parametrize(
    ("text", "place", "expected"),
    [
        ("- 1\n", "clean.yaml:1:1", "a graph file is a mapping that begins with 'nodegraph: 1'"),
        ("a: [\n", "clean.yaml:2:1", "this is not YAML"),
        ("markers: [a]\n", "clean.yaml:1:1", "the format's number is missing"),
        ("", "clean.yaml:1:1", "a graph file is a mapping"),
        (b"a\n\xff", "toy.yaml:2:18", "clean.yaml:2:1: not text in UTF-8"),
    ],
)
def test_a_file_that_is_not_a_graph(
    graph_of: Callable[..., object], tmp_path: Path, text: str | bytes, place: str, expected: str
) -> None:
    data = text if isinstance(text, bytes) else text.encode()
    (tmp_path / "clean.yaml").write_bytes(data)
    with pytest.raises(GraphError) as caught:
        graph_of("nodes: {a: {use: clean.yaml}, b: {use: clean.yaml}, c: {use: read.numbr}}")
    messages = [f"{problem.place}: {problem.message}" for problem in caught.value.problems]
    assert (
        sum(message.startswith(f"{place}: ") and expected in message for message in messages) == 1
    )
    assert any("read.numbr" in message for message in messages)


def test_a_folder_is_not_a_graph(graph_of: Callable[..., object], tmp_path: Path) -> None:
    (tmp_path / "clean.yaml").mkdir()
    with pytest.raises(GraphError, match=r"toy.yaml:2:18: clean.yaml: is a folder"):
        graph_of("nodes: {a: {use: clean.yaml}}")
    with pytest.raises(GraphError, match=r"toy.yaml:2:18: .*cannot be read"):
        graph_of('nodes: {a: {use: "cl\\0ean.yaml"}}')


def test_a_graph_that_uses_itself_is_reported_with_the_cycle(messages_of: MessagesOf) -> None:
    (message,) = messages_of(
        "nodes: {a: {use: a.yaml}, b: {use: sub/b.yaml}}",
        a="nodes: {b: {use: sub/b.yaml}}\noutputs: {b: b}",
        sub__b="nodes: {a: {use: @@../a.yaml}}\noutputs: {a: a}",
    )
    assert message.startswith("a.yaml uses itself: a.yaml -> sub/b.yaml -> a.yaml")
    (message,) = messages_of("nodes: {a: {use: @@./toy.yaml}}\noutputs: {a: a}")
    assert message.startswith("toy.yaml uses itself: toy.yaml -> toy.yaml")


def test_a_graph_with_ports_cannot_run_by_itself(
    messages_of: MessagesOf, toys: Registry, tmp_path: Path
) -> None:
    text = """
    inputs: {recording: @@float, factor: 2.0, word: some_text}
    nodes:
      twice: {use: fill.scale, in: $recording, with: {power: $factor}}
      w: {use: text.write, with: {text: $word}}
      wrong: {use: @@fill.scael, in: $recording}
    outputs: {recording: twice}
    """
    messages = messages_of(text)
    assert messages[0] == (
        "toy.yaml takes 'recording' (float) from the graph that uses it; it cannot run by itself"
        " | in another graph: {use: toy.yaml, in: {recording: node}}"
    )
    path = tmp_path / "clean.yaml"
    path.write_text("nodegraph: 1" + CLEAN.replace("\n    ", "\n"))
    with pytest.raises(GraphError) as caught:
        build(read_graph_file(path), toys)
    assert [problem.place.line for problem in caught.value.problems] == [2]


def test_an_input_with_the_name_of_several_types(messages_of: MessagesOf) -> None:
    class Table:
        pass

    first = Table

    class Table:  # type: ignore[no-redef]
        pass

    def make_first() -> object: ...
    def two() -> object: ...

    make_first.__annotations__["return"], two.__annotations__["return"] = first, Table
    first.__module__ = "other"
    (message,) = messages_of(
        "nodes: {t: {use: make.one}, a: {use: clean.yaml, in: t}}",
        clean="inputs: {x: @@Table}\nnodes: {n: {use: read.number}}\noutputs: {n: n, x: $x}",
        more=(node("make.one")(make_first), node("make.two")(two)),
    )
    assert "'Table' is the name of several types: " in message
    assert "other.Table" in message


def test_a_wrong_source_is_reported_once_however_many_ports_read_it(
    messages_of: MessagesOf,
) -> None:
    clean = """
    inputs: {x: float}
    nodes:
      a: {use: fill.hold, in: $x}
      b: {use: fill.hold, in: $x}
      c: {use: inner.yaml, in: $x}
    outputs: {a: a, b: b, c: c}
    """
    inner = "inputs: {y: float}\nnodes: {h: {use: fill.hold, in: $y}}\noutputs: {h: h}"
    for fed in ("@@nowhere", "@@w", "@@n.put", "{from: @@n, at: {k: 1}}"):
        (_,) = messages_of(outer(f"{{use: clean.yaml, in: {fed}}}"), clean=clean, inner=inner)


def test_all_errors_are_reported_at_once(messages_of: MessagesOf) -> None:
    messages = messages_of(
        """
        axes: {k: @@[1, 2]}
        nodes:
          n: {use: read.number}
          a: {use: broken.yaml, in: {x: n, y: @@n}, with: {factr: @@2}}
          b: {use: broken.yaml, in: {x: @@nowhere}}
          c: {use: @@clean.yaml, with: {factor: 2, other: @@@@$j}}
          d: {use: fill.hold, in: c.sid}
          e: {use: clean.yaml, in: n, with: {factor: @@x}}
          f: {use: fill.hold, in: a.whatever}
          g: {use: deep.yaml}
        report: [@@h]
        """,
        clean=CLEAN,
        broken="""
        inputs: {x: float, factor: 1.0}
        nodes:
          a: {use: fill.scale, in: $x, with: {power: @@fast, max_gap: @@$factor}}
          b: {use: @@fill.scael, in: @@nobody}
        outputs: {a: a, b: @@c}
        """,
        deep="nodes: {a: {use: broken.yaml, in: {x: n}}, n: {use: @@read.numbr}}\noutputs: {a: a}",
    )
    assert len(messages) == 15


def test_a_setting_without_effect_is_an_error(messages_of: MessagesOf) -> None:
    clean = """
    inputs: {start: 1.0, metric: x}
    nodes:
      n: {use: read.number, with: {start: $start}}
      table: {use: compare.table, in: n, with: {metric: $metric}}
    outputs: {n: n}
    report: [table]
    """
    (message,) = messages_of(
        "nodes: {a: {use: clean.yaml, with: {start: 2.0, metric: @@y}}}", clean=clean
    )
    assert message.startswith("a: setting 'metric' of clean.yaml leads to none of its outputs")


def test_a_missing_field_is_an_error(messages_of: MessagesOf) -> None:
    clean = "inputs: {who: {rec: 1.0}}\nnodes: {n: {use: read.number, with: {start: $who.rec}}}"
    text = """
    axes: {actor: {ME: {rec: 2.0}, MB: {model: 3.0}}}
    nodes:
      a: {use: clean.yaml, with: {who: WHO}}
    """
    clean += "\noutputs: {n: n}"
    (_, message) = messages_of(
        text.replace("WHO", "@@{reck: 1}").replace("actor: ", "actor: @@"), clean=clean
    )
    assert message == (
        "a: setting 'who' of clean.yaml needs 'rec' | did you mean 'reck'? fields: reck"
    )
    (message, more) = messages_of(text.replace("WHO", "@@@@$actor"), clean=clean)
    assert "$actor.rec: label 'MB' has no field 'rec'" in message
    assert "should be a valid number, got None" in more
    (message,) = messages_of(text.replace("WHO", "@@$actor.rec"), clean=clean)
    assert "needs 'rec'" in message


def test_two_nodes_of_the_same_name_are_an_error(messages_of: MessagesOf) -> None:
    inner = "nodes: {x: {use: read.number}}\noutputs: {y: x}"
    (message,) = messages_of(
        "nodes: {c: {alternatives: {a: middle.yaml, a.b: @@inner.yaml}}}",
        middle="nodes: {b: {use: inner.yaml}}\noutputs: {y: b}",
        inner=inner,
    )
    assert "two nodes would be called 'c.a.b.x'" in message


def test_pass_needs_a_sibling_with_an_input(messages_of: MessagesOf) -> None:
    (message,) = messages_of(
        "nodes: {c: {alternatives: {a: inner.yaml, @@pass: {}}}}",
        inner="nodes: {x: {use: read.number}}\noutputs: {y: x}",
    )
    assert "'pass' hands on an input, and inner.yaml has none" in message

"""Graphs used as nodes: what runs, under which names, with which axes."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from nodegraph import NodegraphError, Truth, api, node
from nodegraph.draw import dot, mermaid, svg
from nodegraph.draw.from_graph import picture_of
from nodegraph.errors import GraphError
from nodegraph.execute.executor import HowToRun
from nodegraph.execute.results import Run
from nodegraph.graph import Choices, Graph, PassThrough, build
from nodegraph.graphfile import read_graph_file
from nodegraph.plugin.registry import Registry

Files = Callable[..., None]

CLEAN = """
    title: Clean a number
    inputs: {recording: float, factor: 2.0}
    axes: {trial: [1, 2]}
    nodes:
      despike:
        in: $recording
        alternatives: {hold: fill.hold, scale: {use: fill.scale, with: {power: $factor}}}
      smooth: {use: gaps.cut, in: despike, with: {length: $trial}}
    outputs: {recording: smooth}
    """
OUTER = """
    axes: {k: [10, 20]}
    nodes:
      n: {use: read.number, with: {start: $k}}
      clean: {use: ./clean.yaml, in: n, with: {factor: 3.0}}
      after: {use: fill.hold, in: clean.recording}
    """


def values(run: Run, name: str) -> dict[tuple[object, ...], object]:
    return {tuple(at.values()): value for at, value in run[name]}


def test_a_graph_is_used_as_a_node(files: Files, run_of: Callable[..., Run]) -> None:
    files(clean=CLEAN)
    run = run_of(OUTER)
    graph = run.plan.graph
    assert list(graph.nodes) == ["n", "clean.despike", "clean.smooth", "clean", "after"]
    assert graph.nodes["clean"].axes == ("k", "clean.trial", "clean.despike")
    expected = {
        (k, trial, despike): (k + 1 if despike == "hold" else k * 3) - trial
        for k in (10, 20)
        for trial in (1, 2)
        for despike in ("hold", "scale")
    }
    assert values(run, "clean") == values(run, "clean.recording") == expected
    assert values(run, "clean.smooth") == values(run, "clean.smooth.gappy") == expected
    assert values(run, "after") == {at: value + 1 for at, value in expected.items()}
    assert run["clean.despike"].at(k=10, **{"clean.despike": "scale"}) == 30


def test_what_feeds_a_graph_is_fixed_at_the_first_label(
    files: Files, run_of: Callable[..., Run]
) -> None:
    files(clean=CLEAN)
    outer = OUTER.replace("in: n,", "in: {recording: {from: n, at: {k: $first}}},")
    assert run_of(outer).plan.graph.nodes["clean"].axes == ("clean.trial", "clean.despike")


def test_the_node_itself_is_a_pass_through(files: Files, graph_of: Callable[..., Graph]) -> None:
    files(clean=CLEAN)
    method = graph_of(OUTER).nodes["clean"].first
    assert isinstance(method.node, PassThrough)
    assert (method.node.name, method.node.doc, method.plugin) == (
        "./clean.yaml",
        "Clean a number",
        "nodegraph",
    )
    assert pickle.loads(pickle.dumps(method.node)) == method.node
    assert method.node.function(recording=5.0) == 5.0


def test_a_setting_that_is_not_set_has_its_default(
    files: Files, run_of: Callable[..., Run]
) -> None:
    files(clean=CLEAN)
    run = run_of(OUTER.replace(", with: {factor: 3.0}", ""), only={"clean.despike": ("scale",)})
    assert values(run, "clean.despike") == {(10, "scale"): 20.0, (20, "scale"): 40.0}


def test_only_and_axis_reach_inside(files: Files, graph_of: Callable[..., Graph]) -> None:
    files(clean=CLEAN)
    choices = {"only": {"clean.despike": ("hold",)}, "axes": {"clean.trial": [7, 8, 9]}}
    graph = graph_of(OUTER, **choices)
    assert graph.axes["clean.trial"].labels == (7, 8, 9)
    assert list(graph.nodes["clean.despike"].methods) == ["hold"]
    with pytest.raises(GraphError, match=r"--axis clean\.trail: the graph has no axis"):
        graph_of(OUTER, axes={"clean.trail": [1]})


def test_the_outer_graph_may_fix_gather_and_skip_inner_axes(
    files: Files, run_of: Callable[..., Run]
) -> None:
    files(clean=CLEAN)
    run = run_of(
        OUTER
        + """
      one: {use: fill.hold, in: {from: clean, at: {clean.despike: hold, clean.trial: 2, k: 10}}}
      means: {use: compare.table, in: clean, over: [clean.trial]}
    skip: [{clean.trial: 1, k: 20}]
    """
    )
    assert run["one"].value == 10
    assert run.plan.graph.nodes["means"].axes == ("k", "clean.despike")
    gathered = run["means"].at(k=20, **{"clean.despike": "hold"}).scores
    assert gathered.axes == ("clean.trial",)
    assert [(dict(at), value) for at, value in gathered] == [({"clean.trial": 2}, 19.0)]


def test_a_label_that_was_removed_leaves_inner_nodes_out(
    files: Files, run_of: Callable[..., Run]
) -> None:
    files(
        clean="""
        inputs: {recording: float}
        axes: {j: [1, 2]}
        nodes:
          cut: {use: gaps.cut, in: $recording, with: {length: $j}}
          one: {use: fill.hold, in: {from: cut, at: {j: 2}}}
        outputs: {both: cut, one: one}
        """
    )
    text = "nodes: {n: {use: read.number}, clean: {use: clean.yaml, in: n}}"
    assert (len(run_of(text)["clean"]), len(run_of(text)["clean.one"])) == (2, 1)
    run = run_of(text, only={"clean.j": (1,)})
    assert [item.node for item in run.plan.graph.left_out] == ["clean.one"]
    with pytest.raises(
        NodegraphError, match=r"'clean.one' is left out: the command has removed clean.j=2"
    ):
        run["clean.one"]


def test_graphs_use_graphs_and_each_starts_its_paths_at_itself(
    files: Files, run_of: Callable[..., Run], tmp_path: Path
) -> None:
    files(
        sub__middle="""
        inputs: {x: float, extra: given.txt}
        nodes:
          inner: {use: deep/inner.yaml, in: {y: $x}, with: {extra: $extra}}
          own: {use: read.file, with: {path: own.txt}}
          all: {use: compare.beside, in: {scores: {a: inner, b: own}, reference: $x}}
        outputs: {all: all}
        """,
        sub__deep__inner="""
        inputs: {y: float, extra: nothing.txt, usual: own.txt}
        axes: {file: {a: own.txt}}
        nodes:
          given: {use: read.file, with: {path: $extra}}
          default: {use: read.file, with: {path: $usual}}
          along: {use: read.file, with: {path: $file}}
          both: {use: sum.four, in: {a: given, b: default, c: along, d: $y}}
        outputs: {both: both}
        """,
    )
    (tmp_path / "sub" / "deep" / "nothing.txt").write_text("0")
    for folder, number in (("", 1), ("sub", 10), ("sub/deep", 100)):
        for name in ("own.txt", "given.txt"):
            (tmp_path / folder / name).write_text(str(number))

    @node("sum.four")
    def four(a: float, b: float, c: float, d: float) -> float:
        return a + b + c + d

    text = """
    inputs: {mine: own.txt}
    nodes:
      n: {use: read.number, with: {start: 0.5}}
      default: {use: sub/middle.yaml, in: n}
      given: {use: sub/middle.yaml, in: n, with: {extra: own.txt}}
      from_input: {use: sub/middle.yaml, in: n, with: {extra: $mine}}
    """
    run = run_of(text, more=[four])
    assert {name: run[f"{name}.inner"].value for name in ("default", "given", "from_input")} == {
        "default": 10 + 100 + 100 + 0.5,
        "given": 1 + 100 + 100 + 0.5,
        "from_input": 1 + 100 + 100 + 0.5,
    }
    assert run["given"].value.scores.values() == (201.5, 10.0)
    assert list(run.plan.graph.spec.included) == ["sub/deep/inner.yaml", "sub/middle.yaml"]


def test_the_texts_of_used_graphs_come_with_the_spec(files: Files, tmp_path: Path) -> None:
    files(
        sub__clean=CLEAN, outer="nodes: {n: {use: read.number}, c: {use: ./sub/../sub/clean.yaml}}"
    )
    spec = read_graph_file(tmp_path / "outer.yaml")
    assert dict(spec.included) == {"sub/clean.yaml": (tmp_path / "sub" / "clean.yaml").read_text()}


def test_an_outer_axis_may_be_a_setting_and_have_fields(
    files: Files, run_of: Callable[..., Run]
) -> None:
    files(
        inner="""
        inputs: {who: {first: 5, second: 6}, plain: [1, 2]}
        nodes:
          a: {use: read.number, with: {start: $who.first}}
          b: {use: read.number, with: {start: $who.second}}
          c: {use: set.many, with: {many: $plain, named: {x: $who.first}}}
        outputs: {a: a, b: b, c: c}
        """
    )

    @node("set.many")
    def many(*, many: list[int], named: dict[str, int]) -> str:
        return f"{many} {named}"

    run = run_of(
        """
        inputs: {six: 6}
        axes: {actor: {ME: {first: 1, second: 2}, MB: {first: 3, second: 4}}, k: [7, 8]}
        nodes:
          usual: {use: inner.yaml}
          each: {use: inner.yaml, with: {who: $actor, plain: [$k, $six]}}
          some: {use: inner.yaml, with: {who: {first: $k, second: 0}}}
        """,
        more=[many],
    )
    assert [run[f"usual.{port}"].value for port in "abc"] == [5, 6, "[1, 2] {'x': 5}"]
    assert values(run, "each.a") == {("ME",): 1, ("MB",): 3}
    assert values(run, "each.b") == {("ME",): 2, ("MB",): 4}
    assert run["each.c"].at(actor="MB", k=8) == "[8, 6] {'x': 3}"
    assert values(run, "some.a") == {(7,): 7, (8,): 8}


def test_inside_axes_have_their_inner_names(files: Files, run_of: Callable[..., Run]) -> None:
    files(
        study="""
        inputs: {recording: float}
        axes: {length: [1, 2]}
        nodes:
          cut: {use: gaps.cut, in: $recording, with: {length: $length}}
          fill: {in: cut, alternatives: fill.*}
          table: {use: compare.table, in: fill}
        outputs: {table: table, fill: fill}
        """
    )
    text = """
    axes: {k: [10]}
    nodes:
      n: {use: read.number, with: {start: $k}}
      a: {use: study.yaml, in: n}
      b: {use: study.yaml, in: n}
      outside: {use: compare.table, in: a.fill}
    """
    run = run_of(text)
    assert run["a.table"].value.scores.axes == ("k", "length", "fill")
    assert run["outside"].value.scores.axes == ("k", "a.length", "a.fill")
    steps = [step for step in run.plan.steps if step.method.node.name == "compare.table"]
    assert len(steps) == 2  # what both uses share runs once


def test_two_axes_of_the_same_inner_name_are_an_error(
    messages_of: Callable[..., list[str]],
) -> None:
    (message,) = messages_of(
        """
        axes: {fill: [10, 20]}
        nodes:
          n: {use: read.number, with: {start: $fill}}
          study: {use: study.yaml, in: n}
        """,
        study="""
        inputs: {recording: float}
        nodes:
          fill: {in: $recording, alternatives: fill.*}
          table: @@{use: compare.table, in: fill}
        outputs: {table: table}
        """,
    )
    assert message.startswith("study.table: ")
    assert "'fill'" in message


def test_references_keep_the_axes_that_they_fix(files: Files, run_of: Callable[..., Run]) -> None:
    files(
        clean="inputs: {x: float}\nnodes: {h: {use: fill.hold, in: $x}}\noutputs: {h: h, raw: $x}"
    )
    run = run_of(
        """
        axes: {k: [10, 20]}
        nodes:
          n: {use: read.number, with: {start: $k}}
          clean: {use: clean.yaml, in: {from: n, at: {k: 20}}}
        """
    )
    assert (run["clean"].value, run["clean.raw"].value, run["clean.h"].axes) == (21, 20, ())


STAGES = """
    inputs: {shown: float, other: float}
    nodes:
      beside: {use: plot.stages, in: {recordings: {before: $other, after: smooth}}}
      smooth: {use: fill.hold, in: $other}
      all: {use: plot.stages, in: $shown}
    outputs: {all: all, beside: beside}
    """


def test_several_may_be_passed_to_a_port_that_only_gathers(
    files: Files, run_of: Callable[..., Run], messages_of: Callable[..., list[str]]
) -> None:
    text = """
    nodes:
      a: {use: read.number, with: {start: 1}}
      b: {use: read.number, with: {start: 2}}
      stages: {use: stages.yaml, in: {shown: {x: a, y: b}, other: b}}
      one: {use: stages.yaml, in: {shown: a, other: b}}
    """
    files(stages=STAGES)
    run = run_of(text)
    gathered = run["stages"].value.scores
    assert [(dict(at), value) for at, value in gathered] == [
        ({"recordings": "x"}, 1.0),
        ({"recordings": "y"}, 2.0),
    ]
    beside = run["stages.beside"].value.scores
    assert [(dict(at), value) for at, value in beside] == [
        ({"recordings": "before"}, 2.0),
        ({"recordings": "after"}, 3.0),
    ]
    assert [dict(at) for at, _ in run["one"].value.scores] == [{}]
    (message,) = messages_of(
        text.replace("other: b}}\n      one", "other: @@{x: a}}}\n      one"), stages=STAGES
    )
    assert "port 'other' takes one value, not a mapping of several" in message


def test_alternatives_mix_graphs_and_nodes(files: Files, run_of: Callable[..., Run]) -> None:
    files(
        gentle="""
        inputs: {recording: float, power: 2.0}
        nodes:
          soft: {in: $recording, alternatives: {hold: fill.hold, pass: {}}}
          twice: {use: fill.scale, in: soft, with: {power: $power}}
        outputs: {recording: twice}
        """,
    )
    run = run_of(
        """
        nodes:
          n: {use: read.number, with: {start: 10}}
          m: {use: read.number, with: {start: 100}}
          clean:
            in: n
            with: {power: 5}
            alternatives:
              gentle: {use: ./gentle.yaml, with: {power: 3}}
              other: ./gentle.yaml
              hard: {use: fill.scale, in: m}
              pass: {}
          after: {use: fill.hold, in: clean}
        """
    )
    assert run["clean"].axes == ("clean.gentle.soft", "clean.other.soft", "clean")
    got = {
        (at["clean"], at["clean.gentle.soft"]): value
        for at, value in run["after"]
        if at["clean.other.soft"] == "hold"
    }
    assert {key: got[key] for key in got if key[1] == "hold"} == {
        ("gentle", "hold"): 34,
        ("other", "hold"): 56,
        ("hard", "hold"): 501,
        ("pass", "hold"): 11,
    }
    assert got["gentle", "pass"] == 31


def test_a_list_of_alternatives_labels_a_graph_with_its_name(
    files: Files, graph_of: Callable[..., Graph]
) -> None:
    files(sub__clean=CLEAN)
    graph = graph_of(
        """
        nodes:
          n: {use: read.number}
          c: {in: n, alternatives: [./sub/clean.yaml, fill.hold, pass]}
          d: {in: n, alternatives: {fill.*: {}, clean: ./sub/clean.yaml}}
          e: {in: n, alternatives: {hold: ./sub/clean.yaml, fill.*: {}}}
        """
    )
    assert list(graph.nodes["c"].methods) == ["clean", "hold", "pass"]
    assert list(graph.nodes["d"].methods) == ["hold", "scale", "clean"]
    assert {label: method.node.name for label, method in graph.nodes["e"].methods.items()} == {
        "hold": "./sub/clean.yaml",
        "scale": "fill.scale",
    }


def test_what_leads_to_no_output_is_checked_and_not_run(
    files: Files, run_of: Callable[..., Run], calls: list[str]
) -> None:
    files(
        own="""
        inputs: {start: 4.0}
        axes: {k: [1, 2], j: [1]}
        nodes:
          n: {use: read.number, with: {start: $start}}
          h: {use: fill.hold, in: n}
          cut: {use: gaps.cut, in: h, with: {length: $k, seed: $j}}
          table: {use: compare.table, in: cut}
        skip: [{k: 1, j: 1}]
        known: [n, cut]
        report: [table]
        outputs: {h: h}
        """
    )
    run = run_of("nodes: {own: {use: own.yaml}}\nreport: [own]")
    assert calls == ["read.number", "fill.hold"]
    assert list(run.plan.graph.nodes) == ["own.n", "own.h", "own"]
    assert list(run.plan.graph.axes) == []
    assert [str(reference) for reference in run.plan.graph.spec.known] == ["own.n"]
    assert run.plan.graph.reported == (("own", ""),)


def test_inner_skip_known_and_requires_join_the_outer_ones(
    files: Files, run_of: Callable[..., Run]
) -> None:
    more = """
    skip: [{trial: 1, despike: hold}]
    known: [despike]
    requires: [numpy]
    """
    files(clean=CLEAN.rstrip() + more)
    run = run_of(OUTER)
    assert set(values(run, "clean")) == {
        (10, 1, "scale"), (10, 2, "hold"), (10, 2, "scale"),
        (20, 1, "scale"), (20, 2, "hold"), (20, 2, "scale"),
    }  # fmt: skip
    spec = run.plan.graph.spec
    assert [str(reference) for reference in spec.known] == ["clean.despike"]
    assert [text for text, _ in spec.requires] == ["numpy"]


def test_a_loaded_graph_is_run_with_other_choices_from_what_was_read(
    files: Files, toys: Registry, tmp_path: Path
) -> None:
    files(clean=CLEAN, outer=OUTER)
    graph = build(read_graph_file(tmp_path / "outer.yaml"), toys, Choices())
    (tmp_path / "clean.yaml").write_text("broken: [")
    run = api.run(graph, only={"clean.despike": "hold", "k": 10}, cache=False)
    assert values(run, "clean") == {(10, 1, "hold"): 10, (10, 2, "hold"): 9}


@node("hide.some")
def hide(recording: float) -> Hidden:
    return Hidden(recording - 1, recording, 1)


class Hidden(NamedTuple):
    gappy: float
    truth: Truth[float]
    hidden: int


DAMAGE = """
    inputs: {start: 5.0}
    nodes:
      capture: {use: read.number, with: {start: $start}}
      gaps: {use: gaps.cut, in: capture, with: {length: 2}}
    outputs: {gappy: gaps.gappy, truth: gaps.truth, hidden: gaps.hidden, raw: capture}
    """
SCORED = """
    nodes:
      damage: {use: damage.yaml}
      fill: {in: damage.gappy, alternatives: [fill.hold, pass]}
      error: {use: score.gaps, in: {estimate: ESTIMATE, truth: damage.truth, hidden: damage.hidden}}
    """


def test_truth_stays_truth_and_leaks_are_found_through_graphs(
    files: Files, run_of: Callable[..., Run], messages_of: Callable[..., list[str]]
) -> None:
    files(damage=DAMAGE)
    run = run_of(SCORED.replace("ESTIMATE", "fill"))
    handing = {
        name: node.first.node.outputs[0].truth
        for name, node in run.plan.graph.nodes.items()
        if isinstance(node.first.node, PassThrough) and name.startswith("damage")
    }
    assert handing == {
        "damage": False, "damage.truth": True, "damage.hidden": False, "damage.raw": False,
    }  # fmt: skip
    assert values(run, "error") == {("hold",): 0.5, ("pass",): 1.0}
    (message,) = messages_of(SCORED.replace("ESTIMATE", "@@damage.raw"), damage=DAMAGE)
    assert "error is scored against what damage.gaps hides, and can see it" in message
    assert "damage.capture.output -> error.estimate" in message
    (message,) = messages_of(SCORED.replace("ESTIMATE", "@@damage.truth"), damage=DAMAGE)
    assert "'truth' gives the truth to 'estimate', which must not see it" in message


@pytest.mark.parametrize("known", ["damage.raw", "damage"])
def test_outputs_of_a_graph_may_be_known(
    files: Files, graph_of: Callable[..., Graph], known: str
) -> None:
    files(damage=DAMAGE)
    text = SCORED.replace("ESTIMATE", "damage.raw") + f"known: [{known}]\n"
    assert graph_of(text)


def test_a_leak_through_alternatives_is_found(messages_of: Callable[..., list[str]]) -> None:
    text = """
    nodes:
      n: {use: read.number}
      gaps: {use: gaps.cut, in: n}
      peek: {in: gaps, alternatives: {hold: fill.hold, own: {use: peek.yaml, in: {x: gaps, y: n}}}}
      error: {use: score.gaps, in: {estimate: @@peek, truth: gaps.truth, hidden: gaps.hidden}}
    """
    (message,) = messages_of(
        text,
        peek="inputs: {x: float, y: float}\nnodes: {h: {use: fill.hold, in: $x}, "
        "i: {use: fill.hold, in: $y}}\noutputs: {out: i, all: h}",
    )
    assert "n.output -> peek.own.i.output -> error.estimate" in message


def test_the_truth_may_be_passed_to_a_port_whose_readers_all_take_it(
    files: Files, run_of: Callable[..., Run], messages_of: Callable[..., list[str]]
) -> None:
    judge = """
    inputs: {estimate: float, truth: float, hidden: int}
    nodes:
      error: {use: score.gaps, in: {estimate: $estimate, truth: $truth, hidden: $hidden}}
    outputs: {error: error, truth: $truth}
    """
    text = """
    nodes:
      n: {use: read.number}
      gaps: {use: gaps.cut, in: n, with: {length: 2}}
      fill: {use: fill.hold, in: gaps}
      judge: {use: judge.yaml, in: {estimate: fill, truth: gaps.truth, hidden: gaps.hidden}}
    """
    files(judge=judge)
    assert run_of(text)["judge"].value == 0.5
    (message,) = messages_of(text + "  x: {use: fill.hold, in: @@judge.truth}\n", judge=judge)
    assert "'truth' gives the truth" in message
    (message,) = messages_of(text.replace("estimate: fill", "estimate: @@gaps.truth"), judge=judge)
    assert "judge: gaps (gaps.cut): 'truth' gives the truth to 'estimate'" in message


def test_a_graph_of_graphs_is_drawn(files: Files, graph_of: Callable[..., Graph]) -> None:
    files(clean=CLEAN)
    picture = picture_of(graph_of(OUTER))
    assert {box.name for box in picture.boxes} >= {"clean", "clean.despike", "clean.smooth"}
    for draw in (svg, mermaid, dot):
        assert "clean" in draw(picture)


@pytest.mark.parametrize(("executor", "jobs"), [("threads", 2), ("processes", 1)])
def test_every_executor_runs_pass_through_nodes(
    files: Files, run_of: Callable[..., Run], executor: str, jobs: int
) -> None:
    files(damage=DAMAGE)
    run = run_of(SCORED.replace("ESTIMATE", "fill"), how=HowToRun(executor, jobs))
    assert values(run, "error") == {("hold",): 0.5, ("pass",): 1.0}


def test_forty_graphs_that_double_each_other_are_an_error(
    messages_of: Callable[..., list[str]],
) -> None:
    texts = {
        f"g{level}": f"""
        inputs: {{x: float}}
        nodes:
          a: {{use: g{level + 1}.yaml, in: $x}}
          b: {{use: g{level + 1}.yaml, in: a}}
        outputs: {{x: b}}
        """
        for level in range(40)
    }
    texts["g24"] = texts["g24"].replace("b: {use: g25", "b: {use: @@g25")
    texts["g40"] = "inputs: {x: float}\nnodes: {h: {use: fill.hold, in: $x}}\noutputs: {x: h}"
    (message,) = messages_of("nodes: {n: {use: read.number}, g: {use: g0.yaml, in: n}}", **texts)
    assert message == (
        "g25.yaml: more than 100,000 nodes, those of the graphs that it uses included | "
    )


def test_graphs_may_be_nested_fifty_deep(
    files: Files, run_of: Callable[..., Run], messages_of: Callable[..., list[str]]
) -> None:
    def chain(count: int) -> dict[str, str]:
        texts = {
            f"g{level}": f"inputs: {{x: float}}\nnodes: {{a: {{use: g{level + 1}.yaml, in: $x}}}}"
            "\noutputs: {x: a}"
            for level in range(count)
        }
        leaf = "inputs: {x: float}\nnodes: {a: {use: fill.hold, in: $x}}\noutputs: {x: a}"
        return {**texts, f"g{count}": leaf}

    text = "nodes: {n: {use: read.number}, g: {use: g0.yaml, in: n}}"
    files(**chain(49))
    assert run_of(text)["g"].value == 2
    texts = chain(50)
    texts["g49"] = texts["g49"].replace("use: g50", "use: @@g50")
    (message,) = messages_of(text, **texts)
    assert "more than 50 deep" in message


def test_settings_that_double_are_an_error(messages_of: Callable[..., list[str]]) -> None:
    texts = {
        f"g{level}": f"""
        inputs: {{s: [1]}}
        nodes: {{a: {{use: g{level + 1}.yaml, with: {{s: [$s, $s]}}}}}}
        outputs: {{x: a}}
        """
        for level in range(40)
    }
    texts["g40"] = "inputs: {s: [1]}\nnodes: {a: {use: set.any, with: {s: $s}}}\noutputs: {x: a}"
    texts["g26"] = texts["g26"].replace("use: g27", "use: @@g27")

    @node("set.any")
    def anything(*, s: list[object]) -> float:
        return 0.0

    (message,) = messages_of("nodes: {g: {use: g0.yaml}}", more=(anything,), **texts)
    assert "grow without bound" in message

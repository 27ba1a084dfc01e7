"""The schema marks words that can stand nowhere, and refuses no graph that the loader takes."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated, Any, Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st
from jsonschema import Draft202012Validator
from pydantic import Field

from nodegraph import Across, Deprecated, InputFile, Unit, node
from nodegraph.graphfile.schema import graph_schema
from nodegraph.graphfile.yaml_text import read_yaml
from nodegraph.plugin.registry import Registry
from tests.nodegraph.graphfile.conftest import Judge, parts_of, settings_of

ROOT = Path(__file__).parents[3]
Count = Annotated[int, Field(ge=1), Unit("frames")]


@node("read.number")
def read_number(*, start: float = 1.0) -> float:
    """Give a number."""
    raise AssertionError


@node("read.file")
def read_file(*, path: InputFile) -> float:
    raise AssertionError


@node("fill.hold", cite="hold2001")
def hold(recording: float, *, max_gap: Count | None = None) -> float:
    """Hold on.

    Parameters
    ----------
    recording
        What has gaps.
    """
    raise AssertionError


@node("fill.scale")
def scale(
    recording: float, *, max_gap: Count | None = None, power: Annotated[float, Field(gt=0)] = 2.0
) -> float:
    raise AssertionError


@node("strict.order")
def order(
    recording: float, *, max_gap: Count | None = None, order: Annotated[int, Field(ge=0)]
) -> float:
    raise AssertionError


@node("smooth.hold")
def smooth(recording: float, *, ends: Literal["keep", "cut"] = "keep") -> float:
    raise AssertionError


@node("join.two")
def join(first: float, second: float, third: float | None = None) -> float:
    raise AssertionError


@node("join.all")
def join_all(parts: Across[float], beside: float | None = None, *, names: list[str] = []) -> float:  # noqa: B006
    raise AssertionError


@node("any.thing")
def anything(*, a: Any = None, b: Any = None, c: Any = None) -> float:
    raise AssertionError


@node("fill.old", deprecated="use fill.hold")
def old(recording: float, *, longest: Annotated[int | None, Deprecated("no more")] = None) -> float:
    raise AssertionError


NODES = (
    read_number, read_file, hold, scale, order, smooth, join, join_all, anything, old,
)  # fmt: skip


def graph(**nodes: object) -> dict[str, Any]:
    """Return a good graph with these nodes among others."""
    return {
        "nodegraph": 1,
        "title": "Toys",
        "notes": None,
        "inputs": {"start": 3, "gap": 5},
        "axes": {"i": [1, 2, 3], "w": {"a": {"x": 1}, "b": {"x": 2}}, "k": {"count": 2}},
        "nodes": {
            "n0": {"use": "read.number", "with": {"start": "$start"}},
            "n1": {
                "use": "any.thing",
                "with": {"a": "$i", "b": ["$w.x", {"y": "$gap"}], "c": "$k"},
            },
            "n2": {"use": "join.two", "in": {"first": "n0", "second": "n1"}},
            **nodes,
        },
        "skip": [{"i": 1, "w": ["a", "b"]}],
        "known": ["n0", "n1.output"],
        "outputs": {"out": "n2"},
        "report": [
            "n2",
            {"from": "n1", "at": {"i": 1}},
            {
                "show": "n1",
                "at": {"i": "$first"},
                "title": "A title",
                "caption": "In words.",
                "notes": "*Why?*",
            },
        ],
    }


GOOD: dict[str, dict[str, Any]] = {
    "reference": {"use": "fill.hold", "in": "n0"},
    "port": {"use": "toys:fill.hold", "in": "n0.output", "with": {"max_gap": 3}},
    "fixed": {"use": "fill.hold", "in": {"from": "n1", "at": {"i": 1, "w": "b"}}, "with": None},
    "by name": {"use": "fill.hold", "in": {"recording": {"from": "n0"}}, "with": {}},
    "required": {"use": "strict.order", "in": "n0", "with": {"order": "$i"}},
    "field": {"use": "strict.order", "in": "n0", "with": {"order": "$w.x", "max_gap": None}},
    "file": {"use": "read.file", "with": {"path": "a.txt"}},
    "no ports": {"use": "read.number", "in": {}, "over": []},
    "optional port": {"use": "join.two", "in": {"first": "n0", "second": "n0", "third": "n1"}},
    "gathers": {"use": "join.all", "in": "n1", "over": ["i", "w"]},
    "stages": {"use": "join.all", "in": {"parts": {"a": "n0", "b": {"from": "n1"}}}},
    "list": {"in": "n0", "alternatives": ["fill.hold", "toys:fill.scale", "pass"]},
    "list of family": {"in": "n0", "alternatives": ["fill.*", "pass"], "with": {"max_gap": 1}},
    "required of family": {"in": "n0", "alternatives": "strict.*", "with": {"order": 1}},
    "family": {"in": "n0", "alternatives": "smooth.*", "with": {"ends": "cut"}},
    "labels": {
        "in": "n0",
        "alternatives": {
            "a": {"use": "fill.hold"},
            "b": "fill.scale",
            "c": {"use": "strict.order", "in": {"recording": "n1"}, "with": {"order": 3}},
            "pass": None,
        },
        "with": {"max_gap": "$gap"},
    },
    "family and label": {
        "in": "n0",
        "alternatives": {"smooth.*": None, "scale": {"use": "fill.scale", "with": {"power": 3}}},
    },
    "family with settings": {
        "in": "n0",
        "alternatives": {"fill.*": {"with": {"max_gap": 3}, "in": "n1"}, "other": "fill.hold"},
    },
    "shared port": {
        "alternatives": {"a": {"use": "fill.hold", "in": "n0"}, "b": {"use": "fill.scale"}},
        "in": {"recording": "n1"},
    },
}  # fmt: skip


@pytest.fixture(scope="session")
def judge(judge_of: Callable[..., Judge]) -> Judge:
    return judge_of(NODES)


def test_the_schema_is_valid(judge: Judge) -> None:
    Draft202012Validator.check_schema(judge.schema)


@pytest.mark.parametrize("name", GOOD)
def test_both_take_good_nodes(name: str, judge: Judge) -> None:
    data = graph(one=GOOD[name])
    assert not judge.mistakes(data)
    assert not judge.refusals(data)


BAD: dict[str, dict[str, object]] = {
    "unknown key": {"node": {}}, "number": {"nodegraph": 2}, "no nodes": {"nodes": {}},
    "title": {"title": ["a"]}, "name": {"inputs": {"a-b": 1}}, "axis empty": {"axes": {"a": []}},
    "label twice": {"axes": {"a": [1, 1]}}, "empty label": {"axes": {"a": [""]}},
    "count": {"axes": {"a": {"count": 0}}}, "range": {"axes": {"a": {"range": [1, 2]}}},
    "skip empty": {"skip": [{}]}, "known form": {"known": ["a.b.c"]},
    "report key": {"report": [{"from": "n0", "att": {}}]},
    "report source": {"report": [{"show": {"from": "n0"}}]},
}  # fmt: skip
BAD_NODES: dict[str, object] = {
    "both": {"use": "fill.hold", "alternatives": ["fill.hold"], "in": "n0"},
    "with list": {"use": "fill.hold", "in": "n0", "with": ["max_gap"]},
    "unknown key in a node": {"use": "read.number", "width": {}},
    "misspelt": {"use": "fill.hodl", "in": "n0"},
    "setting": {"use": "fill.hold", "in": "n0", "with": {"max_gp": 3}},
    "bound": {"use": "fill.hold", "in": "n0", "with": {"max_gap": 0}},
    "port": {"use": "fill.hold", "in": {"recordin": "n0"}},
    "reference": {"use": "fill.hold", "in": "n0.a.b"},
    "at list": {"use": "fill.hold", "in": {"from": "n1", "at": {"i": [1]}}},
    "over text": {"use": "join.all", "in": "n0", "over": "i"},
    "empty list": {"in": "n0", "alternatives": []},
    "empty labels": {"in": "n0", "alternatives": {}},
    "unknown family": {"in": "n0", "alternatives": "fil.*"},
    "unknown in list": {"in": "n0", "alternatives": ["fill.hold", "fill.hodl"]},
    "own setting": {"in": "n0", "alternatives": {"a": {"use": "fill.hold", "with": {"power": 1}}}},
}


@pytest.mark.parametrize("name", [*BAD, *BAD_NODES])
def test_both_refuse_what_cannot_be(name: str, judge: Judge) -> None:
    data = {**graph(), **BAD[name]} if name in BAD else graph(one=BAD_NODES[name])
    assert judge.mistakes(data)
    assert judge.refusals(data)


@pytest.mark.parametrize(
    "axis", [{"count": "a", "range": "b"}, {"range": [1, 3, 1]}, {1: "a"}, [True, 1.5, "a"]]
)
def test_both_take_good_axes(axis: Any, judge: Judge) -> None:
    data = json.loads(json.dumps({**graph(), "axes": {**graph()["axes"], "k": axis}}))
    assert not judge.mistakes(data)
    assert not judge.refusals(data)


@pytest.mark.parametrize(
    "use", ["./clean.yaml", "clean.yml", "../a b/c.yaml"], ids=["here", "yml", "elsewhere"]
)
def test_a_graph_file_takes_any_setting_and_port(use: str, judge: Judge) -> None:
    node = {"use": use, "in": {"x": "n0"}, "with": {"factor": 1.5}}
    forms: list[Any] = [{"a": node, "b": "fill.hold"}, ["fill.hold", use], {"a": use, "fill.*": {}}]
    assert not judge.refusals(graph(one=node))
    for alternatives in forms:
        node = {"in": "n0", "alternatives": alternatives, "with": {"max_gap": 3}}
        assert not judge.refusals(graph(one=node))
    assert not judge.refusals(graph(one={"alternatives": [use], "with": {"any": 1}}))


def _places(value: object, path: tuple[object, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yield where something stands in a graph, down to each word."""
    yield path
    if isinstance(value, (dict, list)):
        for key, part in value.items() if isinstance(value, dict) else enumerate(value):
            yield from _places(part, (*path, key))


ODD: list[object] = [
    None, 0, 1, 3, -1, 1.5, True, "", "x", "n0", "$i", "$start", "$none", "fill.hold", "fill.*",
    "pass", "smooth.hold", "strict.order", [], ["n0"], ["fill.hold"], {}, {"a": 1}, {"from": "n0"},
    {"use": "fill.scale"}, {"a": "fill.hold"}, {"max_gap": 0}, {"order": 1},
    {"max_gap": 3, "power": 1}, {"recording": "n0"}, {"a": {"use": "strict.order"}},
]  # fmt: skip
KEYS = (
    "use", "in", "with", "alternatives", "over", "from", "at", "recording", "max_gap", "power",
    "order", "ends", "pass", "fill.*", "smooth.*", "hold", "scale", "i", "count", "range", "x",
)  # fmt: skip


@st.composite
def damaged(draw: st.DrawFn) -> dict[str, Any]:
    """Return a good graph of one or two more nodes in which up to three things are changed."""
    names = draw(st.lists(st.sampled_from(sorted(GOOD)), min_size=1, max_size=2))
    data = graph(**{f"more{i}": copy.deepcopy(GOOD[name]) for i, name in enumerate(names)})
    for _ in range(draw(st.integers(1, 3))):
        more = [("nodes", name) for name in data["nodes"] if name.startswith("more")]
        start = draw(st.sampled_from([(), *more, *more, *more]))
        here: Any = data
        for key in start:
            here = here[key]
        path = (*start, *draw(st.sampled_from(list(_places(here)))))
        if path and path != ("nodes",):
            _change(draw, data, path)
    return data


def _change(draw: st.DrawFn, data: Any, path: tuple[Any, ...]) -> None:
    holder = data
    for key in path[:-1]:
        holder = holder[key]
    kind = draw(st.sampled_from(["replace", "remove", "rename", "add"]))
    if kind == "remove" and (isinstance(holder, list) or len(path) > 1):
        del holder[path[-1]]
    elif kind == "rename" and isinstance(holder, dict):
        holder[draw(st.sampled_from(KEYS))] = holder.pop(path[-1])
    elif kind == "add" and isinstance(holder[path[-1]], dict):
        holder[path[-1]][draw(st.sampled_from(KEYS))] = copy.deepcopy(draw(st.sampled_from(ODD)))
    else:
        holder[path[-1]] = copy.deepcopy(draw(st.sampled_from(ODD)))


@given(data=damaged())
def test_no_graph_that_the_loader_takes_is_refused(data: dict[str, Any], judge: Judge) -> None:
    refusals = judge.refusals(data)
    if refusals:
        assert judge.mistakes(data), refusals


def _graphs() -> Iterator[tuple[str, str]]:
    for path in [*ROOT.glob("graphs/*.yaml"), *ROOT.glob("tests/language/*.yaml")]:
        yield path.name, path.read_text(encoding="utf-8")
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    for number, text in enumerate(re.findall(r"```yaml\n(nodegraph: .*?)```", readme, re.DOTALL)):
        yield f"README.md {number}", text


@pytest.fixture(scope="module")
def installed() -> dict[str, object]:
    return graph_schema(Registry.installed())


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(("name", "text"), list(_graphs()), ids=lambda text: text[:20])
def test_every_graph_of_the_repository_is_good(
    name: str, text: str, installed: dict[str, object]
) -> None:
    data = json.loads(json.dumps(read_yaml(text, name).plain()))
    errors = [problem.message for problem in Draft202012Validator(installed).iter_errors(data)]
    assert errors == []


def test_the_schema_of_what_is_installed_is_valid_and_the_same_each_time(
    installed: dict[str, object],
) -> None:
    Draft202012Validator.check_schema(installed)
    again = graph_schema(Registry.installed())
    assert json.dumps(again) == json.dumps(installed)
    assert len(json.dumps(installed, separators=(",", ":"))) < 500_000


def test_a_node_has_its_summary_ports_and_citation(judge: Judge) -> None:
    names = judge.schema["$defs"]["node name"]["oneOf"]
    (constant,) = [each for each in names if each.get("const") == "fill.hold"]
    assert constant["title"] == "fill.hold"
    assert constant["description"].split("\n\n") == [
        "Hold on.", "In: recording: float.", "Out: output: float.", "Plugin: toys. Cite: hold2001.",
    ]  # fmt: skip
    assert settings_of(judge, "fill.hold").keys() == {"max_gap"}
    port = parts_of(judge, "fill.hold")["in"]["properties"]["recording"]
    assert (port["title"], port["description"]) == ("recording: float", "What has gaps.")


def test_a_name_that_two_plugins_claim_needs_its_plugin(judge_of: Callable[..., Judge]) -> None:
    judge = judge_of([read_number, hold])
    judge.registry._add_nodes("my-own", "", [hold])
    Draft202012Validator.check_schema(judge.schema)
    for use, good in (("fill.hold", False), ("toys:fill.hold", True), ("my-own:fill.hold", True)):
        data = {
            "nodegraph": 1,
            "nodes": {"a": {"use": "read.number"}, "b": {"use": use, "in": "a"}},
        }
        assert (not judge.refusals(data)) is good
        assert (not judge.mistakes(data)) is good


def test_what_is_deprecated_is_marked(judge: Judge) -> None:
    names = judge.schema["$defs"]["node name"]["oneOf"]
    assert [each["const"] for each in names if each.get("deprecated")] == ["fill.old"]
    longest = settings_of(judge, "fill.old")["longest"]
    assert longest["deprecated"] is True
    assert longest["description"].startswith("Deprecated: no more.")

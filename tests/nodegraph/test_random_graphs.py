"""Random small graphs give what a plain recursive evaluation of their text gives."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph import Across, GraphError, node
from nodegraph.execute.executor import HowToRun
from nodegraph.execute.run import execute
from nodegraph.graph import build
from nodegraph.graphfile import read_graph_text
from nodegraph.plan import plan
from nodegraph.plugin.registry import Registry

AXES: Mapping[str, tuple[Any, ...]] = {"i": (1, 2), "j": (3, 4, 5), "k": (6,)}


@node("word.join")
def join(first: str, second: str | None = None, *, mark: int = 0) -> str:
    return f"({first},{second},{mark})"


@node("word.flip")
def flip(first: str, second: str | None = None, *, mark: int = 0) -> str:
    return f"<{second},{first},{mark}>"


@node("word.make")
def make(*, mark: int = 0) -> str:
    return f"{mark}"


@node("word.all")
def gather(parts: Across[str], beside: str | None = None, *, mark: int = 0) -> str:
    shown = [f"{sorted(labels.items())}={value}" for labels, value in parts]
    return f"{beside}{mark}{sorted(shown)}"


@dataclass(frozen=True)
class RandomNode:
    """One node of a random graph, as it will be written and as it is evaluated."""

    name: str
    kind: str
    first: str = ""
    second: str = ""
    mark: str = ""
    fixed: Mapping[str, int] | None = None

    def text(self) -> str:
        mark = f", with: {{mark: {self.mark}}}" if self.mark else ""
        if self.kind == "make":
            return f"  {self.name}: {{use: word.make{mark}}}"
        at = (
            f", at: {{{', '.join(f'{a}: {v}' for a, v in self.fixed.items())}}}"
            if self.fixed
            else ""
        )
        source = f"{{from: {self.first}{at}}}"
        if self.kind == "gather":
            beside = f", beside: {self.second}" if self.second else ""
            return f"  {self.name}: {{use: word.all, in: {{parts: {source}{beside}}}{mark}}}"
        second = f", second: {self.second}" if self.second else ""
        use = "use: word.join"
        if self.kind == "choose":
            use = "alternatives: {join: word.join, flip: word.flip, pass: {}}"
        return f"  {self.name}: {{{use}, in: {{first: {source}{second}}}{mark}}}"


class Naive:
    """Evaluates by recursion alone: no plan, no sharing, no order."""

    def __init__(self, specs: list[RandomNode]) -> None:
        self._specs = {spec.name: spec for spec in specs}

    def labels(self, axis: str) -> tuple[object, ...]:
        return AXES.get(axis, ("join", "flip", "pass"))

    def axes(self, name: str) -> frozenset[str]:
        spec = self._specs[name]
        own = {spec.mark[1:]} if spec.mark.startswith("$") else set()
        own |= self.axes(spec.second) if spec.second else set()
        if spec.kind == "choose":
            own.add(name)
        if spec.kind in ("join", "choose"):
            own |= self.axes(spec.first) - set(spec.fixed or ())
        return frozenset(own)

    def value(self, name: str, at: Mapping[str, object]) -> str:
        spec = self._specs[name]
        mark = at[spec.mark[1:]] if spec.mark.startswith("$") else int(spec.mark or 0)
        if spec.kind == "make":
            return f"{mark}"
        second = self.value(spec.second, at) if spec.second else None
        here = {**at, **(spec.fixed or {})}
        if spec.kind == "gather":
            return f"{second}{mark}{self._gathered(spec, here)}"
        first = self.value(spec.first, here)
        if spec.kind == "choose" and at[name] == "pass":
            return first
        if spec.kind == "choose" and at[name] == "flip":
            return f"<{second},{first},{mark}>"
        return f"({first},{second},{mark})"

    def _gathered(self, spec: RandomNode, here: Mapping[str, object]) -> list[str]:
        free = sorted(self.axes(spec.first) - self.axes(spec.name) - set(spec.fixed or ()))
        texts = []
        for labels in itertools.product(*(self.labels(axis) for axis in free)):
            more = dict(zip(free, labels, strict=True))
            texts.append(f"{sorted(more.items())}={self.value(spec.first, {**here, **more})}")
        return sorted(texts)

    def all(self, name: str) -> dict[frozenset[tuple[str, object]], str]:
        axes = sorted(self.axes(name))
        rows = itertools.product(*(self.labels(axis) for axis in axes))
        cells = (dict(zip(axes, row, strict=True)) for row in rows)
        return {frozenset(at.items()): self.value(name, at) for at in cells}


@st.composite
def graphs(draw: st.DrawFn) -> list[RandomNode]:
    marks = st.sampled_from(["", "7", "$i", "$j", "$k"])
    specs = [RandomNode("n0", "make", mark=draw(marks))]
    choices = 0
    for number in range(1, draw(st.integers(2, 6))):
        names = st.sampled_from([spec.name for spec in specs])
        kind = draw(st.sampled_from(["make", "join", "join", "choose", "gather", "gather"]))
        if kind == "choose" and choices == 2:
            kind = "join"
        choices += kind == "choose"
        first = draw(names)
        second = draw(st.sampled_from(["", draw(names)]))
        fixable = sorted(Naive(specs).axes(first) & set(AXES))
        fixed = {}
        axis = draw(st.sampled_from(["", *fixable]))
        if axis:
            fixed = {axis: draw(st.sampled_from(AXES[axis]))}
        if kind == "make":
            specs.append(RandomNode(f"n{number}", kind, mark=draw(marks)))
        else:
            specs.append(RandomNode(f"n{number}", kind, first, second, draw(marks), fixed))
    return specs


def graph_text(specs: list[RandomNode]) -> str:
    used = {spec.mark[1:] for spec in specs if spec.mark.startswith("$")}
    axes = "".join(f"  {name}: {list(AXES[name])}\n" for name in sorted(used))
    nodes = "\n".join(spec.text() for spec in specs)
    return f"nodegraph: 1\n{'axes:' if axes else ''}\n{axes}nodes:\n{nodes}\n"


@given(graphs())
def test_a_run_equals_a_naive_evaluation(specs: list[RandomNode]) -> None:
    registry = Registry.of([join, flip, make, gather])
    graph = build(read_graph_text(graph_text(specs), "random.yaml", Path()), registry)
    naive = Naive(specs)
    for how in (HowToRun("serial"), HowToRun("threads", 3)):
        run = execute(plan(graph), how=how, keep=list(graph.nodes))
        for spec in specs:
            values = {frozenset(at.items()): value for at, value in run[spec.name]}
            assert values == naive.all(spec.name)


GOOD = """\
nodegraph: 1
inputs: {start: 3}
axes: {i: [1, 2], j: {a: {mark: 3}, b: {mark: 4}}}
nodes:
  n0: {use: word.make, with: {mark: $i}}
  n1: {in: n0, with: {mark: $j.mark}, alternatives: {join: {use: word.join}, pass: {}}}
  n2:
    use: word.all
    in: {parts: n1, beside: {from: n0, at: {i: 1}}}
    over: [i]
    with: {mark: $start}
skip: [{i: 1, j: a}]
known: [n0]
report: [n2]
"""


@given(st.data())
def test_a_damaged_graph_raises_only_graph_errors(data: st.DataObject) -> None:
    lines = GOOD.splitlines(keepends=True)
    for _ in range(data.draw(st.integers(1, 3))):
        number = data.draw(st.integers(0, len(lines) - 1))
        line, kind = lines[number], data.draw(st.sampled_from(["drop", "swap", "byte", "cut"]))
        at = data.draw(st.integers(0, max(0, len(line) - 1)))
        if kind == "drop":
            lines[number] = ""
        elif kind == "swap":
            lines[number], lines[0] = lines[0], line
        elif kind == "cut":
            lines[number] = line[:at] + line[at + data.draw(st.integers(1, 9)) :]
        else:
            byte = data.draw(st.sampled_from("{}[]:,$.*&!|>'\"#%@`-~09aijn \n\x00é"))
            lines[number] = line[:at] + byte + line[at + 1 :]
    registry = Registry.of([join, flip, make, gather])
    try:
        graph = build(read_graph_text("".join(lines), "damaged.yaml", Path()), registry)
    except GraphError as error:
        places = [problem.place for problem in error.problems]
    else:
        places = []
        assert execute(plan(graph), how=HowToRun("serial")).ok
    assert all(place.file == "damaged.yaml" and place.line for place in places)


def test_the_graph_is_valid_before_it_is_damaged(tmp_path: Path) -> None:
    registry = Registry.of([join, flip, make, gather])
    graph = build(read_graph_text(GOOD, "good.yaml", tmp_path), registry)
    assert execute(plan(graph), how=HowToRun("serial")).ok
    with pytest.raises(GraphError):
        build(read_graph_text(GOOD.replace("n0", "n9", 1), "bad.yaml", tmp_path), registry)

"""Random small graphs give what a plain recursive evaluation of their text gives."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nodegraph import Across, GraphError, node
from nodegraph.execute import HowToRun, execute
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
class Drawn:
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

    def __init__(self, drawn: list[Drawn]) -> None:
        self._drawn = {one.name: one for one in drawn}

    def labels(self, axis: str) -> tuple[Any, ...]:
        return AXES.get(axis, ("join", "flip", "pass"))

    def axes(self, name: str) -> frozenset[str]:
        one = self._drawn[name]
        own = {one.mark[1:]} if one.mark.startswith("$") else set()
        own |= self.axes(one.second) if one.second else set()
        if one.kind == "choose":
            own.add(name)
        if one.kind in ("join", "choose"):
            own |= self.axes(one.first) - set(one.fixed or ())
        return frozenset(own)

    def value(self, name: str, at: Mapping[str, Any]) -> str:
        one = self._drawn[name]
        mark = at[one.mark[1:]] if one.mark.startswith("$") else int(one.mark or 0)
        if one.kind == "make":
            return f"{mark}"
        second = self.value(one.second, at) if one.second else None
        here = {**at, **(one.fixed or {})}
        if one.kind == "gather":
            return f"{second}{mark}{self._gathered(one, here)}"
        first = self.value(one.first, here)
        if one.kind == "choose" and at[name] == "pass":
            return first
        if one.kind == "choose" and at[name] == "flip":
            return f"<{second},{first},{mark}>"
        return f"({first},{second},{mark})"

    def _gathered(self, one: Drawn, here: Mapping[str, Any]) -> list[str]:
        free = sorted(self.axes(one.first) - self.axes(one.name) - set(one.fixed or ()))
        found = []
        for labels in itertools.product(*(self.labels(axis) for axis in free)):
            more = dict(zip(free, labels, strict=True))
            found.append(f"{sorted(more.items())}={self.value(one.first, {**here, **more})}")
        return sorted(found)

    def all(self, name: str) -> dict[frozenset[tuple[str, Any]], str]:
        axes = sorted(self.axes(name))
        rows = itertools.product(*(self.labels(axis) for axis in axes))
        cells = (dict(zip(axes, row, strict=True)) for row in rows)
        return {frozenset(at.items()): self.value(name, at) for at in cells}


@st.composite
def graphs(draw: st.DrawFn) -> list[Drawn]:
    marks = st.sampled_from(["", "7", "$i", "$j", "$k"])
    drawn = [Drawn("n0", "make", mark=draw(marks))]
    chosen = 0
    for number in range(1, draw(st.integers(2, 6))):
        names = st.sampled_from([one.name for one in drawn])
        kind = draw(st.sampled_from(["make", "join", "join", "choose", "gather", "gather"]))
        if kind == "choose" and chosen == 2:
            kind = "join"
        chosen += kind == "choose"
        first = draw(names)
        second = draw(st.sampled_from(["", draw(names)]))
        fixable = sorted(Naive(drawn).axes(first) & set(AXES))
        fixed = {}
        axis = draw(st.sampled_from(["", *fixable]))
        if axis:
            fixed = {axis: draw(st.sampled_from(AXES[axis]))}
        if kind == "make":
            drawn.append(Drawn(f"n{number}", kind, mark=draw(marks)))
        else:
            drawn.append(Drawn(f"n{number}", kind, first, second, draw(marks), fixed))
    return drawn


def written(drawn: list[Drawn]) -> str:
    used = {one.mark[1:] for one in drawn if one.mark.startswith("$")}
    axes = "".join(f"  {name}: {list(AXES[name])}\n" for name in sorted(used))
    nodes = "\n".join(one.text() for one in drawn)
    return f"nodegraph: 1\n{'axes:' if axes else ''}\n{axes}nodes:\n{nodes}\n"


@settings(max_examples=60, deadline=None)
@given(graphs())
def test_a_run_gives_what_the_text_says(drawn: list[Drawn]) -> None:
    registry = Registry.of([join, flip, make, gather])
    graph = build(read_graph_text(written(drawn), "random.yaml", Path()), registry)
    naive = Naive(drawn)
    for how in (HowToRun("serial"), HowToRun("threads", 3)):
        run = execute(plan(graph), how=how, keep=list(graph.nodes))
        for one in drawn:
            found = {frozenset(at.items()): value for at, value in run[one.name]}
            assert found == naive.all(one.name)


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


@settings(max_examples=200, deadline=None)
@given(st.data())
def test_a_damaged_graph_only_ever_gives_a_graph_error(data: st.DataObject) -> None:
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
        places = [one.place for one in error.problems]
    else:
        places = []
        assert execute(plan(graph), how=HowToRun("serial")).ok
    assert all(place.file == "damaged.yaml" and place.line for place in places)


def test_the_damaged_graph_is_good_before(tmp_path: Path) -> None:
    registry = Registry.of([join, flip, make, gather])
    graph = build(read_graph_text(GOOD, "good.yaml", tmp_path), registry)
    assert execute(plan(graph), how=HowToRun("serial")).ok
    with pytest.raises(GraphError):
        build(read_graph_text(GOOD.replace("n0", "n9", 1), "bad.yaml", tmp_path), registry)

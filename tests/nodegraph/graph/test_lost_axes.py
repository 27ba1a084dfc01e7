"""Axes that are gone with the methods that the command leaves out are dropped where named."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import pytest

from nodegraph import Across, ColumnOf, Columns, GraphError, node
from nodegraph.graph import Graph


class Rows(dict[str, float]):
    """A table, as far as a graph is concerned."""


@node("rate.gaps")
def gaps(estimate: float) -> Annotated[Rows, Columns("gap")]:
    return Rows()


@node("rank.all")
def rank(
    scores: Across[Rows],
    *,
    within: Annotated[tuple[str, ...], ColumnOf("scores", or_axis=True)] = (),
) -> Rows:
    return Rows()


TEXT = """
axes: {ends: [1.0, 2.0], length: [5, 15]}
nodes:
  n: {use: read.number}
  cut: {use: gaps.cut, in: n, with: {seed: $length}}
  fill:
    in: cut
    alternatives: {hold: {use: fill.hold}, scale: {use: fill.scale, with: {power: $ends}}}
  rated: {use: rate.gaps, in: fill}
  all: {use: rank.all, in: rated, with: {within: [ends, length, gap]}}
  some: {use: rank.all, in: {from: rated, at: {length: 5, ends: $first}}, with: {within: [gap]}}
  one: {use: fill.hold, in: {from: fill, at: {ends: 2.0, fill: $first}}}
skip:
  - {length: 5, ends: 2.0}
  - {length: 15, fill: scale}
report: [all, {from: rated, at: {ends: 1.0, length: 5}}]
"""


def build(graph_of: Callable[..., Graph], text: str, *kept: str) -> Graph:
    return graph_of(text, more=(gaps, rank), only={"fill": kept})


def test_what_names_a_lost_axis_is_dropped_with_a_notice(
    graph_of: Callable[..., Graph],
) -> None:
    graph = build(graph_of, TEXT, "hold")
    every, some, first = (graph.nodes[name].first for name in ("all", "some", "one"))
    assert [values["within"] for values in every.settings.values.values()] == [("length", "gap")]
    assert [values["within"] for values in every.settings.shown.values()] == [["length", "gap"]]
    assert [dict(source.at) for source in some.references()] == [{"length": 5}]
    assert [dict(source.at) for source in first.references()] == [{"fill": "hold"}]
    assert [dict(entry.at) for entry in graph.spec.report] == [{}, {"length": 5}]
    assert [dict(item.labels) for item in graph.spec.skip] == [
        {"length": (15,), "fill": ("scale",)}
    ]
    (notice,) = graph.notices
    assert "'ends'" in notice.message
    assert str(notice.place).startswith("toy.yaml:11:")


def test_an_axis_that_a_kept_method_has_stays(graph_of: Callable[..., Graph]) -> None:
    graph = build(graph_of, TEXT, "hold", "scale")
    assert graph.nodes["fill"].axes == ("ends", "length", "fill")
    assert not graph.notices


def test_an_axis_that_no_method_has_is_an_error_all_the_same(
    graph_of: Callable[..., Graph],
) -> None:
    with pytest.raises(GraphError, match="no axis 'lenght'"):
        build(graph_of, TEXT.replace("at: {length: 5, ends", "at: {lenght: 5, ends"), "hold")

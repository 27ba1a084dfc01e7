"""Settings that name columns, axes or labels."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import pytest

from nodegraph import Across, ColumnOf, Columns, GraphError, LabelOf, node
from nodegraph.graph import Graph
from tests.nodegraph.conftest import ProblemsOf
from tests.nodegraph.graph.conftest import MessagesOf


class Rows(dict[str, float]):
    """A table, as far as a graph is concerned."""


@node("rate.gaps")
def gaps(estimate: float) -> Annotated[Rows, Columns("gap", "rmse", "mae")]:
    return Rows()


@node("rate.lags")
def lags(estimate: float) -> Annotated[Rows, Columns("gap", "lag")]:
    return Rows()


@node("rate.anything")
def anything(estimate: float) -> Rows:
    return Rows()


@node("rank.all")
def rank(
    scores: Across[Rows],
    floor: Across[Rows] | None = None,
    *,
    metric: Annotated[str | None, ColumnOf("scores")] = None,
    compare: Annotated[str | None, ColumnOf("scores", or_axis=True)] = None,
    within: Annotated[tuple[str, ...], ColumnOf("scores", or_axis=True)] = (),
    against: Annotated[str | None, ColumnOf("floor")] = None,
    first: Annotated[str | None, LabelOf("scores", axis="compare")] = None,
    units: Annotated[tuple[str, ...], ColumnOf("scores", or_axis=True, independent=True)] = (),
) -> Rows:
    return Rows()


MORE = (gaps, lags, anything, rank)
STUDY = """
axes: {trial: [0, 1]}
nodes:
  cut: {use: gaps.cut, in: n, with: {seed: $trial}}
  n: {use: read.number}
  fill: {in: cut, alternatives: {hold: {use: fill.hold}, scale: {use: fill.scale}}}
  rated: {use: RATE, in: fill}
  ranked: {use: rank.all, in: rated, with: {WITH}}
"""


def study(written: str, rate: str = "rate.gaps") -> str:
    return STUDY.replace("WITH", written).replace("RATE", rate)


@pytest.mark.parametrize(
    "written",
    [
        "metric: mae, compare: fill, within: [trial, gap]",
        "metric: null, compare: gap, within: []",
        "",
        "first: hold",
        "first: '1'",
        "first: '1', compare: trial",
        "first: anything, compare: gap",
    ],
)
def test_columns_labels_and_gathered_axes_may_be_named(
    graph_of: Callable[..., Graph], written: str
) -> None:
    assert graph_of(study(written), more=MORE).nodes["ranked"].gathered == ("trial", "fill")


@pytest.mark.parametrize(
    ("written", "message", "instead"),
    [
        (
            "metric: @@rsme",
            "ranked: metric: port 'scores' has no column 'rsme'",
            "did you mean 'rmse'? columns: gap, rmse, mae",
        ),
        (
            "compare: @@fil",
            "ranked: compare: port 'scores' has no axis or column 'fil'",
            "did you mean 'fill'? axes and columns: trial, fill, gap, rmse, mae",
        ),
        (
            "within: @@[trial, gaap]",
            "ranked: within: port 'scores' has no axis or column 'gaap'",
            "did you mean 'gap'? axes and columns: trial, fill, gap, rmse, mae",
        ),
        (
            "metric: @@fill",
            "ranked: metric: port 'scores' has no column 'fill'",
            "columns: gap, rmse, mae",
        ),
        (
            "compare: fill, first: @@scael",
            "ranked: first: port 'scores' has no label 'scael'",
            "did you mean 'scale'? labels: hold, scale",
        ),
        (
            "compare: trial, first: @@hold",
            "ranked: first: port 'scores' has no label 'hold'",
            "labels: 0, 1",
        ),
        (
            "first: @@halt",
            "ranked: first: port 'scores' has no label 'halt'",
            "labels: 0, 1, hold, scale",
        ),
    ],
)
def test_an_unknown_name_is_reported_with_the_nearest(
    problems_of: ProblemsOf, written: str, message: str, instead: str
) -> None:
    (problem,) = problems_of(study(written), more=MORE)
    assert (problem.message, problem.instead) == (message, instead)


def test_all_unknown_names_are_reported_at_once(problems_of: ProblemsOf) -> None:
    written = "metric: @@no, compare: @@never, within: @@[neither]"
    assert len(problems_of(study(written), more=MORE)) == 3


def test_an_axis_that_is_not_gathered_cannot_be_named(problems_of: ProblemsOf) -> None:
    text = study("compare: @@trial").replace("rank.all,", "rank.all, over: [fill],")
    (problem,) = problems_of(text, more=MORE)
    assert problem.instead == "axes and columns: fill, gap, rmse, mae"


def test_the_axis_of_labelled_sources_is_the_port(graph_of: Callable[..., Graph]) -> None:
    text = study("compare: scores").replace("in: rated", "in: {scores: {a: rated, b: rated}}")
    assert graph_of(text, more=MORE)


def test_a_label_that_the_command_removes_may_be_named(
    graph_of: Callable[..., Graph],
) -> None:
    assert graph_of(study("compare: fill, first: hold"), more=MORE, only={"fill": ("scale",)})


def test_alternatives_have_the_columns_of_all(
    graph_of: Callable[..., Graph], problems_of: ProblemsOf
) -> None:
    methods = "in: fill, alternatives: {a: {use: rate.gaps}, b: {use: rate.lags}}"
    text = study("metric: NAME").replace("use: rate.gaps, in: fill", methods)
    assert graph_of(text.replace("NAME", "lag"), more=MORE)
    assert problems_of(text.replace("NAME", "@@log"), more=MORE)


def test_any_column_may_be_named_where_a_node_declares_none(
    graph_of: Callable[..., Graph],
) -> None:
    assert graph_of(study("metric: what, compare: ever", "rate.anything"), more=MORE)
    several = "in: fill, alternatives: {a: {use: rate.gaps}, b: {use: rate.anything}}"
    text = study("metric: what").replace("use: rate.gaps, in: fill", several)
    assert graph_of(text, more=MORE)


def test_a_pass_through_node_has_the_columns_of_its_source(
    graph_of: Callable[..., Graph],
) -> None:
    @node("keep.one")
    def keep(table: Rows) -> Annotated[Rows, Columns("kept")]:
        return Rows()

    text = """
    nodes:
      n: {use: read.number}
      rated: {use: rate.gaps, in: n}
      some: {in: rated, alternatives: {keep: {use: keep.one}, all: {use: pass}}}
      ranked: {use: rank.all, in: some, with: {metric: rmse}}
    """
    assert graph_of(text, more=(*MORE, keep))


def test_an_open_port_is_not_checked(graph_of: Callable[..., Graph]) -> None:
    assert graph_of(study("against: anything"), more=MORE)


def test_values_along_an_axis_and_of_an_option_are_checked(
    graph_of: Callable[..., Graph], problems_of: ProblemsOf
) -> None:
    text = study("metric: @@$of").replace("{trial: [0, 1]}", "{trial: [0, 1], of: [rmse, mea]}")
    (problem,) = problems_of(text, more=MORE)
    assert "no column 'mea'" in problem.message
    text = f"inputs: {{of: rmse}}\n{study('metric: $of')}"
    assert graph_of(text, more=MORE)
    with pytest.raises(GraphError) as caught:
        graph_of(text, more=MORE, inputs={"of": "mea"})
    assert [str(problem.place) for problem in caught.value.problems] == ["--set of"]


INNER = """
inputs: {made: float}
nodes:
  fill: {in: $made, alternatives: {hold: {use: fill.hold}, scale: {use: fill.scale}}}
  rated: {use: rate.gaps, in: fill}
  ranked: {use: rank.all, in: rated, with: {metric: rmse, compare: WHAT}}
outputs: {ranked: ranked, rated: rated}
"""
OUTER = """
axes: {trial: [0.5, 1.5]}
nodes:
  n: {use: read.number, with: {start: $trial}}
  inner: {use: inner.yaml, in: n}
  last: {use: rank.all, in: inner.rated, with: {metric: LAST}}
"""


@pytest.mark.parametrize("name", ["fill", "trial", "gap"])
def test_a_graph_that_is_used_names_axes_as_they_are_called_in_it(
    files: Callable[..., None], graph_of: Callable[..., Graph], name: str
) -> None:
    files(inner=INNER.replace("WHAT", name))
    assert graph_of(OUTER.replace("LAST", "mae"), more=MORE)


def test_unknown_names_in_a_used_graph_and_of_its_outputs(messages_of: MessagesOf) -> None:
    first, second = messages_of(
        OUTER.replace("LAST", "@@rsme"),
        more=MORE,
        inner=INNER.replace("WHAT", "@@fil"),
    )
    assert {first.split(" | ")[0], second.split(" | ")[0]} == {
        "inner.ranked: compare: port 'scores' has no axis or column 'fil'",
        "last: metric: port 'scores' has no column 'rsme'",
    }


UNITS = """
axes: {take: [0, 1], alone: [7], trial: [0, 1]}
nodes:
  n: {use: read.number, with: {start: $take}}
  cut: {use: gaps.cut, in: n, with: {seed: $trial, length: $alone}}
  rated: {use: rate.gaps, in: cut}
  ranked: {use: rank.all, in: rated, with: {units: [UNIT]}}
"""


@pytest.mark.parametrize(
    ("name", "expected"),
    [("alone", ("'alone'", "one label", "7")), ("trial", ("'trial'", "same data", "take"))],
)
def test_independent_units_need_labels_with_different_data(
    graph_of: Callable[..., Graph], name: str, expected: tuple[str, ...]
) -> None:
    with pytest.raises(GraphError) as caught:
        graph_of(UNITS.replace("UNIT", name), more=MORE)
    (problem,) = caught.value.problems
    assert all(text in f"{problem.message} {problem.instead}" for text in expected)
    assert problem.place.line == 8


@pytest.mark.parametrize("name", ["take", "gap"])
def test_independent_units_may_be_an_axis_of_the_data_or_a_column(
    graph_of: Callable[..., Graph], name: str
) -> None:
    assert graph_of(UNITS.replace("UNIT", name), more=MORE)

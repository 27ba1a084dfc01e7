"""The values of a node as one table."""

from __future__ import annotations

from collections.abc import Callable

import pandas as pd
import pytest
from pandas.testing import assert_frame_equal

from nodegraph import Refusal, node
from nodegraph.execute.results import Run

AXES = """
    axes: {k: [1, 2], trial: {count: 2}}
    nodes:
      a: {use: read.number, with: {start: $k}}
      gaps: {use: gaps.cut, in: a, with: {length: 4, seed: $trial}}
"""


@node("score.rows")
def rows(recording: float) -> pd.DataFrame:
    table = pd.DataFrame({"gap": [0, 1], "k": [9, 9], "rmse": [recording, 2 * recording]})
    table.attrs["units"] = {"rmse": "mm"}
    return table


@node("score.few")
def few(recording: float) -> pd.DataFrame:
    if recording < -2.95:
        raise Refusal("too low")
    return pd.DataFrame({"state": ["good"]}, index=pd.Index(["m1"], name="marker"))


def states(frame: pd.DataFrame) -> dict[tuple[int, str], tuple[str, str]]:
    columns = (frame[name].tolist() for name in ("k", "fill", "state", "reason"))
    return {(k, fill): (state, reason) for k, fill, state, reason in zip(*columns, strict=True)}


def test_numbers_stand_in_one_column_named_after_the_node(run_of: Callable[..., Run]) -> None:
    frame = run_of(AXES)["gaps"].frame()
    expected = pd.DataFrame(
        {"k": [1, 1, 2, 2], "trial": [0, 1, 0, 1], "gaps": [-3.0, -2.9, -2.0, -1.9]}
    )
    assert_frame_equal(frame, expected)


def test_numbers_of_one_output_are_named_after_it(run_of: Callable[..., Run]) -> None:
    run = run_of(AXES)
    assert list(run["gaps.hidden"].frame().columns) == ["k", "trial", "hidden"]
    assert run["gaps.hidden"].frame()["hidden"].tolist() == [4, 4, 4, 4]


def test_a_node_without_axes_has_one_row(run_of: Callable[..., Run]) -> None:
    frame = run_of("nodes: {a: {use: text.write, with: {text: hello}}}")["a"].frame()
    assert_frame_equal(frame, pd.DataFrame({"a": ["hello"]}))


def test_the_axis_of_the_alternatives_and_their_values_are_distinguished(
    run_of: Callable[..., Run],
) -> None:
    text = """
    nodes:
      a: {use: read.number}
      fill: {in: a, alternatives: [fill.hold, fill.scale]}
    """
    frame = run_of(text)["fill"].frame()
    expected = pd.DataFrame({"fill": ["hold", "scale"], "output": [2.0, 2.0]})
    assert_frame_equal(frame, expected)


def test_rows_of_tables_get_the_labels_and_the_axis_wins(run_of: Callable[..., Run]) -> None:
    text = f"{AXES}      score: {{use: score.rows, in: gaps}}\n"
    frame = run_of(text, more=[rows])["score"].frame()
    assert list(frame.columns) == ["k", "trial", "gap", "rmse"]
    assert frame["k"].tolist() == [1, 1, 1, 1, 2, 2, 2, 2]
    assert frame["trial"].tolist() == [0, 0, 1, 1, 0, 0, 1, 1]
    assert frame["rmse"].tolist() == pytest.approx([-3, -6, -2.9, -5.8, -2, -4, -1.9, -3.8])
    assert frame.attrs == {"units": {"rmse": "mm"}}
    assert frame.index.equals(pd.RangeIndex(8))


def test_combinations_without_a_value_are_reported(run_of: Callable[..., Run]) -> None:
    text = """
    axes: {k: [-1, 2, 3]}
    nodes:
      a: {use: read.number, with: {start: $k}}
      fill: {in: a, alternatives: [strict.positive, strict.fails, fill.hold]}
      next: {use: fill.hold, in: fill}
    skip: [{k: 3, fill: [fails, hold]}]
    """
    run = run_of(text)
    frame = run["fill"].frame()
    assert list(frame.columns) == ["k", "fill", "output", "state", "reason"]
    ended = states(frame)
    assert ended[-1, "positive"] == ("refused", "-1.0 is negative")
    assert ended[-1, "fails"] == ("failed", "-1.0 is negative")
    assert ended[3, "hold"] == ("skipped", "skip: k = 3, fill = fails or hold")
    assert ended[2, "hold"] == ("done", "")
    assert frame["output"].isna().tolist() == (frame["state"] != "done").tolist()
    assert len(frame) == 9
    assert states(run["next"].frame())[-1, "fails"][0] == "skipped"


@pytest.mark.filterwarnings("error")
def test_a_refused_table_is_a_row_and_columns_of_the_tables_are_kept(
    run_of: Callable[..., Run],
) -> None:
    text = f"{AXES}      score: {{use: score.few, in: gaps}}\n"
    frame = run_of(text, more=[few])["score"].frame()
    assert list(frame.columns) == ["k", "trial", "marker", "state", "score_state", "reason"]
    assert frame["score_state"].tolist() == ["refused", "done", "done", "done"]
    assert frame["marker"].tolist()[1:] == ["m1", "m1", "m1"]
    assert frame["marker"].isna().tolist() == [True, False, False, False]
    assert frame["reason"].tolist() == ["too low", "", "", ""]


def test_anything_else_stands_there_itself(run_of: Callable[..., Run]) -> None:
    text = f"{AXES}      table: {{use: compare.table, in: gaps, over: [trial]}}\n"
    run = run_of(text)
    frame = run["table"].frame()
    assert frame["k"].tolist() == [1, 2]
    assert [seen.scores.axes for seen in frame["table"]] == [("trial",), ("trial",)]


def test_nothing_but_failures_is_a_table_too(run_of: Callable[..., Run]) -> None:
    text = """
    nodes:
      a: {use: read.number, with: {start: -1}}
      b: {use: strict.fails, in: a}
    """
    frame = run_of(text)["b"].frame()
    assert frame["b"].isna().all()
    assert frame["state"].tolist() == ["failed"]

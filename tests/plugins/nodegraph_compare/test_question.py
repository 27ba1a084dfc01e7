from __future__ import annotations

from typing import Any

import pandas as pd
import pytest

from nodegraph import Across
from nodegraph_compare.question import Asked, Question, ask, blocks_name, unit_of
from nodegraph_tables import TableInfo, with_info


def score(**columns: list[object]) -> pd.DataFrame:
    return pd.DataFrame({"gap": [0, 1], "frames": [5, 5], "rmse": [1.0, 2.0], **columns})


def across(*axes: str, **columns: list[object]) -> Across[pd.DataFrame]:
    return Across(axes, ((dict.fromkeys(axes, "one"), score(**columns)),))


def question_of(scores: Across[pd.DataFrame], **settings: Any) -> Question:
    return ask(scores, Asked(**settings))


def test_defaults() -> None:
    question = question_of(across("trial", "length", "fill"), within=("length",))
    assert question == Question(
        "rmse", "fill", ("length",), ("trial", "gap"), (), ("trial", "gap"), (), ("trial",)
    )


def test_compare_is_the_last_axis_that_is_not_taken() -> None:
    assert question_of(across("fill", "trial"), blocks=("trial",)).compare == "fill"
    assert question_of(across("fill", "trial"), within=("trial", "fill")).compare is None


def test_axes_named_nowhere_are_averaged_over() -> None:
    question = question_of(across("take", "trial", "fill"), blocks=("trial", "gap"))
    assert question.averaged == ("take",)


@pytest.mark.parametrize(
    ("first", "blocks"),
    [({"frame": [3, 4]}, ("trial",)), ({"height": [0.5, 1.5]}, ("trial",))],
)
def test_frames_and_floats_are_no_unit(first: dict[str, list[float]], blocks: object) -> None:
    table = pd.DataFrame({**first, "rmse": [1.0, 2.0]})
    scores = Across(("trial", "fill"), (({"trial": 0, "fill": "a"}, table),))
    assert question_of(scores).blocks == blocks


def test_columns_can_be_compared_and_grouped_by() -> None:
    question = question_of(across("fill", side=["l", "r"]), compare="side", within=("fill",))
    assert question == Question("rmse", "side", ("fill",), ("gap",), (), ("gap",), (), ())


def test_whole_numbers_are_a_metric_only_when_asked_for() -> None:
    assert question_of(across("fill"), metric="frames").metric == "frames"


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (
            {"metric": "rms"},
            "no metric 'rms' in .* of fill=one; did you mean 'rmse'. columns: gap,",
        ),
        ({"metric": "name"}, "metric 'name' is not a column of numbers .* there are: gap, frames"),
        (
            {"compare": "file"},
            "no axis or column 'file' .*; did you mean 'fill'. axes and columns: fill",
        ),
        (
            {"within": ("fil",)},
            "no axis or column 'fil' .*; did you mean 'fill'. axes and columns: fill",
        ),
        ({"blocks": ("trial",)}, "no axis or column 'trial'"),
        ({"compare": "fill", "within": ("fill",)}, "share a name: fill"),
    ],
)
def test_unknown_names_are_refused_with_those_that_exist(
    settings: dict[str, object], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        question_of(across("fill", name=["x", "y"]), **settings)


def test_tables_without_floats_and_no_tables() -> None:
    table = pd.DataFrame({"gap": [0], "name": ["x"]})
    with pytest.raises(ValueError, match="no column of floats; columns: gap, name"):
        question_of(Across.of({"a": table}, axis="fill"))
    with pytest.raises(ValueError, match="no table to compare"):
        question_of(Across(("fill",), ()))


def test_a_table_that_lacks_the_metric_is_named() -> None:
    scores = Across.of({"a": score(), "b": score().drop(columns="rmse")}, axis="fill")
    with pytest.raises(ValueError, match="no metric 'rmse' in the table of fill=b"):
        question_of(scores)


def test_the_better_end_is_declared_or_given() -> None:
    higher = TableInfo(better={"rmse": "higher"})
    scores = Across.of({"a": with_info(score(), higher)}, axis="fill")
    assert question_of(scores).better == "higher"
    assert question_of(scores, better="none").better == "none"


def test_the_unit_is_the_first_tables() -> None:
    scores = across("fill")
    assert unit_of(scores, question_of(scores).metric) == ""
    scores = Across.of({"a": with_info(score(), TableInfo(units={"rmse": "mm"}))}, axis="fill")
    assert unit_of(scores, question_of(scores).metric) == "mm"


def test_blocks_are_called_by_the_column_that_tells_them_or_the_only_axis() -> None:
    scores = across("trial", "fill")
    assert blocks_name(scores, question_of(scores)) == "gaps"
    assert blocks_name(scores, question_of(scores, blocks=("trial",))) == "trials"
    assert blocks_name(scores, question_of(scores, blocks=("gap", "frames"))) == "blocks"
    more = across("take", "trial", "fill")
    assert blocks_name(more, question_of(more, blocks=("take", "trial"))) == "blocks"


def test_frames_are_no_blocks() -> None:
    scores = across("trial", frame=[0, 1])
    for blocks in (("frame",), ("trial", "frame")):
        with pytest.raises(ValueError, match=r"frames of a take .* name axes such as trial"):
            question_of(scores, blocks=blocks)

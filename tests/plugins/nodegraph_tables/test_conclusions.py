"""Conclusions of a table are what stays the same while its numbers drift."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pandas as pd
from pandas import DataFrame

from nodegraph_tables import Answer, Finding, Word
from nodegraph_tables.conclusions import (
    conclude_table,
    table_data,
    table_numbers,
)
from nodegraph_tables.info import TableInfo, with_info
from nodegraph_tables.text import HERE, say


def compared(info: TableInfo = TableInfo()) -> DataFrame:  # noqa: B008
    table = DataFrame(
        {
            "length": [5, 5, 15, 15],
            "fill": ["linear", "muscle", "linear", "muscle"],
            "blocks": [40, 40, 40, 40],
            "mean": [0.25, 0.5, 2.0, 1.0],
        }
    )
    return with_info(table, info)


def answered(number: str, best: tuple[str, ...] = ("linear",)) -> TableInfo:
    """Return a table's answer with a measured number and a finding."""
    finding = Finding({"length": 5}, "length 5", True, best, ("pca",), ("muscle",))
    words = say(
        f"{HERE} wins by {HERE} of 17 mm.", Word("linear", "method"), Word(number, "number")
    )
    return TableInfo(answer=Answer(words, findings=(finding,)), best={"mean": (0, 3)})


def test_a_table_says_its_answer_and_its_best_rows() -> None:
    assert list(conclude_table(compared(answered("0.25")))) == [
        "linear wins by … of 17 mm.",
        "length 5: best: linear; may be as good: pca; behind: muscle",
        "best mean: length 15, fill muscle; length 5, fill linear",
    ]


def test_drift_leaves_the_conclusions_and_a_turn_does_not() -> None:
    table, drifted = compared(answered("0.25")), compared(answered("0.2500000001"))
    drifted.loc[[0, 1], "mean"] = [0.5, 0.4999999]  # what is not the best may change places
    assert list(conclude_table(drifted)) == list(conclude_table(table))
    turned = compared(answered("0.25", ("muscle",)))
    assert list(conclude_table(turned)) != list(conclude_table(table))


def test_no_verdict_concludes_nothing() -> None:
    finding = Finding({}, "", False, (), (), ())
    info = TableInfo(answer=Answer(("Nothing.",), findings=(finding,)))
    assert list(conclude_table(compared(info))) == ["Nothing.", "all: no verdict"]


def test_the_numbers_are_csv_of_ten_digits() -> None:
    table = DataFrame({"fill": ["a,b", "c"], "mean": [1.0 / 3.0, float("nan")]})
    assert table_numbers(table) == 'fill,mean\n"a,b",0.3333333333\nc,\n'


def test_a_table_is_numbers_with_what_its_marks_mean() -> None:
    numbers = DataFrame(
        {
            "fill": pd.Series(["linear", "muscle", pd.NA], dtype="string"),
            "blocks": [3, 3, 6],
            "mean": [0.5, np.nan, 0.25],
            "p": [np.float64(0.01), np.nan, 1.0],
        }
    )
    info = TableInfo(
        units={"mean": "mm"}, best={"mean": (2,)}, tied={"mean": (0,)}, cells={"mean": {"p": "p"}}
    )
    data: Any = json.loads(json.dumps(table_data(with_info(numbers, info)), allow_nan=False))
    assert data["columns"] == ["fill", "blocks", "mean", "p"]
    assert data["rows"] == [
        ["linear", 3, 0.5, 0.01],
        ["muscle", 3, None, None],
        [None, 6, 0.25, 1.0],
    ]
    assert (data["units"], data["best"], data["tied"]) == (
        {"mean": "mm"},
        {"mean": [2]},
        {"mean": [0]},
    )
    assert data["cells"] == {"mean": {"p": "p"}}

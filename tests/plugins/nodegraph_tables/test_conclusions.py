"""Conclusions of a table are what stays the same while its numbers drift."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pandas as pd
import pytest
from pandas import DataFrame

from nodegraph_tables.conclusions import (
    conclude_table,
    table_data,
    table_numbers,
    without_measured,
)
from nodegraph_tables.info import TableInfo, with_info


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


def test_a_table_says_its_answer_and_its_best_rows() -> None:
    info = TableInfo(answer=("linear wins by 0.25 mm (n = 40).",), best={"mean": (0, 3)})
    assert list(conclude_table(compared(info))) == [
        "linear wins by # mm (n = #).",
        "best mean: length 15, fill muscle; length 5, fill linear",
    ]


def test_drift_leaves_the_conclusions_and_a_turn_does_not() -> None:
    table = compared(TableInfo(answer=("0.25 mm",), best={"mean": (0, 3)}))
    drifted = compared(TableInfo(answer=("0.2500000001 mm",), best={"mean": (0, 3)}))
    drifted.loc[[0, 1], "mean"] = [0.5, 0.4999999]  # what is not the best may change places
    assert list(conclude_table(drifted)) == list(conclude_table(table))
    turned = compared(TableInfo(answer=("0.25 mm",), best={"mean": (1, 3)}))
    turned.loc[0, "mean"] = 0.75
    assert list(conclude_table(turned)) != list(conclude_table(table))


@pytest.mark.parametrize(
    ("sentence", "bare"),
    [
        ("at length 15, 0.25 mm", "at length 15, # mm"),
        ("p < 1e-5 of 40 blocks (12 to 40)", "p < # of 40 blocks (# to #)"),
        ("order_3 before v1.2 and -0.5", "order_3 before v1.2 and #"),
        ("3 of 17 methods", "3 of 17 methods"),
    ],
)
def test_measured_numbers_go_and_labels_stay(sentence: str, bare: str) -> None:
    assert without_measured(sentence) == bare


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

"""Conclusions of a table are what stays the same while its numbers drift."""

from __future__ import annotations

import pytest
from pandas import DataFrame

from nodegraph_tables.conclusions import conclude_table, table_numbers, without_measured
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

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
            "difference low": [-0.5, 0.0, 0.25, float("nan")],
            "difference high": [-0.25, 0.0, 0.5, float("nan")],
        }
    )
    return with_info(table, info)


def test_a_table_says_its_answer_its_best_rows_their_order_and_what_is_apart() -> None:
    info = TableInfo(answer=("linear wins by 0.25 mm (n = 40).",), best={"mean": (0, 3)})
    table = compared(info)
    assert list(conclude_table(table)) == [
        "linear wins by # mm (n = #).",
        "best mean: length 5, fill linear; length 15, fill muscle",
        "mean (length 5): linear < muscle",
        "mean (length 15): muscle < linear",
        "difference below 0: length 5, fill linear",
        "difference above 0: length 15, fill linear",
    ]


def test_drift_leaves_the_conclusions_and_a_turn_does_not() -> None:
    table = compared(TableInfo(answer=("0.25 mm",), best={"mean": (0, 3)}))
    drifted = compared(TableInfo(answer=("0.2500000001 mm",), best={"mean": (0, 3)}))
    drifted["mean"] *= 1.0 + 1e-12
    assert list(conclude_table(drifted)) == list(conclude_table(table))
    turned = compared(TableInfo(answer=("0.25 mm",), best={"mean": (1, 3)}))
    turned.loc[0, "mean"] = 0.75
    assert list(conclude_table(turned)) != list(conclude_table(table))


def test_what_is_apart_does_not_depend_on_the_order_of_the_rows() -> None:
    table = compared()
    table["difference low"], table["difference high"] = -2.0, -1.0
    turned = table.iloc[::-1].reset_index(drop=True)
    assert list(conclude_table(turned)) == list(conclude_table(table))


def test_rows_without_a_number_have_no_place_in_the_order() -> None:
    table = compared(TableInfo(best={"mean": (0,)}))
    table.loc[1, "mean"] = float("nan")
    assert "mean (length 5): linear" in list(conclude_table(table))


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

"""Changes of conclusions and of tables beyond rounding."""

from __future__ import annotations

import pytest

from nodegraph.lock.conclusions import Reported, conclusion_changes, table_changes

TABLE = "length,fill,mean,share\n5,linear,0.5,0\n5,muscle,2,1e-17\n15,linear,,3\n"


def changes(now: str, was: str = TABLE) -> list[str]:
    return list(table_changes({"table": was}, [Reported("table", (), now)], 1e-9))


def test_lost_and_new_conclusions_are_listed() -> None:
    was = {"table": ["a < b", "c"], "gone": ["d"]}
    now = [
        Reported("table", ("b < a", "c"), ""),
        Reported("new", ("e",), ""),
        Reported("none", (), ""),
    ]
    assert list(conclusion_changes(was, now)) == [
        "table: no longer: a < b",
        "table: now: b < a",
        "gone: no longer: d",
        "new: now: e",
    ]


@pytest.mark.parametrize(
    "now",
    [TABLE, TABLE.replace("0.5", "0.5000000000001"), TABLE.replace("1e-17", "0")],
)
def test_rounding_is_no_change(now: str) -> None:
    assert changes(now) == []


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ("0.5,0", "0.25,0", "mean of 5, linear: 0.5, now 0.25"),
        (",,3", ",7,3", "mean of 15, linear: , now 7"),
        ("muscle", "ridge", "fill of 5: muscle, now ridge"),
        ("15,linear,,3\n", "", "3 rows, now 2"),
        ("fill,mean", "mean", "length, fill, mean, share, now length, mean, share"),
    ],
)
def test_a_change_is_located(old: str, new: str, place: str) -> None:
    [text] = changes(TABLE.replace(old, new))
    assert text.startswith("table: ")
    assert text.endswith(place)


def test_changes_are_measured_in_units_of_their_column() -> None:
    [text] = changes(TABLE.replace("0.5", "0.6").replace(",3\n", ",30\n"))
    assert text.startswith("table: 2 of 3 rows")
    assert "share of 15, linear, " in text


def test_a_table_that_the_lock_lacks_is_left_out() -> None:
    assert list(table_changes({}, [Reported("table", (), TABLE)], 0.0)) == []


@pytest.mark.parametrize(
    ("was", "now", "text"),
    [
        (TABLE, "", "now none"),
        ("", TABLE, "columns none"),
        ("a,b\n1\n", "a,b\n1,2\n", "b of 1: , now 2"),
        ("a\n1,5\n", "a\n1\n", "1 of 1 rows"),
    ],
)
def test_ragged_and_empty_tables_are_compared(was: str, now: str, text: str) -> None:
    [change] = changes(now, was)
    assert text in change

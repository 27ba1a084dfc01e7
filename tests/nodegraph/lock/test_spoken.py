"""Changed conclusions and changed numbers are told apart from rounding."""

from __future__ import annotations

import pytest

from nodegraph.lock.compare import conclusions_changed, numbers_changed
from nodegraph.lock.results import Said

TABLE = "length,fill,mean,share\n5,linear,0.5,0\n5,muscle,2,1e-17\n15,linear,,3\n"
ONE = "1 of 3 rows are others; most of all"


def numbers(now: str, least: float = 1e-9) -> list[str]:
    return list(numbers_changed({"table": TABLE}, [Said("table", (), now)], least))


def test_conclusions_are_told_by_what_is_no_longer_drawn_and_what_now_is() -> None:
    was = {"table": ["a < b", "c"], "gone": ["d"]}
    now = [Said("table", ("b < a", "c"), ""), Said("new", ("e",), ""), Said("none", (), "")]
    assert list(conclusions_changed(was, now)) == [
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
    assert numbers(now) == []


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("0.5,0", "0.25,0", f"{ONE} mean of 5, linear: 0.5, now 0.25"),
        (",,3", ",7,3", f"{ONE} mean of 15, linear: , now 7"),
        ("muscle", "ridge", f"{ONE} fill of 5: muscle, now ridge"),
        ("15,linear,,3\n", "", "had 3 rows, now 2"),
        ("fill,mean", "mean", "had the columns length, fill, mean, share, now length, mean, share"),
    ],
)
def test_a_change_is_told_with_its_row(old: str, new: str, said: str) -> None:
    assert numbers(TABLE.replace(old, new)) == [f"table: {said}"]


def test_the_largest_change_is_told_in_units_of_its_column() -> None:
    now = TABLE.replace("0.5", "0.6").replace(",3\n", ",30\n")
    (said,) = numbers(now)
    assert said.startswith("table: 2 of 3 rows are others; most of all share of 15, linear, ")


def test_a_table_that_the_lock_does_not_know_is_left_out() -> None:
    assert list(numbers_changed({}, [Said("table", (), TABLE)], 0.0)) == []


@pytest.mark.parametrize(
    ("was", "now", "said"),
    [
        (TABLE, "", "had the columns length, fill, mean, share, now none"),
        ("", TABLE, "had the columns none, now length, fill, mean, share"),
        ("a,b\n1\n", "a,b\n1,2\n", "1 of 1 rows are others; most of all b of 1: , now 2"),
        ("a\n1,5\n", "a\n1\n", "1 of 1 rows are others; most of all "),
    ],
)
def test_a_table_need_not_be_one(was: str, now: str, said: str) -> None:
    [found] = numbers_changed({"table": was}, [Said("table", (), now)], 1e-9)
    assert found.startswith(f"table: {said}")

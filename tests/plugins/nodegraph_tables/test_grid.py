"""A comparison as a grid: methods down the side, groups along the top, marks in place."""

from __future__ import annotations

import pandas as pd
import pytest

from nodegraph_tables import TableInfo, with_info
from nodegraph_tables.rendering import render_table


def test_a_row_per_mean_becomes_methods_by_groups() -> None:
    table = pd.DataFrame(
        {
            "ends": ["met", "met", "kept", "kept"],
            "length": [5, 5, 5, 5],
            "fill": ["b", "a", "b", "a"],
            "mean": [0.1, 0.2, 0.3, 0.4],
        }
    )
    info = TableInfo(
        labels=("ends", "length", "fill"),
        units={"mean": "mm"},
        best={"mean": (0, 2)},
        tied={"mean": (3,)},
    )
    grid = render_table(with_info(table, info), "rmse").grid
    assert grid is not None
    assert grid.title == "rmse [mm]"
    assert grid.head == ("fill", "met\nlength 5", "kept\nlength 5")
    assert grid.rows == (("b", "0.100", "0.300"), ("a", "0.200", "0.400"))
    assert (set(grid.best), set(grid.tied)) == ({(0, 1), (0, 2)}, {(1, 2)})


def test_methods_with_the_same_mean_place_stand_as_listed() -> None:
    methods = [f"method_{number}" for number in range(12)]
    listed = [*methods, *reversed(methods)]
    groups = ["5"] * 12 + ["45"] * 12
    table = pd.DataFrame({"length": groups, "fill": listed, "mean": [*range(24)]})
    info = TableInfo(labels=("length", "fill"), best={"mean": (0,)})
    grid = render_table(with_info(table, info), "rmse").grid
    assert grid is not None
    assert [row[0] for row in grid.rows] == methods


def test_a_table_of_several_marked_columns_stays_as_it_is() -> None:
    table = pd.DataFrame({"fill": ["b", "a"], "usual": [2.0, 1.0], "noisy": [3.0, None]})
    info = TableInfo(labels=("fill",), best={"usual": (1,), "noisy": (0,)})
    grid = render_table(with_info(table, info), "rmse").grid
    assert grid is not None
    assert grid.head == ("fill", "usual", "noisy")
    assert grid.rows == (("b", "2", "3"), ("a", "1", ""))
    assert set(grid.best) == {(1, 1), (0, 2)}


def test_a_table_without_a_best_has_none() -> None:
    assert render_table(pd.DataFrame({"fill": ["b"], "mean": [1.0]}), "rmse").grid is None


LAID_OUT = TableInfo(
    labels=("length", "fill"), best={"mean": (1, 2)}, layout=(("length",), ("fill",))
)


def laid_out() -> pd.DataFrame:
    """Return two methods by two lengths, methods along the top for a reader."""
    rows = [(5, "b", 0.2), (5, "a", 0.1), (45, "b", 0.3), (45, "a", 0.4)]
    return with_info(pd.DataFrame(rows, columns=["length", "fill", "mean"]), LAID_OUT)


def test_a_layout_is_what_readers_see_and_the_file_has_a_row_for_each_mean() -> None:
    shown = render_table(laid_out(), "rmse")
    assert shown.grid is not None
    assert (shown.grid.head, shown.grid.rows) == (
        ("length", "b", "a"), (("5", "0.200", "0.100"), ("45", "0.300", "0.400")),
    )  # fmt: skip
    assert set(shown.grid.best) == {(0, 2), (1, 1)}
    assert shown.text.splitlines()[:3] == [
        "length       b       a", "     5   0.200  0.100*", "    45  0.300*   0.400",
    ]  # fmt: skip
    assert "<strong>0.100</strong>" in shown.html
    assert "length & b & a" in shown.files[".tex"].decode()
    assert len(shown.files[".csv"].decode().splitlines()) == 5


@pytest.mark.parametrize("name", ["length", "fill", "mean"])
def test_a_table_that_lacks_a_column_of_its_layout_is_shown_as_it_is(name: str) -> None:
    table = laid_out().drop(columns=name)
    assert render_table(table, "rmse").text.splitlines()[0].split() == list(table.columns)

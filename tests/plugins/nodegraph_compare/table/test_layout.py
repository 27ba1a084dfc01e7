from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import pytest

from nodegraph import Across
from nodegraph_compare.table.node import table
from nodegraph_mocap import Table
from nodegraph_tables import TableInfo, info_of, with_info
from nodegraph_tables.latex import latex_of
from nodegraph_tables.rendering import render_table


def study() -> Across[Table]:
    """Scores of two methods at two lengths on three markers, eight trials."""
    random = np.random.default_rng(3)
    entries = []
    for trial in range(8):
        for length in (5, 45):
            for fill, more in (("lin", 0.0), ("cubic", 1.0 if length == 45 else -1.0)):
                rmse = 3 + more + random.uniform(size=3)
                labels = {"trial": trial, "length": length, "fill": fill}
                rows = pd.DataFrame({"marker": ["jaw", "chin", "brow"], "rmse": rmse})
                rows = with_info(rows, TableInfo(units={"rmse": "mm"}))
                entries.append((labels, rows))
    return Across(("trial", "length", "fill"), tuple(entries))


def laid_out(**settings: Any) -> Table:
    return table(study(), **settings).table


def seen(frame: Table) -> list[list[str]]:
    """Return the heads and the rows that a terminal shows, the best with an asterisk."""
    grid = render_table(frame, "t").grid
    assert grid is not None
    rows = [
        [f"{text}{'*' * ((at, column) in grid.best)}" for column, text in enumerate(row)]
        for at, row in enumerate(grid.rows)
    ]
    return [list(grid.head), *rows]


def best(frame: Table) -> list[list[bool]]:
    return [[text.endswith("*") for text in row[1:]] for row in seen(frame)[1:]]


def test_the_table_is_the_same_but_methods_stand_in_their_order() -> None:
    result = laid_out(rows=("length",), columns=("fill",))
    plain = laid_out(within=("length",), compare="fill")
    of_groups = plain[plain["length"].notna()]
    assert result[["length", "fill"]].to_numpy().tolist() == [
        [5, "lin"], [5, "cubic"], [45, "lin"], [45, "cubic"],
    ]  # fmt: skip
    keys = ["length", "fill"]
    same = pd.merge(result[[*keys, "mean", "low", "high", "p"]], of_groups, on=keys)
    for name in ("mean", "low", "high", "p"):
        assert same[f"{name}_x"].to_numpy() == pytest.approx(same[f"{name}_y"], nan_ok=True)
    assert render_table(result, "t").files[".csv"].decode().startswith("length,fill,blocks,mean")


def test_a_row_per_trajectory_and_a_column_per_method() -> None:
    result = laid_out(rows=("marker",), columns=("fill",), blocks=("trial", "length"))
    heads, *rows = seen(result)
    assert heads == ["marker", "lin", "cubic"]
    means = result.set_index(["marker", "fill"])["mean"]
    assert [row[0] for row in rows] == ["jaw", "chin", "brow"]
    for marker, lin, cubic in rows:
        shown = float(lin.rstrip("*")), float(cubic.rstrip("*"))
        assert shown == pytest.approx([means[marker, "lin"], means[marker, "cubic"]], abs=6e-3)


def test_methods_down_the_side_and_lengths_along_the_top() -> None:
    result = laid_out(rows=("fill",), columns=("length",))
    heads, *rows = seen(result)
    assert heads == ["fill", "length 5", "length 45"]
    assert [row[0] for row in rows] == ["lin", "cubic"]
    # the best of a group, here a column, is marked
    assert best(result) == [[False, True], [True, False]]
    assert any("Every mean is over 24 blocks." in note for note in info_of(result).notes)


def test_the_best_of_each_row_is_marked_at_the_better_end() -> None:
    settings: Any = {"rows": ("length",), "columns": ("fill",)}
    assert best(laid_out(**settings)) == [[False, True], [True, False]]
    assert best(laid_out(**settings, better="higher")) == [[True, False], [False, True]]
    assert best(laid_out(**settings, better="none")) == [[False, False], [False, False]]


def test_what_is_named_nowhere_stands_in_the_rows() -> None:
    heads, *rows = seen(laid_out(within=("length",), columns=("fill",)))
    assert heads == ["length", "lin", "cubic"]
    assert [row[0] for row in rows] == ["5", "45"]


def test_rows_alone_put_the_rest_along_the_top() -> None:
    assert seen(laid_out(rows=("length",), compare="fill"))[0] == ["length", "lin", "cubic"]


def test_names_that_all_stand_down_the_side_leave_a_row_for_each_mean() -> None:
    result = laid_out(rows=("length", "fill"))
    plain = laid_out(within=("length",), compare="fill")
    pd.testing.assert_frame_equal(pd.DataFrame(result), pd.DataFrame(plain))
    assert not any(info_of(result).layout)


def test_methods_alone_may_stand_along_the_top() -> None:
    result = laid_out(columns=("fill",))
    assert [len(row) for row in seen(result)] == [3, 3]
    html, latex = render_table(result, "t").html, latex_of(result, "t")
    assert html.count("<tr") == 2
    assert r"\multicolumn{2}{c}{lin} & \multicolumn{2}{c}{cubic}" in latex


def test_several_names_along_the_top() -> None:
    result = laid_out(rows=("marker",), columns=("length", "fill"), blocks=("trial",))
    assert seen(result)[0][1:] == [
        "length 5\nlin", "length 5\ncubic", "length 45\nlin", "length 45\ncubic",
    ]  # fmt: skip
    assert "length 45, cubic" in render_table(result, "t").html
    assert best(result) == [[False, True, True, False]] * 3


def test_each_cell_has_its_interval_and_a_dagger_where_it_is_apart() -> None:
    settings: Any = {"blocks": ("trial", "marker"), "baseline": "lin"}
    result = laid_out(rows=("length",), columns=("fill",), **settings)
    text = render_table(result, "t").text.splitlines()
    assert text[0].split() == ["length", "lin", "[mm]", "cubic", "[mm]"]
    daggers = result.loc[result["fill"] == "cubic", "p"] < 0.05
    assert ["\N{DAGGER}" in line for line in text[1:3]] == daggers.tolist() == [True, True]
    assert all(line.count("[") == 2 for line in text[1:3])
    assert info_of(result).title == "Mean rmse over markers by fill and length"


def test_a_missing_combination_is_an_empty_cell() -> None:
    scores = study()
    rest = [
        entry for entry in scores.entries if (entry[0]["length"], entry[0]["fill"]) != (45, "cubic")
    ]
    frame = table(Across(scores.axes, tuple(rest)), rows=("length",), columns=("fill",)).table
    assert [[bool(text.strip("*")) for text in row] for row in seen(frame)[1:]] == [
        [True, True, True], [True, True, False],
    ]  # fmt: skip
    # what stands alone is better than nothing
    assert best(frame) == [[False, True], [False, False]]


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"rows": ("fill",), "columns": ("fill",)}, "rows and columns share a name: fill"),
        ({"rows": ("trial",), "columns": ("fill",), "blocks": ("trial",)}, "share a name: trial"),
        ({"rows": ("nothing",), "columns": ("fill",)}, "no axis or column 'nothing'"),
    ],
)
def test_mistakes_of_a_layout_are_named(settings: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        laid_out(**settings)

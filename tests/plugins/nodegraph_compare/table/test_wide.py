from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import pytest

from nodegraph import Across
from nodegraph_compare.table.node import table
from nodegraph_mocap import Table
from nodegraph_tables import TableInfo, info_of, with_info
from nodegraph_tables.rendering import render_table

NAN = np.nan


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


def long(**settings: Any) -> Table:
    return laid_out(**settings).set_index([*settings["within"], "fill"])


def test_a_row_per_trajectory_and_a_column_per_method() -> None:
    result = laid_out(rows=("marker",), columns=("fill",), blocks=("trial", "length"))
    parts = [f"{fill}{part}" for fill in ("lin", "cubic") for part in ("", " low", " high", " p")]
    assert list(result.columns) == ["marker", "blocks", *parts]
    assert result["marker"].tolist() == ["jaw", "chin", "brow"]
    assert result["blocks"].tolist() == [16] * 3
    plain = long(within=("marker",), compare="fill", blocks=("trial", "length"))
    for row in result.to_dict("records"):
        for fill in ("lin", "cubic"):
            assert row[fill] == plain.loc[(row["marker"], fill), "mean"]
            assert row[f"{fill} high"] == plain.loc[(row["marker"], fill), "high"]


def test_methods_down_the_side_and_lengths_along_the_top() -> None:
    result = laid_out(rows=("fill",), columns=("length",))
    assert result["fill"].tolist() == ["lin", "cubic"]
    assert [name for name in map(str, result) if " " not in name[8:]] == [
        "fill",
        "length 5",
        "length 45",
    ]
    # the best of a group, here a column, is marked
    assert info_of(result).best == {"length 5": (1,), "length 45": (0,)}
    assert "blocks" not in result
    assert any("Every mean is over 24 blocks." in note for note in info_of(result).notes)


def test_the_best_of_each_row_is_marked_at_the_better_end() -> None:
    settings: Any = {"rows": ("length",), "columns": ("fill",)}
    assert info_of(laid_out(**settings)).best == {"lin": (1,), "cubic": (0,)}
    assert info_of(laid_out(**settings, better="higher")).best == {"lin": (0,), "cubic": (1,)}
    assert info_of(laid_out(**settings, better="none")).best == {"lin": (), "cubic": ()}


def test_what_is_named_nowhere_stands_in_the_rows() -> None:
    result = laid_out(within=("length",), columns=("fill",))
    assert result["length"].tolist() == [5, 45]
    assert list(result.columns[:3]) == ["length", "blocks", "lin"]


def test_rows_alone_put_the_rest_along_the_top() -> None:
    assert list(laid_out(rows=("length",), compare="fill").columns[:3]) == [
        "length",
        "blocks",
        "lin",
    ]


def test_several_names_along_the_top() -> None:
    result = laid_out(rows=("marker",), columns=("length", "fill"), blocks=("trial",))
    heads = [name for name in info_of(result).cells]
    assert heads == ["length 5, lin", "length 5, cubic", "length 45, lin", "length 45, cubic"]
    assert info_of(result).best["length 5, cubic"] == (0, 1, 2)


def test_each_cell_has_its_p() -> None:
    settings: Any = {"blocks": ("trial", "marker"), "baseline": "lin"}
    result = laid_out(rows=("length",), columns=("fill",), **settings)
    plain = long(within=("length",), compare="fill", **settings)
    assert result["cubic p"].tolist() == [plain.loc[(length, "cubic"), "p"] for length in (5, 45)]
    assert result["lin p"].isna().all()
    assert "\N{DAGGER}" in render_table(result, "t").text


def test_a_reader_sees_a_column_per_method_and_the_file_has_every_digit() -> None:
    result = laid_out(rows=("length",), columns=("fill",))
    shown = render_table(result, "t")
    assert shown.text.splitlines()[0].split() == ["length", "lin", "cubic"]
    header, first = shown.files[".csv"].decode().splitlines()[:2]
    assert header.startswith("length,blocks,lin,lin low,lin high,lin p,cubic")
    assert float(first.split(",")[2]) == result["lin"][0]
    assert info_of(result).title == "Mean rmse (mm) over markers by fill and length"


def test_a_missing_combination_is_an_empty_cell_and_reported() -> None:
    scores = study()
    rest = [
        entry for entry in scores.entries if (entry[0]["length"], entry[0]["fill"]) != (45, "cubic")
    ]
    frame = table(Across(scores.axes, tuple(rest)), rows=("length",), columns=("fill",)).table
    assert frame["lin"].notna().all()
    assert frame["cubic"].isna().tolist() == [False, True]
    # what stands alone is better than nothing
    assert info_of(frame).best == {"lin": (), "cubic": (0,)}


def test_labels_that_would_name_two_columns_alike_are_distinguished() -> None:
    scores = Across.of(
        {
            name: pd.DataFrame({"gap": range(4), "rmse": [1.0, 2.0, 3.0, place]})
            for place, name in enumerate(("a", "a low", "gap", "blocks"))
        },
        axis="fill",
    )
    frame = table(scores, rows=("gap",), columns=("fill",)).table
    assert len(set(frame.columns)) == len(frame.columns)
    assert "fill 'a low'" in frame


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

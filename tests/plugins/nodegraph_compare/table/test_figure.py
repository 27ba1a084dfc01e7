from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_hex

from nodegraph import Across
from nodegraph_compare.pictures import span_of
from nodegraph_compare.table.node import Compared, table
from nodegraph_tables import TableInfo, with_info
from nodegraph_tables.style import BEST, BLACK, REST

FILLS = ("lin", "cubic", "akima")


def compared(*, within: tuple[str, ...], scale: float = 1.0, **settings: Any) -> Compared:
    """Compare three fills, each ``scale`` times worse than the one before."""
    random = np.random.default_rng(0)
    entries = []
    for take in ("jaw", "cheeks"):
        for length in (5, 45):
            for place, fill in enumerate(FILLS):
                rmse = random.uniform(1, 2, size=8) * scale**place
                labels = {"take": take, "length": length, "fill": fill}
                entries.append((labels, pd.DataFrame({"gap": range(8), "rmse": rmse})))
    scores = Across(("take", "length", "fill"), tuple(entries))
    return table(scores, within=within, clusters=("gap",), **settings)


def of_values(values: dict[str, Any], **settings: Any) -> Compared:
    """Compare methods by given values of eight units each."""
    tables = {
        name: pd.DataFrame({"gap": range(8), "rmse": np.resize(number, 8)})
        for name, number in values.items()
    }
    return table(Across.of(tables, axis="fill"), clusters=("gap",), **settings)


def means(axis: Any) -> dict[int, Any]:
    """Return the mark of each row of a panel."""
    return {
        int(line.get_ydata()[0]): line
        for line in axis.lines
        if line.get_marker() == "o" and len(line.get_xdata()) == 1
    }


def rows(axis: Axes) -> list[str]:
    return [text.get_text() for text in axis.get_yticklabels()]


def test_a_row_has_the_mean_and_the_interval_of_the_table() -> None:
    result = compared(within=("length",), scale=3)
    names = rows(result.figure.axes[0])
    assert names == ["lin", "cubic", "akima"]
    for axis, length in zip(result.figure.axes, (5, 45), strict=True):
        assert axis.get_title("left") == f"length {length}"
        paths = [np.asarray(line.get_xydata()) for line in axis.lines]
        for row, mark in means(axis).items():
            at = result.table["fill"].eq(names[row]) & result.table["length"].eq(length)
            expected = result.table[at].iloc[0]
            assert mark.get_xdata()[0] == pytest.approx(expected["mean"])
            ends = next(path[:, 0] for path in paths if len(path) == 2 and path[0, 1] == row)
            assert ends == pytest.approx(expected[["low", "high"]].to_numpy(float))


@pytest.mark.parametrize(("unit", "mean"), [("share", "18.6"), ("mm^2", "0.186")])
def test_shares_are_drawn_in_percent_and_powers_as_they_are_printed(unit: str, mean: str) -> None:
    info = TableInfo(units={"rmse": unit})
    values = {"a": [0.2, 0.1, 0.3, 0.2], "b": [0.4, 0.5, 0.6, 0.5]}
    tables = {
        name: with_info(pd.DataFrame({"gap": range(4), "rmse": number}), info)
        for name, number in values.items()
    }
    (axis,) = table(Across.of(tables, axis="fill"), clusters=("gap",)).figure.axes
    assert "mm^2" not in axis.get_ylabel()
    assert mean in [text.get_text() for text in axis.texts]


def test_tables_without_rows_have_no_panel() -> None:
    empty = Across.of({"a": pd.DataFrame({"gap": [], "rmse": []}, dtype=float)}, axis="fill")
    with pytest.warns(UserWarning, match="the tables have no rows"):
        result = table(empty, clusters=("gap",))
    assert not result.figure.axes


def test_colour_is_a_role() -> None:
    result = compared(within=(), scale=3, baseline="akima")
    marks = means(result.figure.axes[0])
    colours = [to_hex(marks[row].get_color()) for row in range(3)]
    assert colours == [BEST, REST, BLACK]
    values = {"a": [1.0, 2.0], "b": [2.0, 1.1], "far": [40.0, 41.0]}
    tied = means(of_values(values).figure.axes[0])
    assert to_hex(tied[1].get_color()) == BEST
    assert to_hex(tied[1].get_markerfacecolor()) == "#ffffff"
    (caption,) = result.figure.texts
    assert "8 gaps" in caption.get_text()


def test_the_last_axis_lies_across_and_methods_keep_their_row() -> None:
    axes = compared(within=("take", "length"), scale=3).figure.axes
    places = [axis.get_position() for axis in axes]
    assert places[0].x0 < places[1].x0
    assert places[0].y0 == pytest.approx(places[1].y0)
    assert places[2].y0 < places[0].y0
    assert [rows(axis) for axis in axes] == [
        ["lin", "cubic", "akima"],
        [],
        ["lin", "cubic", "akima"],
        [],
    ]


@pytest.mark.parametrize(
    ("means", "kind"),
    [
        ((1.0, 9.0), "linear"),
        ((1.0, 11.0), "log"),
        ((0.0, 0.1, 11.0), "symlog"),
        ((-1.0, 50.0), "linear"),
    ],
)
def test_a_scale_is_logarithmic_where_errors_span_a_decade(
    means: tuple[float, ...], kind: str
) -> None:
    span = span_of(np.array(means), *np.full((2, len(means)), np.nan))
    assert span.kind == kind
    assert span.low < min(means)
    assert span.high > max(means)


def test_one_interval_does_not_flatten_all_others() -> None:
    mean = np.array([1.0, 1.5, 2.0])
    span = span_of(mean, mean - 0.1, np.array([1.1, 1.6, 40.0]))
    assert span.low > 0.5
    assert span.high < 2.5
    wide = span_of(mean, mean - 20.0, mean + 20.0)
    assert wide.low < -19.0
    assert wide.high > 22.0


@pytest.mark.parametrize("value", [0.0, 3.0])
def test_marks_of_nearly_equal_means_are_whole(value: float) -> None:
    (axis,) = of_values({"a": value, "b": value * (1 + 1e-13)}).figure.axes
    low, high = axis.get_xlim()
    width = high - low
    assert width > 1e-3
    assert all(
        low + 0.02 * width < x.get_xdata()[0] < high - 0.02 * width for x in means(axis).values()
    )


def test_a_method_without_a_value_keeps_its_row() -> None:
    with pytest.warns(UserWarning, match="not compared: pca"):
        result = of_values({"lin": [1.0, 2.0], "pca": np.nan})
    (axis,) = result.figure.axes
    assert rows(axis) == ["lin", "pca"]
    assert [
        (text.get_text(), text.get_position()[1])
        for text in axis.texts
        if text.get_fontstyle() == "italic"
    ] == [("no value", 1)]


def test_of_very_many_methods_the_best_is_named_and_names_keep_apart() -> None:
    values = {f"m{place}": 1.0 + (place * 37 % 200) / 200 for place in range(200)}
    figure = of_values(values).figure
    (axis,) = figure.axes
    assert len(means(axis)) == 200
    names, places = rows(axis), axis.get_yticks()
    assert names[0] == "m0"
    tall = axis.get_position().height * figure.get_figheight()
    assert np.diff(places).min() * tall / 200 > 0.11
    assert tall < 8


def test_of_many_panels_some_are_drawn_and_the_rest_counted() -> None:
    rows = pd.DataFrame({"a": np.repeat(range(30), 4), "b": [0, 0, 1, 1] * 30, "gap": [0, 1] * 60})
    tables = {name: rows.assign(rmse=np.arange(120.0) + 1) for name in ("x", "y")}
    result = table(Across.of(tables, axis="fill"), within=("a", "b"), blocks=("gap",))
    assert len(result.figure.axes) == 24
    assert "36 more panels" in result.figure.texts[-1].get_text()

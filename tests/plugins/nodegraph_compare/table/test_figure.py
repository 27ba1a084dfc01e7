from __future__ import annotations

import io
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_hex
from matplotlib.container import ErrorbarContainer

from nodegraph import Across
from nodegraph_compare.pictures import reach
from nodegraph_compare.table.node import Compared, table
from nodegraph_tables.style import looks


def compared(*, within: tuple[str, ...], scale: float = 1.0) -> Compared:
    random = np.random.default_rng(0)
    entries = []
    for take in ("jaw", "cheeks"):
        for length in (5, 45):
            for place, fill in enumerate(("lin", "cubic", "akima")):
                rmse = random.uniform(1, 2, size=8) * scale**place
                labels = {"take": take, "length": length, "fill": fill}
                entries.append((labels, pd.DataFrame({"gap": range(8), "rmse": rmse})))
    scores = Across(("take", "length", "fill"), tuple(entries))
    return table(scores, within=within, clusters=("gap",))


def points(axis: Any) -> dict[str, ErrorbarContainer]:
    return {axis.get_label(): axis for axis in axis.containers}


def test_means_and_intervals_are_those_of_the_table() -> None:
    result = compared(within=("length",))
    (axis,) = result.figure.axes
    for fill, container in points(axis).items():
        rows = result.table[result.table["fill"] == fill]
        line, _, (bars,) = container.lines
        assert np.asarray(line.get_ydata()) == pytest.approx(rows["mean"].to_numpy())
        ends = np.array([segment[:, 1] for segment in bars.get_segments()])
        assert ends == pytest.approx(rows[["low", "high"]].to_numpy())
    assert [text.get_text() for text in axis.get_xticklabels()] == ["5", "45"]


def test_a_panel_per_combination_and_one_look_per_method() -> None:
    result = compared(within=("take", "length"))
    assert [axis.get_title() for axis in result.figure.axes] == ["take jaw", "take cheeks"]
    look = looks(["lin", "cubic", "akima"])
    for axis in result.figure.axes:
        for fill, container in points(axis).items():
            line = container.lines[0]
            assert to_hex(line.get_color()).upper() == look[fill].colour
            assert line.get_marker() == look[fill].marker
    (legend,) = result.figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["lin", "cubic", "akima"]


def test_methods_stand_along_x_where_there_is_one_group() -> None:
    result = compared(within=())
    (axis,) = result.figure.axes
    assert [text.get_text() for text in axis.get_xticklabels()] == ["lin", "cubic", "akima"]
    assert [np.asarray(value.lines[0].get_xdata()).item() for value in points(axis).values()] == [
        0,
        1,
        2,
    ]


def test_a_wide_span_gets_a_logarithmic_scale() -> None:
    assert compared(within=("length",)).figure.axes[0].get_yscale() == "linear"
    assert compared(within=("length",), scale=10).figure.axes[0].get_yscale() == "log"


def test_a_method_without_a_value_is_in_the_legend() -> None:
    tables = {
        name: pd.DataFrame({"gap": [0, 1], "side": ["l", "l"], "rmse": values})
        for name, values in {"lin": [1.0, 2.0], "pca": [np.nan, np.nan]}.items()
    }
    with pytest.warns(UserWarning, match="not compared: pca"):
        result = table(Across.of(tables, axis="fill"), within=("side",))
    (legend,) = result.figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["lin", "pca (no value)"]


@pytest.mark.parametrize("within", [(), ("length",), ("take", "length")])
def test_the_figure_can_be_written(within: tuple[str, ...]) -> None:
    buffer = io.BytesIO()
    compared(within=within).figure.savefig(buffer, format="svg")
    assert buffer.getvalue().lstrip().startswith(b"<?xml")


def of_labels(labels: list[str], groups: int = 1) -> Compared:
    random = np.random.default_rng(0)
    tables = {
        label: pd.DataFrame(
            {
                "gap": np.repeat(range(groups), 4),
                "take": [*range(4)] * groups,
                "rmse": random.uniform(1, 2, size=4 * groups),
            }
        )
        for label in labels
    }
    within = ("gap",) if groups > 1 else ()
    return table(Across.of(tables, axis="fill"), metric="rmse", within=within, blocks=("take",))


def test_labels_are_drawn_as_they_are() -> None:
    result = of_labels(["a $x$", "_under", "<b>"], groups=2)
    (legend,) = result.figure.legends
    assert [text.get_text() for text in legend.get_texts()] == [r"a \$x\$", "\u200b_under", "<b>"]
    result.figure.savefig(io.BytesIO(), format="svg")


def test_of_many_places_along_x_some_are_named() -> None:
    (axis,) = of_labels(["a", "b"], groups=300).figure.axes
    ticks = [text.get_text() for text in axis.get_xticklabels()]
    assert ticks[:3] == ["0", "8", "16"]
    assert len(ticks) <= 40


def test_of_many_methods_some_are_named() -> None:
    (legend,) = of_labels([f"m{place}" for place in range(60)], groups=2).figure.legends
    texts = [text.get_text() for text in legend.get_texts()]
    assert len(texts) == 40
    assert texts[-1] == "m39, and 20 more"


def test_of_many_panels_some_are_drawn_and_the_rest_told() -> None:
    rows = pd.DataFrame({"a": np.repeat(range(30), 4), "b": [0, 0, 1, 1] * 30, "gap": [0, 1] * 60})
    tables = {name: rows.assign(rmse=np.arange(120.0) + 1) for name in ("x", "y")}
    result = table(Across.of(tables, axis="fill"), within=("a", "b"), blocks=("gap",))
    assert len(result.figure.axes) == 24
    assert result.figure.get_supxlabel() == "6 more panels are not drawn"


def test_an_end_that_is_not_finite_leaves_the_points_in_sight() -> None:
    nan, inf = np.full(2, np.nan), np.full(2, np.inf)
    mean = np.array([1.0, 2.0])
    assert reach(mean, nan, inf).tolist() == [[0.0, 0.0], [0.0, 0.0]]
    assert reach(mean, mean - 0.5, mean + 0.25).tolist() == [[0.5, 0.5], [0.25, 0.25]]


def test_methods_of_which_one_is_always_zero_are_all_in_sight() -> None:
    tables = {"without": [0.0] * 8, "rare": [0.0] * 7 + [0.02], "other": [0.3, 0.4] * 4}
    scores = {
        name: pd.DataFrame({"gap": range(8), "rmse": number}) for name, number in tables.items()
    }
    result = table(Across.of(scores, axis="fill"))
    (axis,) = result.figure.axes
    low, high = axis.get_ylim()
    assert low <= 0.0
    assert 0.35 < high < 2.0

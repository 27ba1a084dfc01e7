"""Every row of the tables is a point, and none that cannot be drawn goes unsaid."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure as MatplotlibFigure
from pandas import DataFrame

from nodegraph import Across
from nodegraph_mocap import Table
from nodegraph_plot.scatter import scatter
from nodegraph_tables import TableInfo, with_info
from nodegraph_tables.figures import store_figure


def scores(**columns: object) -> Across[Table]:
    """Return tables of two methods, the second with errors twice as large."""
    frame = {"gap": [0, 1, 2], "length": [5, 15, 45], "rmse": [0.1, 0.4, 0.9], **columns}
    first, second = DataFrame(frame), DataFrame(frame)
    second["rmse"] = 2 * second["rmse"]
    info = TableInfo(units={"length": "frames", "rmse": "mm"})
    tables = {"linear": with_info(first, info), "muscle": with_info(second, info)}
    return Across.of(tables, axis="fill")


def points(figure: MatplotlibFigure) -> dict[str, Any]:
    return {
        str(artist.get_label()): np.asarray(artist.get_offsets())
        for artist in figure.axes[0].collections
    }


def test_each_row_is_a_point_of_its_methods_colour() -> None:
    figure = scatter(scores(), x="length")
    drawn = points(figure)
    assert drawn["linear"] == pytest.approx(np.array([[5, 0.1], [15, 0.4], [45, 0.9]]))
    assert drawn["muscle"][:, 1] == pytest.approx([0.2, 0.8, 1.8])
    axis = figure.axes[0]
    assert (axis.get_xlabel(), axis.get_ylabel()) == ("length (frames)", "rmse (mm)")
    colours = {str(np.asarray(artist.get_facecolor())) for artist in axis.collections}
    assert len(colours) == 2


def test_an_axis_of_numbers_may_be_drawn_to_the_right() -> None:
    table = DataFrame({"rmse": [1.0, 2.0]})
    both = Across(("length",), (({"length": 5}, table), ({"length": 45}, table)))
    assert points(scatter(both, x="length"))["5"][:, 0].tolist() == [5, 5]
    named = Across(("fill",), (({"fill": "linear"}, table),))
    with pytest.raises(ValueError, match="'fill' has the label 'linear', which is not a number"):
        scatter(named, x="fill")


def test_rows_without_a_number_are_counted() -> None:
    with pytest.warns(UserWarning, match="left out: linear 1 of 3, muscle 1 of 3"):
        drawn = points(scatter(scores(rmse=[0.1, np.nan, 0.9]), x="length"))
    assert len(drawn["linear"]) == 2


def test_a_wide_range_of_positive_numbers_is_logarithmic() -> None:
    axis = scatter(scores(rmse=[0.001, 1.0, 2.0]), x="length").axes[0]
    assert (axis.get_xscale(), axis.get_yscale()) == ("linear", "log")
    axis = scatter(scores(rmse=[0.0, 1.0, 2.0]), x="length").axes[0]
    assert axis.get_yscale() == "linear"


def test_names_that_are_not_there_are_reported_with_what_is() -> None:
    with pytest.raises(ValueError, match="no column or axis 'speed'; there are the columns gap"):
        scatter(scores(), x="speed")
    with pytest.raises(ValueError, match="column 'take' holds no numbers"):
        scatter(scores(take=["a", "b", "c"]), x="take")
    with pytest.raises(ValueError, match="no axis 'trial' is gathered; there are fill"):
        scatter(scores(), x="length", compare="trial")
    with pytest.raises(ValueError, match="there is no table to draw"):
        scatter(Across((), ()), x="length")
    with pytest.raises(ValueError, match="no column of floats; it has n"):
        scatter(Across.of({"a": DataFrame({"n": [1]})}, axis="fill"), x="n")


def test_names_of_columns_and_units_are_drawn_as_text() -> None:
    table = DataFrame({r"$\frac$": [1.0, 2.0], "_n": [1.0, 2.0]})
    table = with_info(table, TableInfo(units={"_n": "$"}))
    figure = scatter(Across.of({"a": table}, axis="fill"), x="_n", metric=r"$\frac$")
    drawn = store_figure(figure).svg.decode()
    assert r">$\frac$<" in drawn
    assert "_n ($)<" in drawn


def test_no_row_and_no_number_are_an_empty_figure() -> None:
    empty = DataFrame({"n": np.zeros(0), "rmse": np.zeros(0)})
    assert len(points(scatter(Across.of({"a": empty}, axis="fill"), x="n"))["a"]) == 0
    nowhere = DataFrame({"n": [1.0], "rmse": [np.nan]})
    with pytest.warns(UserWarning, match="left out: a 1 of 1"):
        figure = scatter(Across.of({"a": nowhere}, axis="fill"), x="n", metric="rmse")
    assert store_figure(figure).pdf

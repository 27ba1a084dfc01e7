from __future__ import annotations

import re

import numpy as np
import pandas as pd

from nodegraph_tables.cells import columns_of
from nodegraph_tables.renderers import render_table


def test_an_interval_and_a_p_stand_in_the_cell_of_their_mean_and_the_best_is_marked() -> None:
    table = pd.DataFrame(
        {
            "marker": ["a", "b"],
            "x": [0.5, 2.0],
            "x low": [0.25, np.nan],
            "x high": [0.75, np.nan],
            "x p": [0.01, 0.5],
        }
    )
    table.attrs["cells"] = {"x": {"low": "x low", "high": "x high", "p": "x p"}}
    table.attrs["best"] = {"x": [0]}
    made = render_table(table, "t")
    assert "<strong>0.500</strong> <br><small>[0.250, 0.750] \N{DAGGER}</small>" in made.html
    assert '<td class="number" data-within=",,0.5">2.000</td>' in made.html
    assert 'data-value="0.5" data-within="0.25,0.75,0.01"' in made.html
    assert made.text.splitlines()[1].split() == [
        "a",
        "0.500",
        "[0.250,",
        "0.750]",
        "\N{DAGGER}*",
    ]
    assert r"\textbf{0.500} {[}0.250, 0.750] \textdagger{}" in made.files[".tex"].decode()
    assert "x low" not in re.sub(r'data-names="[^"]*"', "", made.html)
    assert made.files[".csv"].decode().splitlines()[:2] == [
        "marker,x,x low,x high,x p",
        "a,0.5,0.25,0.75,0.01",
    ]


def test_a_mean_without_an_interval_stands_alone() -> None:
    table = pd.DataFrame({"x": [np.nan, 1.5], "low": [np.nan, 1.25], "high": [np.nan, np.nan]})
    table.attrs["cells"] = {"x": {"low": "low", "high": "high"}}
    assert render_table(table, "t").text.split() == ["x", "1.50"]


def test_the_points_of_a_column_meet_and_tiny_numbers_have_a_power_of_ten() -> None:
    table = pd.DataFrame(
        {"small": [0.0359, 1.134, 0.0], "wide": [213.0, 30.0, 3.5e-31], "whole": [2.0, 5.0, 1e5]}
    )
    columns = {one.name: [str(cell) for cell in one.cells] for one in columns_of(table)}
    assert columns == {
        "small": ["0.0359", "1.1340", "0"],
        "wide": ["213.0", "30.0", "3.50e-31"],
        "whole": ["2", "5", "100000"],
    }


def test_labels_stand_as_the_graph_has_them_head_their_rows_and_part_the_groups() -> None:
    table = pd.DataFrame({"share": [0.02, 0.02, 0.1], "method": ["a", "b", "a"], "x": [1.5, 2, 3]})
    table.attrs.update(labels=["share", "method"], units={"x": "mm^2"})
    html = render_table(table, "t").html
    assert html.count('<th scope="row" class="number">0.02</th>') == 2
    assert '<tr class="group"><th scope="row" class="number">0.1</th>' in html
    assert html.count('class="group"') == 1
    assert '<th scope="row" class="name short">b</th>' in html
    assert '<span class="unit"> [mm\N{SUPERSCRIPT TWO}]</span>' in html
    assert r"x {[}mm\textsuperscript{2}]" in render_table(table, "t").files[".tex"].decode()


def test_what_is_not_finite_is_said_and_what_is_missing_left_empty() -> None:
    table = pd.DataFrame({"x": [np.inf, -np.inf, np.nan, 0.5], "y": [np.nan] * 4})
    x, y = columns_of(table)
    assert [str(cell) for cell in x.cells] == ["inf", "-inf", "", "0.500"]
    assert [str(cell) for cell in y.cells] == [""] * 4

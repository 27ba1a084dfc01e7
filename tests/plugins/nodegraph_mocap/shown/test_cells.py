from __future__ import annotations

import numpy as np
import pandas as pd

from nodegraph_mocap.shown.renderers import render_table


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
    assert "<strong>0.5000</strong> <br><small>[0.2500, 0.7500] \N{DAGGER}</small>" in made.html
    assert '<td class="number">2</td>' in made.html
    assert made.text.splitlines()[1].split() == [
        "a",
        "0.5000",
        "[0.2500,",
        "0.7500]",
        "\N{DAGGER}*",
    ]
    assert r"\textbf{0.5000} {[}0.2500, 0.7500] \textdagger{}" in made.files[".tex"].decode()
    assert "x low" not in made.html
    assert made.files[".csv"].decode().splitlines()[:2] == [
        "marker,x,x low,x high,x p",
        "a,0.5,0.25,0.75,0.01",
    ]


def test_a_mean_without_an_interval_stands_alone() -> None:
    table = pd.DataFrame({"x": [np.nan, 1.5], "low": [np.nan, 1.25], "high": [np.nan, np.nan]})
    table.attrs["cells"] = {"x": {"low": "low", "high": "high"}}
    assert render_table(table, "t").text.split() == ["x", "1.500"]

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.colors import to_hex
from matplotlib.figure import Figure as MatplotlibFigure

from nodegraph import Across, Label
from nodegraph_compare.curve.node import curve
from nodegraph_mocap import Table
from nodegraph_tables.style import BLACK, REST

ACTORS = ("ME", "MB", "JZ")
SEARCHES = ((5, 9, 0.5), (10, 9, 0.4), (15, 11, 0.1), (20, 13, 0.3))


def scores(scale: float = 1.0, actors: tuple[str, ...] = ACTORS) -> Across[Table]:
    entries: list[tuple[dict[str, Label], Table]] = [
        (
            {"actor": actor, "k": k},
            pd.DataFrame({"markers": [markers], "mse": [mse * scale**place]}),
        )
        for place, actor in enumerate(actors)
        for k, markers, mse in SEARCHES
    ]
    return Across(("actor", "k"), tuple(entries))


def figure(scores: Across[Table], floor: Any = None, **settings: Any) -> Any:
    return curve(scores, floor, x="markers", metric="mse", compare="actor", **settings).figure


def foreground(axis: Axes) -> Any:
    """Return the line of the curve that a panel is about."""
    (line,) = (
        line
        for line in axis.lines
        if to_hex(line.get_color()) == BLACK and line.get_marker() == "o"
    )
    return line


def caption(figure: MatplotlibFigure) -> str:
    return str(figure.get_supxlabel())


def test_a_panel_has_its_curve_before_the_others_and_every_other_point() -> None:
    drawn = figure(scores())
    assert [axis.get_title("left") for axis in drawn.axes] == list(ACTORS)
    for axis in drawn.axes:
        path = np.column_stack(foreground(axis).get_data()).tolist()
        assert path == [[9, 0.4], [11, 0.1], [13, 0.3]]
        off = next(each for each in axis.collections if isinstance(each, PathCollection))
        assert np.asarray(off.get_offsets()).tolist() == [[9, 0.5]]
        assert sum(to_hex(line.get_color()) == REST for line in axis.lines) == 2
    assert "Hollow" in caption(drawn)


def test_a_circle_stands_around_what_is_shared_and_a_square_around_a_knee() -> None:
    drawn = figure(scores(), mark="shared")
    rings = [line for axis in drawn.axes for line in axis.lines if line.get_markersize() > 10]
    assert [np.ravel(ring.get_data()).tolist() for ring in rings] == [[11, 0.1]] * 3
    assert {ring.get_marker() for ring in rings} == {"o"}
    falling = Across(
        ("actor", "k"),
        tuple((at, table.assign(mse=1 / table["markers"])) for at, table in scores()),
    )
    drawn = figure(falling, mark="shared")
    rings = [line for axis in drawn.axes for line in axis.lines if line.get_markersize() > 10]
    assert {ring.get_marker() for ring in rings} == {"s"}
    assert drawn.get_suptitle() == "no minimum shared within 2 markers"
    assert [text.get_text() for text in drawn.axes[0].texts] == ["knee 11"]


@pytest.mark.parametrize("common", [False, True])
def test_what_noise_does_is_shaded(common: bool) -> None:
    levels = {
        actor: pd.DataFrame({"mse": [0.2 + 0.1 * place]}) for place, actor in enumerate(ACTORS)
    }
    floor = Across((), (({}, levels["ME"]),)) if common else Across.of(levels, axis="actor")
    drawn = figure(scores(), floor)
    tops = [axis.patches[0].get_y() + axis.patches[0].get_height() for axis in drawn.axes]
    assert tops == pytest.approx([0.2] * 3 if common else [0.2, 0.3, 0.4])
    assert "noise" in caption(drawn)


def test_intervals_are_those_of_the_table() -> None:
    random = np.random.default_rng(0)
    entries: list[tuple[dict[str, Label], Table]] = [
        ({"trial": trial, "length": length}, pd.DataFrame({"rmse": random.uniform(size=3)}))
        for trial in range(6)
        for length in (5, 45)
    ]
    result = curve(Across(("trial", "length"), tuple(entries)), x="length", blocks=("trial",))
    (axis,) = result.figure.axes
    container: Any = axis.containers[0]
    ends = np.array([line[:, 1] for line in container.lines[2][0].get_segments()])
    assert ends == pytest.approx(result.table[["low", "high"]].to_numpy())


def test_the_scale_is_logarithmic_where_values_span_much_and_nothing_falls_off_it() -> None:
    assert figure(scores()).axes[0].get_yscale() == "linear"
    assert figure(scores(10.0)).axes[0].get_yscale() == "log"
    zero = Across(
        ("actor", "k"),
        tuple((at, t.assign(mse=t["mse"] * (at["k"] != 20))) for at, t in scores(10.0)),
    )
    drawn = figure(zero)
    assert drawn.axes[0].get_yscale() == "log"
    assert "3 on the lower edge" in caption(drawn)
    for axis in drawn.axes:
        assert foreground(axis).get_ydata()[-1] == pytest.approx(axis.get_ylim()[0])


def test_equal_inputs_draw_equal_files() -> None:
    files = []
    for _ in range(2):
        file = io.BytesIO()
        figure(scores(), mark="shared").savefig(file, format="png")
        files.append(file.getvalue())
    assert files[0] == files[1]


def test_intervals_are_in_sight() -> None:
    random = np.random.default_rng(0)
    entries = tuple(
        (
            {"actor": "ME", "k": k},
            pd.DataFrame({"markers": k, "unit": range(4), "mse": random.uniform(1, 4, 4)}),
        )
        for k in (5, 10, 15)
    )
    result = curve(
        Across(("actor", "k"), entries),
        x="markers",
        metric="mse",
        compare="actor",
        blocks=("unit",),
        clusters=("unit",),
    )
    (axis,) = result.figure.axes
    assert axis.get_ylim()[1] > result.table["high"].max() > 1.05 * result.table["mse"].max()


def test_of_many_curves_some_are_drawn_and_the_rest_counted() -> None:
    drawn = figure(scores(actors=tuple(f"actor {place}" for place in range(30))))
    assert len(drawn.axes) == 24
    assert "6 more curves are not drawn" in caption(drawn)

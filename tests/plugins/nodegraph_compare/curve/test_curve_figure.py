from __future__ import annotations

import io
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.collections import PathCollection
from matplotlib.colors import to_hex

from nodegraph import Across
from nodegraph_compare.curve.node import curve
from nodegraph_tables.style import MARKERS, looks

ACTORS = ("ME", "MB", "JZ")
SEARCHES = ((5, 9, 0.5), (10, 9, 0.4), (15, 11, 0.1), (20, 13, 0.3))


def scores(scale: float = 1.0, actors: tuple[str, ...] = ACTORS) -> Any:
    entries: list[Any] = [
        (
            {"actor": actor, "k": k},
            pd.DataFrame({"markers": [markers], "mse": [mse * scale**place]}),
        )
        for place, actor in enumerate(actors)
        for k, markers, mse in SEARCHES
    ]
    return Across(("actor", "k"), tuple(entries))


def figure(scores: Any, floor: Any = None, **settings: Any) -> Any:
    return curve(scores, floor, x="markers", metric="mse", compare="actor", **settings).figure


def curves(axis: Any) -> list[Any]:
    return [
        line for line in axis.lines if line.get_marker() in MARKERS and line.get_linestyle() == "-"
    ]


def test_the_curve_goes_through_the_lowest_and_every_other_point_is_there() -> None:
    (axis,) = figure(scores()).axes
    look = looks(ACTORS)
    off = [axis for axis in axis.collections if isinstance(axis, PathCollection)]
    for actor, line, points in zip(ACTORS, curves(axis), off, strict=True):
        assert np.column_stack(line.get_data()).tolist() == [[9, 0.4], [11, 0.1], [13, 0.3]]
        assert to_hex(line.get_color()).upper() == look[actor].colour
        assert np.asarray(points.get_offsets()).tolist() == [[9, 0.5]]
    names = [text.get_text() for text in axis.figure.legends[0].get_texts()]
    assert names == list(ACTORS)


def test_a_circle_stands_around_what_is_shared_and_a_square_around_a_knee() -> None:
    (axis,) = figure(scores(), mark="shared").axes
    rings = [line for line in axis.lines if line.get_markersize() > 10]
    assert [np.ravel(ring.get_data()).tolist() for ring in rings] == [[11, 0.1]] * 3
    assert {(ring.get_marker(), ring.get_markeredgecolor()) for ring in rings} == {("o", "#000000")}
    falling = Across(
        ("actor", "k"),
        tuple((at, table.assign(mse=1 / table["markers"])) for at, table in scores()),
    )
    (axis,) = figure(falling, mark="shared").axes
    rings = [line for line in axis.lines if line.get_markersize() > 10]
    assert {ring.get_marker() for ring in rings} == {"s"}
    assert axis.get_title() == "no minimum shared within 2 markers"


def test_each_label_has_its_dashed_floor() -> None:
    levels = {actor: pd.DataFrame({"mse": [0.1 * place]}) for place, actor in enumerate(ACTORS)}
    (axis,) = figure(scores(), Across.of(levels, axis="actor")).axes
    look = looks(ACTORS)
    heights = {
        to_hex(line.get_color()).upper(): line.get_ydata()[0]
        for line in axis.lines
        if list(line.get_xdata()) == [0, 1]
    }
    assert heights == {look[actor].colour: 0.1 * place for place, actor in enumerate(ACTORS)}
    names = [text.get_text() for text in axis.figure.legends[0].get_texts()]
    assert names[3:] == [f"noise floor {actor}" for actor in ACTORS]


def test_one_floor_for_all_is_drawn_once() -> None:
    common = Across((), (({}, pd.DataFrame({"mse": [0.2]})),))
    (axis,) = figure(scores(), common).axes
    floors = [line for line in axis.lines if list(line.get_xdata()) == [0, 1]]
    assert [(line.get_ydata()[0], line.get_color()) for line in floors] == [(0.2, "#000000")]
    names = [text.get_text() for text in axis.figure.legends[0].get_texts()]
    assert names[3:] == ["noise floor"]


def test_intervals_are_those_of_the_table() -> None:
    random = np.random.default_rng(0)
    entries: list[Any] = [
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
    (axis,) = figure(scores(10.0)).axes
    assert axis.get_yscale() == "log"
    zero = Across(
        ("actor", "k"),
        tuple((at, t.assign(mse=t["mse"] * (at["k"] != 20))) for at, t in scores(10.0)),
    )
    (axis,) = figure(zero).axes
    assert axis.get_yscale() == "log"
    assert [text.get_text() for text in axis.texts] == [
        "3 on the lower edge: 0 or lower than shown"
    ]
    low = axis.get_ylim()[0]
    assert [line.get_ydata()[-1] for line in curves(axis)] == pytest.approx([low] * 3)


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

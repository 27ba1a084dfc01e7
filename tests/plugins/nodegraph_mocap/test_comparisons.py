"""Recordings are told apart by frames and markers, tables by rows and columns."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from pandas import DataFrame

from nodegraph.plugin.registry import default_registry
from nodegraph.runs.compare import value_differences
from nodegraph_mocap import Mask, Origin, StoredFigure, Trajectories, Weights

MARKERS = ("brow", "nose", "chin")
TAKE = Trajectories(positions=np.zeros((20, 3, 3)), markers=MARKERS, rate=60.0)


def differences(first: object, other: object) -> tuple[str, ...]:
    return value_differences(first, other, default_registry().hooks)


def moved(frames: slice, marker: int, by: float) -> Trajectories:
    positions = TAKE.positions.copy()
    positions[frames, marker, 0] += by
    positions[frames.start, marker, 0] += by
    return replace(TAKE, positions=positions)


def test_what_is_the_same_is_not_reported() -> None:
    table = DataFrame({"a": [1.0, np.nan], "b": ["x", None]})
    assert differences(TAKE, replace(TAKE)) == differences(table, table.copy()) == ()


def test_moved_samples_have_frames_markers_and_millimetres() -> None:
    assert differences(TAKE, moved(slice(4, 9), 2, 0.25)) == (
        "5 samples (frames 4 to 8; chin) moved, by up to 0.5 mm (frame 4, chin)",
    )


def test_the_order_of_markers_alone_moves_nothing() -> None:
    assert differences(TAKE, TAKE.keep(MARKERS[::-1])) == ("markers in another order",)


def test_missing_samples_and_origins_are_reported() -> None:
    hole = TAKE.positions.copy()
    hole[3, 1] = np.nan
    assert differences(TAKE, Trajectories(positions=hole, markers=MARKERS, rate=60.0))[0] == (
        "1 sample (frame 3; nose) present in one and missing in the other"
    )
    origin = TAKE.origin.copy()
    origin[:2] = Origin.FILLED
    assert differences(TAKE, replace(TAKE, origin=origin)) == (
        "6 samples (frames 0 to 1; brow, nose, chin) of another origin",
    )


def test_other_lengths_rates_and_markers_are_reported() -> None:
    shorter = Trajectories(positions=TAKE.positions[:5], markers=MARKERS, rate=30.0)
    assert differences(TAKE, shorter) == ("rate was 60 Hz, now 30 Hz", "had 20 frames, now 5")
    assert differences(TAKE, TAKE.keep(["nose", "chin"])) == ("markers only before: brow",)


def test_what_the_words_do_not_reach_is_compared_part_by_part() -> None:
    with_sigma = replace(TAKE, sigma=np.ones((20, 3)))
    assert differences(TAKE, with_sigma) == ("value.sigma: NoneType and ndarray",)


@pytest.mark.parametrize(
    ("other", "message"),
    [
        ({"rmse": [1.0, 2.5, np.nan]}, "rmse: row 1: 2, now 2.5"),
        ({"rmse": [1.0, np.nan, 3.0]}, "rmse: 2 of 3 rows, the first in 1: 2, now missing"),
        (
            {"rmse": [1.25, 2.5, np.nan]},
            "rmse: 2 of 3 rows, the most in 1: 2, now 2.5",
        ),
        ({"rmse": [1.0, 2.0]}, "had 3 rows, now 2"),
        ({"error": [1.0, 2.0, np.nan]}, "columns only before: rmse"),
    ],
)
def test_tables_have_columns_rows_and_sizes(other: dict[str, object], message: str) -> None:
    assert differences(DataFrame({"rmse": [1.0, 2.0, np.nan]}), DataFrame(other))[0] == message


def test_a_table_of_texts_and_its_columns() -> None:
    table = DataFrame({"take": ["a", "b"], "n": [1, 2]})
    assert differences(table, DataFrame({"take": ["a", "c"], "n": [1, 2]})) == (
        "rows only before: take=b",
        "rows only now: take=c",
    )
    assert differences(table, table[["n", "take"]])[0] == "columns in another order"


def test_rows_are_compared_by_their_names() -> None:
    table = DataFrame({"fill": ["a", "a", "b"], "k": [1, 2, 1], "rmse": [1.0, 2.0, 3.0]})
    other = DataFrame({"fill": ["b", "a", "c"], "k": [1, 2, 1], "rmse": [3.5, 2.0, 9.0]})
    assert differences(table, other) == (
        "rows only before: fill=a k=1",
        "rows only now: fill=c k=1",
        "rmse: row fill=b k=1: 3, now 3.5",
    )


def test_a_row_over_all_labels_has_no_missing_name() -> None:
    table = DataFrame(
        {"length": pd.array([5, pd.NA], "Int64"), "fill": ["a", "a"], "n": [1.0, 2.0]}
    )
    other = DataFrame(
        {"length": pd.array([5, pd.NA], "Int64"), "fill": ["a", "b"], "n": [1.0, 2.0]}
    )
    assert differences(table, other) == ("fill: row all: a, now b",)


def test_masks_and_drawings() -> None:
    mask = Mask(hidden=np.zeros((4, 3), bool), markers=MARKERS)
    hidden = mask.hidden.copy()
    hidden[2, 0] = True
    assert differences(mask, replace(mask, hidden=hidden)) == (
        "1 sample (frame 2; brow) in one mask only",
    )
    drawn = StoredFigure(b"<svg/>", b"")
    assert differences(drawn, StoredFigure(b"<svg></svg>", b"")) == ("the drawing is another",)


def test_weights_are_distinguished_by_frames_and_shapes() -> None:
    values = np.zeros((20, 2))
    weights = Weights(values=values, names=("jawOpen", "smile"), rate=60.0)
    other = values.copy()
    other[3:5, 1] = 0.25, 0.5
    assert differences(weights, replace(weights, values=other)) == (
        "2 samples (frames 3 to 4; smile) of another weight, by up to 0.5 (frame 4, smile)",
    )
    assert differences(
        weights, Weights(values=values[:5], names=("jawOpen", "frown"), rate=60.0)
    ) == (
        "shapes only before: smile",
        "shapes only now: frown",
        "had 20 frames, now 5",
    )

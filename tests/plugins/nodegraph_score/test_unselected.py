"""Errors at the markers that were left out, beside plain loops."""

from __future__ import annotations

import math

import numpy as np
import pytest

from nodegraph_mocap import Origin, Selection, Trajectories
from nodegraph_score.unselected import UNITS, unselected
from nodegraph_tables import info_of

COLUMNS = ["marker", "markers", "frames", "missing", "rms", "mean", "max", "farthest"]
CHOSEN = Selection(chosen=("d", "a"))


def recording(markers: str = "abcdef", *, frames: int = 12, seed: int = 0) -> Trajectories:
    positions = np.random.default_rng(seed).normal(0, 20, (frames, len(markers), 3))
    return Trajectories(positions=positions, markers=tuple(markers), rate=60.0)


def cut(take: Trajectories, marker: str, frames: slice) -> Trajectories:
    gap = np.zeros(take.origin.shape, bool)
    gap[frames, take.markers.index(marker)] = True
    positions = np.where(gap[..., None], np.nan, take.positions)
    return take.with_samples(positions, changed=gap, origin=Origin.MISSING)


def test_every_number_by_a_plain_loop() -> None:
    reference = recording()
    estimate = cut(cut(recording(seed=1), "c", slice(2, 5)), "f", slice(0, 1))
    with pytest.warns(UserWarning, match="^4 of 48 samples are missing and not compared$"):
        table = unselected(estimate, reference, CHOSEN)
    assert list(table.columns) == COLUMNS
    assert table["marker"].tolist() == ["b", "c", "e", "f"]
    for _, row in table.iterrows():
        place = reference.markers.index(row["marker"])
        apart = {
            frame: math.dist(estimate.positions[frame, place], reference.positions[frame, place])
            for frame in range(12)
            if not np.isnan(estimate.positions[frame, place, 0])
        }
        assert row["markers"] == 2
        assert row["frames"] == len(apart)
        assert row["missing"] == 12 - len(apart)
        assert row["rms"] == pytest.approx(
            math.sqrt(sum(far**2 for far in apart.values()) / len(apart))
        )
        assert row["mean"] == pytest.approx(sum(apart.values()) / len(apart))
        assert row["max"] == pytest.approx(max(apart.values()))
        assert row["farthest"] == max(apart, key=lambda frame: apart[frame])
    assert info_of(table).units == UNITS
    assert list(info_of(table).notes) == ["4 of 48 samples are missing and not compared."]


def test_what_only_one_of_the_two_has_is_left_out_and_reported() -> None:
    reference, estimate = recording("abcde"), recording("abdefgh", seed=1)
    with pytest.warns(UserWarning, match="markers only the") as caught:
        table = unselected(estimate, reference, CHOSEN)
    assert [str(warning.message) for warning in caught] == [
        "3 markers only the estimate has are left out: f, g, h",
        "1 markers only the reference has are left out: c",
    ]
    assert table["marker"].tolist() == ["b", "e"]


def test_a_marker_without_any_frame_has_no_error() -> None:
    estimate = cut(recording(seed=1), "b", slice(None))
    with pytest.warns(UserWarning, match="12 of 48 .*; 1 of 4 markers have none at all"):
        table = unselected(estimate, recording(), CHOSEN)
    assert [table[value][0] for value in ("frames", "missing", "farthest")] == [0, 12, -1]
    assert np.isnan(table[["rms", "mean", "max"]].to_numpy()).sum(axis=1).tolist() == [3, 0, 0, 0]


def test_where_all_are_selected_no_row_is_left() -> None:
    take = recording("ab")
    with pytest.warns(UserWarning, match="all 2 markers are selected, none is left to score"):
        table = unselected(take, take, Selection(chosen=("a", "b")))
    assert list(table.columns) == COLUMNS
    assert len(table) == 0


def test_a_selected_marker_that_the_reference_lacks_is_named() -> None:
    with pytest.raises(ValueError, match="selected, but not in the reference: x; it has a, b"):
        unselected(recording(), recording(), Selection(chosen=("a", "x")))

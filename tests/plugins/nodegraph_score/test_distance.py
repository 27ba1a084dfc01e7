"""Distances are those of markers of one name, and their sum is the one of the worked example."""

from __future__ import annotations

import math
import tracemalloc
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.typing import NDArray

from nodegraph_mocap import Trajectories
from nodegraph_score.distance import distance
from nodegraph_score.roughness import roughness
from nodegraph_tables import info_of
from tests.plugins.recordings import quietly

NUMBERS = ["sum of squares", "rms", "mean", "max"]


def recording(frames: int = 12, markers: int = 4, *, seed: int = 0) -> Trajectories:
    positions = np.random.default_rng(seed).normal(0, 20, (frames, markers, 3))
    names = tuple("abcdefgh"[:markers])
    return Trajectories(positions=positions, markers=names, rate=60.0)


def without(take: Trajectories, missing: NDArray[np.bool_]) -> Trajectories:
    positions = np.where(missing[..., None], np.nan, take.positions)
    return Trajectories(positions=positions, markers=take.markers, rate=take.rate)


@given(
    missing=arrays.arrays(np.bool_, (2, 5, 4)),
    one_frame=st.booleans(),
    seed=st.integers(0, 99),
)
def test_every_number_is_the_documented_formula(
    missing: NDArray[np.bool_], one_frame: bool, seed: int
) -> None:
    estimate = without(recording(5, seed=seed), missing[0])
    reference = without(recording(5, seed=seed + 100), missing[1])
    if one_frame:
        reference = without(recording(1, seed=seed + 100), missing[1, :1])
    table = quietly(distance, estimate, reference)
    assert table["frame"].tolist() == list(range(5))
    for frame, row in enumerate(table.to_dict("records")):
        apart = {}
        for column, name in enumerate("abcd"):
            here, there = estimate.positions, reference.positions
            p, q = here[frame, column], there[0 if one_frame else frame, column]
            if not (np.isnan(p).any() or np.isnan(q).any()):
                apart[name] = math.dist(p, q)
        assert row["markers"] == len(apart)
        assert row["missing"] == 4 - len(apart)
        if not apart:
            assert all(np.isnan(row[name]) for name in NUMBERS)
            assert row["farthest"] == ""
            continue
        assert row["sum of squares"] == pytest.approx(sum(value**2 for value in apart.values()))
        assert row["rms"] == pytest.approx(
            math.sqrt(sum(value**2 for value in apart.values()) / len(apart))
        )
        assert row["mean"] == pytest.approx(sum(apart.values()) / len(apart))
        assert row["max"] == pytest.approx(max(apart.values()))
        assert row["farthest"] == max(apart, key=lambda name: apart[name])


def test_markers_of_one_side_only_are_named() -> None:
    estimate, reference = recording().keep("abc"), recording(seed=1).keep("bcd")
    with pytest.warns(UserWarning, match="are left out") as caught:
        table = distance(estimate, reference)
    messages = [
        "1 markers only the estimate has are left out: a",
        "1 markers only the reference has are left out: d",
    ]
    assert [str(warning.message) for warning in caught] == messages
    assert list(info_of(table).notes) == [f"{text}." for text in messages]
    assert (table["markers"] == 2).all()
    assert (table["missing"] == 0).all()


def test_missing_samples_are_counted() -> None:
    missing = np.zeros((12, 4), dtype=np.bool_)
    missing[3, 1:3] = True
    missing[7] = True
    with pytest.warns(
        UserWarning, match="6 of 48 samples are missing .*; 1 of 12 frames have none"
    ):
        table = distance(without(recording(), missing), recording(seed=1))
    assert table["missing"].sum() == 6
    assert table["markers"][[3, 7]].tolist() == [2, 0]


@pytest.mark.parametrize(("frames", "others"), [(12, 11), (1, 12), (12, 2), (0, 3)])
def test_other_frame_counts_are_refused(frames: int, others: int) -> None:
    with pytest.raises(ValueError, match=f"{frames} frames, the reference {others}: it must have"):
        distance(recording(frames), recording(others))


def test_a_distance_beyond_all_numbers_is_refused() -> None:
    far = replace(recording(), positions=1e200 * recording().positions)
    with pytest.raises(ValueError, match="too large"):
        distance(far, recording())


@pytest.mark.parametrize("score", [lambda take: distance(take, take), roughness])
def test_the_memory_of_a_score_is_a_part_of_its_recordings(
    score: Callable[[Trajectories], object],
) -> None:
    positions = np.random.default_rng(0).normal(size=(30_000, 32, 3))
    long = Trajectories(positions=positions, markers=tuple(map(str, range(32))), rate=120.0)
    score(long)
    tracemalloc.start()
    score(long)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 1.5 * positions.nbytes


def test_shapes_that_were_scaled_have_no_millimetres() -> None:
    one, other = recording(), recording(seed=1)
    bare, in_mm = distance(one, other, unit="none"), distance(one, other)
    assert bare.equals(in_mm)
    assert info_of(in_mm).units["sum of squares"] == "mm^2"
    assert info_of(bare).units == {"frame": "frame", "markers": "markers", "missing": "markers"}

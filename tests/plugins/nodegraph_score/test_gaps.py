from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_mocap import Mask, Trajectories
from nodegraph_score.gaps import gaps
from nodegraph_tables import info_of

NAMES = ("brow", "cheek", "chin")
ERRORS = ["rmse", "mae", "coordinate mae", "max", "jump", "velocity", "acceleration"]


def recording(seed: int, frames: int = 20) -> Trajectories:
    positions = np.random.default_rng(seed).normal(size=(frames, len(NAMES), 3))
    return Trajectories(positions=positions, markers=NAMES, rate=60.0)


def mask(*runs: tuple[int, int, int], frames: int = 20) -> Mask:
    hidden = np.zeros((frames, len(NAMES)), dtype=bool)
    for marker, first, last in runs:
        hidden[first : last + 1, marker] = True
    return Mask(hidden=hidden, markers=NAMES)


def without(kept: Trajectories, samples: list[tuple[int, int]]) -> Trajectories:
    positions = kept.positions.copy()
    for frame, marker in samples:
        positions[frame, marker] = np.nan
    return Trajectories(positions=positions, markers=kept.markers, rate=kept.rate)


def plainly(estimate: Any, truth: Any, marker: int, first: int, last: int) -> dict[str, float]:
    """State the docstring's formulas with loops over frames."""
    error = estimate.positions[:, marker] - truth.positions[:, marker]
    frames = range(len(error))
    distance = [float(np.sqrt((error[t] ** 2).sum())) for t in range(first, last + 1)]
    steps = [
        np.linalg.norm(error[t] - error[t - 1])
        for t in range(first, last + 2)
        if t in frames and t - 1 in frames
    ]
    bends = [
        np.linalg.norm(error[t + 1] - 2 * error[t] + error[t - 1])
        for t in range(first - 1, last + 2)
        if t - 1 in frames and t + 1 in frames
    ]
    expected, true = estimate.positions[:, marker], truth.positions[:, marker]
    after = last + 1
    return {
        "rmse": float(np.sqrt(np.mean(np.square(distance)))),
        "mae": float(np.mean(distance)),
        "coordinate mae": float(
            np.mean([abs(error[t][axis]) for t in range(first, last + 1) for axis in range(3)])
        ),
        "max": max(distance),
        "jump": float(
            np.linalg.norm((expected[after] - expected[last]) - (true[after] - true[last]))
        )
        if after in frames
        else np.nan,
        "velocity": float(np.sqrt(np.mean(np.square(steps)))) if steps else np.nan,
        "acceleration": float(np.sqrt(np.mean(np.square(bends)))) if bends else np.nan,
    }


@given(
    seed=st.integers(0, 99),
    hidden=st.lists(
        st.lists(st.booleans(), min_size=12, max_size=12), min_size=3, max_size=3
    ).filter(lambda rows: any(map(any, rows))),
)
def test_every_error_is_the_documented_formula(seed: int, hidden: list[list[bool]]) -> None:
    estimate, truth = recording(seed, 12), recording(seed + 100, 12)
    table = gaps(estimate, truth, Mask(hidden=np.array(hidden).T, markers=NAMES))
    assert table["frames"].sum() == np.count_nonzero(hidden)
    for row in table.to_dict("records"):
        marker, first, last = NAMES.index(row["marker"]), row["start"], 0
        last = first + row["frames"] - 1
        assert all(hidden[marker][first : last + 1])
        assert first == 0 or not hidden[marker][first - 1]
        assert last == 11 or not hidden[marker][last + 1]
        for name, value in plainly(estimate, truth, marker, first, last).items():
            assert row[name] == pytest.approx(value, rel=1e-12, nan_ok=True), name


def test_gaps_are_numbered_by_first_frame_then_marker() -> None:
    table = gaps(recording(0), recording(1), mask((2, 3, 4), (0, 9, 9), (1, 3, 6), (2, 6, 6)))
    assert table["gap"].tolist() == [0, 1, 2, 3]
    assert table["marker"].tolist() == ["cheek", "chin", "chin", "brow"]
    assert table["start"].tolist() == [3, 3, 6, 9]
    assert table["frames"].tolist() == [4, 2, 1, 1]


def test_a_gap_left_open_in_part_has_no_error_and_is_reported() -> None:
    truth = recording(1)
    estimate = without(recording(0), [(4, 0)])
    with pytest.warns(UserWarning, match=r"1 of 2 gaps .* \(1 of 5 samples missing\)"):
        table = gaps(estimate, truth, mask((0, 3, 5), (1, 3, 4)))
    assert table["filled"].tolist() == [pytest.approx(2 / 3), 1.0]
    assert table.loc[0, ERRORS].isna().all()
    assert table.loc[1, ERRORS].notna().all()
    assert "1 of 2 gaps" in info_of(table).notes[0]


def test_missing_samples_beside_a_gap_only_take_differences_away() -> None:
    estimate, truth = recording(0), recording(1)
    cut = without(estimate, [(6, 0)])
    whole, row = (gaps(value, truth, mask((0, 4, 5))).iloc[0] for value in (estimate, cut))
    error = estimate.positions[:, 0] - truth.positions[:, 0]
    assert row["rmse"] == whole["rmse"]
    assert np.isnan(row["jump"])
    steps = np.linalg.norm(np.diff(error[3:6], axis=0), axis=1)
    assert row["velocity"] == pytest.approx(np.sqrt(np.mean(steps**2)))


def test_nothing_hidden_gives_an_empty_table_and_says_so() -> None:
    with pytest.warns(UserWarning, match="nothing is hidden"):
        table = gaps(recording(0), recording(1), mask())
    assert len(table) == 0
    assert "rmse" in table


def test_a_hidden_sample_without_a_truth_is_no_gap_to_score() -> None:
    truth = without(recording(1), [(4, 2)])
    with pytest.raises(ValueError, match="frame 4, marker 'chin': hidden, but the truth"):
        gaps(recording(0), truth, mask((2, 3, 5)))

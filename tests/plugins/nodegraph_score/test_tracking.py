"""Links, switches and fragments are counted as they are defined."""

from __future__ import annotations

import numpy as np
import pytest

from nodegraph_mocap import Trajectories
from nodegraph_score.tracking import UNITS, tracking
from nodegraph_tables import info_of


def marker(values: list[float]) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    return np.column_stack([np.array(values), np.array(values), np.array(values)])


def recording(**tracks: list[float]) -> Trajectories:
    positions = np.stack([marker(values) for values in tracks.values()], axis=1)
    return Trajectories(positions=positions, markers=tuple(tracks), rate=60.0)


NO = np.nan


def test_values_of_a_case_counted_by_hand() -> None:
    truth = recording(a=[1, 1, 1, 1, 1, 1, 1, 1], b=[2, 2, 2, NO, 2, 2, 2, 2])
    estimate = recording(
        p=[NO, 1, 1, NO, 1, 2, 2, NO], q=[2, 2, NO, NO, 2, 1, 1, NO], r=[NO] * 7 + [2]
    )
    table = tracking(estimate, truth)
    expected = [
        # present 8; tracked in frames 1 2 4 5 6 by p p p q q
        {
            "samples": 8,
            "links": 4,
            "wrong": 25_000,
            "right": 3 / 4,
            "switches": 1,
            "tracked": 5 / 8,
            "fragments": 1,
        },
        # present 7; tracked in frames 0 1 4 5 6 7 by q q q p p r, lost in frame 2
        {
            "samples": 7,
            "links": 5,
            "wrong": 40_000,
            "right": 3 / 5,
            "switches": 2,
            "tracked": 6 / 7,
            "fragments": 1,
        },
    ]
    assert table["marker"].tolist() == ["a", "b"]
    for row, values in zip(table.to_dict("records"), expected, strict=True):
        assert {name: row[name] for name in UNITS} == pytest.approx(values)


def test_a_marker_never_tracked_has_no_share() -> None:
    table = tracking(recording(p=[NO, NO]), recording(a=[1, 1], b=[NO, NO]))
    assert table["tracked"].tolist()[0] == 0
    assert table[["right", "wrong"]].isna().all(axis=None)
    assert np.isnan(table["tracked"].tolist()[1])


def test_ghosts_in_tracks_are_reported() -> None:
    with pytest.warns(UserWarning, match="1 of 2 samples in tracks are not samples of the truth"):
        table = tracking(recording(p=[1, 9]), recording(a=[1, 1]))
    assert len(info_of(table).notes) == 1

"""Impulses in a truth are recognized, and fast movement is not taken for one."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from nodegraph import get_node
from nodegraph_mocap import Mask, Trajectories
from nodegraph_mocap.suspect import impulses
from nodegraph_score.gaps import gaps
from nodegraph_tables import info_of
from tests.studies import DATA, needs_recordings


def blink(frames: int = 60) -> Trajectories:
    """Return two markers with a little noise, of which the second closes and opens in 12 frames."""
    positions = np.random.default_rng(0).normal(scale=0.05, size=(frames, 2, 3))
    positions[24:37, 1, 1] -= 5.0 * (1.0 - np.cos(np.linspace(0.0, 2.0 * np.pi, 13)))
    return Trajectories(positions=positions, markers=("still", "lid"), rate=60.0)


def struck(recording: Trajectories, *frames: int, marker: int = 0) -> Trajectories:
    positions = recording.positions.copy()
    positions[list(frames), marker] += [0.0, 0.0, 4.0]
    return Trajectories(positions=positions, markers=recording.markers, rate=recording.rate)


@pytest.mark.parametrize("marker", [0, 1])
@pytest.mark.parametrize("frame", [1, 20, 30, 58])
def test_an_impulse_is_named_with_its_distance(frame: int, marker: int) -> None:
    jumps = impulses(struck(blink(), frame, marker=marker).positions)
    assert np.argwhere(jumps).tolist() == [[frame, marker]]
    assert jumps[frame, marker] == pytest.approx(4.0, abs=1.5)


def test_movement_and_missing_samples_are_no_impulse() -> None:
    assert not impulses(blink().positions).any()
    positions = blink().positions.copy()
    positions[::3] = np.nan
    assert not impulses(positions).any()
    assert not impulses(positions[:2]).any()


def test_the_gap_of_an_impulse_is_suspect() -> None:
    truth = struck(blink(), 10, 40)
    hidden = np.zeros((60, 2), dtype=bool)
    hidden[8:13, 0] = hidden[20:25, 0] = hidden[39, 0] = hidden[8:13, 1] = True
    table = gaps(truth, truth, Mask(hidden=hidden, markers=truth.markers))
    assert [bool(text) for text in table["suspect"]] == [True, False, False, False]
    assert "frame 10 (4." in table["suspect"][0]
    (note,) = info_of(table).notes
    assert "1 of 4 gaps" in note
    assert "'suspect'" in note


@cache
def take(name: str) -> Trajectories:
    recording: Trajectories = get_node("read.recording")(path=DATA / name)
    return recording


@needs_recordings
@pytest.mark.parametrize(
    ("name", "most"),
    [("animface/jaw.c3d", 0), ("animface/cheeks.c3d", 0), ("facecap/take001.c3d", 1)],
)
def test_real_faces_have_hardly_any(name: str, most: int) -> None:
    assert np.count_nonzero(impulses(take(name).positions)) <= most

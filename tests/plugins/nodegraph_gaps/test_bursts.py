"""Gaps of the pattern `occlusion` come in bursts of neighbours, about mouth and eyelids."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_gaps.cut import cut
from nodegraph_mocap import Trajectories
from nodegraph_mocap.frame_ranges import runs_of

FRAMES, RATE = 900, 60.0


def row(*names: str, fast: tuple[int, ...] = ()) -> Trajectories:
    """Return markers in a row, 10 mm apart, of which some move ten times as much."""
    positions = np.random.default_rng(2).normal(size=(FRAMES, len(names), 3))
    positions[:, list(fast)] *= 10.0
    positions[:, :, 0] += 100.0 * np.arange(len(names))
    return Trajectories(positions=positions, markers=names, rate=RATE)


def gaps_of(
    recording: Trajectories, seed: int, *, simultaneous: int = 1
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the marker and the first frame of each gap."""
    hidden = cut(
        recording, length=4, count=16, pattern="occlusion", simultaneous=simultaneous, seed=seed
    ).hidden.hidden
    marker, first, _ = runs_of(hidden)
    return marker, first


def share_of(recording: Trajectories, markers: tuple[int, ...]) -> float:
    drawn = np.concatenate([gaps_of(recording, seed)[0] for seed in range(30)])
    return float(np.isin(drawn, markers).mean())


PLAIN = tuple(f"m{number}" for number in range(24))


def test_a_marker_is_lost_again_soon_and_its_neighbours_with_it() -> None:
    near, neighbours = [], []
    for seed in range(10):
        marker, first = gaps_of(row(*PLAIN), seed)
        soon = np.abs(first[:, None] - first) < 1.5 * RATE
        np.fill_diagonal(soon, val=False)
        near.append((soon & (marker[:, None] == marker)).any(axis=1).mean())
        neighbours.append(len(set(marker.tolist())))
    assert np.mean(near) > 0.7  # of random places, 0.03
    assert np.mean(neighbours) < 11  # of random places, 13


@pytest.mark.parametrize("names", [("L_mouth1", "R_lip"), ("EyelidLeft", "LOWER_LID_2")])
def test_bursts_centre_on_what_its_name_calls_mouth_or_eyelid(names: tuple[str, ...]) -> None:
    occluded = (5, 6)
    markers = (*PLAIN[:5], *names, *PLAIN[7:])
    assert share_of(row(*markers), (3, 4, *occluded, 7, 8)) > 1.4 * share_of(
        row(*PLAIN), (3, 4, *occluded, 7, 8)
    )
    solid = (*PLAIN[:5], "solid1", "clip", *PLAIN[7:])
    assert share_of(row(*solid), occluded) == share_of(row(*PLAIN), occluded)


def test_without_such_names_bursts_centre_on_what_moves() -> None:
    fast = (5, 6)
    assert share_of(row(*PLAIN, fast=fast), fast) > 2 * share_of(row(*PLAIN), fast)


def test_markers_of_an_event_are_neighbours_and_share_its_frames() -> None:
    marker, first = gaps_of(row(*PLAIN), 1, simultaneous=3)
    for start in set(first.tolist()):
        together = np.sort(marker[first == start])
        assert len(together) % 3 == 0
        assert np.ptp(together) <= 2 * len(together)


def test_seed_and_recording_decide() -> None:
    recording = row(*PLAIN)
    other = replace(recording, sigma=np.ones((FRAMES, len(PLAIN))))
    first, again = (
        cut(take, pattern="occlusion", seed=4).hidden.hidden for take in (recording, other)
    )
    assert np.array_equal(first, again)
    assert not np.array_equal(first, cut(recording, pattern="occlusion", seed=5).hidden.hidden)

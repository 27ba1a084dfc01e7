"""Tracks get the names of a reference: all of them where they are whole, nearly all else."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest

from nodegraph import Refusal
from nodegraph_markers.label import label
from nodegraph_mocap import Origin, Trajectories
from nodegraph_mocap.specimens import recordings
from nodegraph_track.assignment import assignment
from tests.plugins.nodegraph_markers.takes import (
    correct,
    face,
    quiet,
    read_take,
    turned,
    without_names,
)


@pytest.mark.parametrize("seed", range(2))
def test_a_shuffled_take_gets_all_its_names_back_wherever_it_is(seed: int) -> None:
    synthetic = face(seed=seed, seconds=3.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # nothing is left over
        here = label(without_names(synthetic.captured, seed), synthetic.neutral)
        there = label(turned(without_names(synthetic.captured, seed)), synthetic.neutral)
    assert here.markers == there.markers == synthetic.captured.markers
    assert np.array_equal(here.positions, synthetic.captured.positions, equal_nan=True)
    assert np.array_equal(here.origin, synthetic.captured.origin)
    assert here.marker_set is synthetic.neutral.marker_set
    moved = turned(synthetic.captured).positions
    assert np.array_equal(there.positions, moved, equal_nan=True)


@pytest.mark.parametrize("name", ["jaw", "cheeks", "take001"])
def test_takes_of_real_and_animated_faces_by_their_own_first_frame(name: str) -> None:
    recording, marker_set = read_take(name)
    first = Trajectories(
        positions=recording.positions[:1],
        markers=recording.markers,
        rate=recording.rate,
        marker_set=marker_set,
    )
    result = label(turned(without_names(recording)), first)
    assert correct(result, turned(recording)).all()
    assert result.marker_set is marker_set


def test_tracked_points_get_the_names_of_their_markers() -> None:
    synthetic = face(seed=0, seconds=5.0)
    with quiet():
        tracks = assignment(synthetic.detections)
        named = label(tracks, synthetic.neutral)
    good = correct(named, synthetic.captured)
    assert good.sum() > 0.998 * tracks.present.sum()
    wrong = named.keep(synthetic.captured.markers).present & ~good
    assert wrong.sum() <= 1e-4 * tracks.present.sum()
    assert named.present.sum() == tracks.present.sum()


@pytest.mark.parametrize(
    "settings",
    [
        {"seed": 1, "markers": 10},
        {"seed": 1, "markers": 150, "seconds": 3.0},
        {"seed": 2, "missing": 0.2, "seconds": 3.0},
        {"seed": 5, "rate": 30.0, "seconds": 5.0},
    ],
    ids=str,
)
def test_few_markers_many_gaps_and_low_rates(settings: dict[str, Any]) -> None:
    synthetic = face(**settings)
    with quiet():
        tracks = assignment(synthetic.detections)
        named = label(tracks, synthetic.neutral)
    assert correct(named, synthetic.captured).sum() > 0.99 * tracks.present.sum()


def test_a_neutral_of_another_actor_will_do() -> None:
    take = face(seed=1, seconds=3.0).captured
    named = label(without_names(take), face(seed=2, seconds=3.0).neutral)
    assert correct(named, take)[take.present].all()


def test_what_is_no_marker_is_left_behind_the_names_and_reported() -> None:
    synthetic = face(seed=0, seconds=3.0)
    known = [name for name in synthetic.neutral.markers if name not in ("M_jaw1", "L_cheek2")]
    with pytest.warns(UserWarning, match=r"samples are no marker .* 2 tracks as a whole and 0"):
        named = label(without_names(synthetic.captured), synthetic.neutral.keep(known))
    assert named.markers == (*known, "t000", "t001")
    assert correct(named, synthetic.captured.keep(known))[
        synthetic.captured.keep(known).present
    ].all()
    left = np.sort(named.present.sum(axis=0)[-2:])
    counts = synthetic.captured.keep(["M_jaw1", "L_cheek2"]).present.sum(axis=0)
    assert np.array_equal(left, np.sort(counts))


def test_a_marker_in_no_track_is_there_and_missing() -> None:
    synthetic = face(seed=0, seconds=3.0)
    seen = synthetic.captured.keep(
        [name for name in synthetic.captured.markers if name != "R_jaw2"]
    )
    with pytest.warns(UserWarning, match="1 markers of the reference are in no track: R_jaw2$"):
        named = label(without_names(seen), synthetic.neutral)
    assert named.markers == synthetic.neutral.markers
    assert not named.keep(["R_jaw2"]).present.any()
    assert correct(named, seen)[seen.present].all()


def test_one_side_of_a_face_is_not_taken_for_the_other() -> None:
    synthetic = face(seed=3, seconds=3.0)
    side = synthetic.captured.keep([name for name in synthetic.captured.markers if name[0] == "R"])
    with quiet():
        named = label(without_names(side), synthetic.neutral)
    assert correct(named, side)[side.present].all()


def test_fragments_and_ghosts() -> None:
    synthetic = face(seed=4, seconds=5.0)
    whole = synthetic.captured.positions
    early, late = whole.copy(), whole.copy()
    early[150:], late[:150] = np.nan, np.nan
    ghost = np.full((300, 1, 3), np.nan)
    ghost[40:60, 0] = np.nanmean(whole[40:60], axis=1) + np.array([0.0, 0.0, 90.0])
    shadow = whole[:, :1] + [3.0, 3.0, 0.0]
    shadow[:, :] = np.where(np.arange(300)[:, None, None] % 290 < 80, shadow, np.nan)
    positions = np.concatenate([ghost, late, shadow, early], axis=1)
    names = tuple(f"t{number}" for number in range(positions.shape[1]))
    origin = np.where(np.isnan(positions[..., 0]), Origin.MISSING, Origin.FILLED)
    tracks = Trajectories(
        positions=positions, markers=names, rate=60.0, origin=origin, sigma=positions[..., 0] ** 2
    )
    with quiet():
        named = label(tracks, synthetic.neutral)
    assert correct(named, synthetic.captured)[synthetic.captured.present].all()
    assert named.markers[60:] == ("t000", "t001")
    assert np.array_equal(named.positions[:, 60:], positions[:, [0, 61]], equal_nan=True)
    assert (named.origin[named.present] == Origin.FILLED).all()
    assert named.sigma is not None
    assert np.array_equal(named.sigma, named.positions[..., 0] ** 2, equal_nan=True)


def test_a_reference_of_several_frames_is_its_most_complete_one() -> None:
    synthetic = face(seed=1, seconds=3.0)
    gappy = np.stack([synthetic.neutral.positions[0]] * 3)
    gappy[0, :20] = gappy[2, 5] = np.nan
    reference = Trajectories(positions=gappy, markers=synthetic.neutral.markers, rate=60.0)
    named = label(without_names(synthetic.captured), reference)
    assert correct(named, synthetic.captured)[synthetic.captured.present].all()


def test_a_take_of_something_else_is_doubtful(shoulder: Trajectories) -> None:
    synthetic = face(seed=0, seconds=1.0)
    with quiet(), pytest.raises(Refusal, match="no frame fits the reference: in none do 15 points"):
        label(without_names(shoulder), synthetic.neutral)


def test_a_face_unlike_the_reference_is_reported() -> None:
    recording, _ = read_take("jaw")
    with pytest.warns(UserWarning, match=r"the names are doubtful: half .* more than \d\.\d mm"):
        label(without_names(recording), face(seed=1).neutral)


def test_a_narrow_gate_leaves_more() -> None:
    synthetic = face(seed=0, seconds=3.0)
    with quiet():
        narrow = label(without_names(synthetic.captured), synthetic.neutral, gate=0.8)
    assert len(narrow.markers) > len(synthetic.neutral.markers)
    assert narrow.present.sum() == synthetic.captured.present.sum()


def test_what_cannot_be_named() -> None:
    synthetic = face(seed=0, seconds=1.0)
    with pytest.raises(Refusal, match=r"of 3 markers that are ever present .*; 2 are"):
        label(synthetic.captured, synthetic.neutral.keep(["M_nose1", "M_jaw1"]))
    line = Trajectories(
        positions=np.linspace([0.0, 0, 0], [50, 60, 70], 6)[None], markers=tuple("abcdef"), rate=1.0
    )
    with pytest.raises(Refusal, match="not on a line; 6 are"):
        label(synthetic.captured, line)
    with pytest.raises(Refusal, match="no frame fits the reference"):
        label(recordings()["all missing"], synthetic.neutral)

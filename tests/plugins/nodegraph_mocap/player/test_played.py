from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from nodegraph_mocap import Animation, Origin, Panel, Playback, Trajectories
from nodegraph_mocap.player import data
from nodegraph_mocap.player.data import error_scale, packed, step_of
from nodegraph_mocap.specimens import animations, recordings
from tests.plugins.nodegraph_mocap.player.unpacked import Read


def panel(shown: Any, label: str = "one", radius: float = 100.0) -> Panel:
    axes = np.eye(3)
    return Panel(
        label=label, shown=shown, centre=np.zeros(3), right=axes[0], up=axes[1], radius=radius
    )


def playback(*shown: object, truth: object = None) -> Playback:
    known = None if truth is None else panel(truth, "truth")
    return Playback(panels=tuple(panel(single) for single in shown), truth=known)


@pytest.mark.parametrize("name", recordings())
def test_every_sample_comes_back_to_a_hundredth_of_a_millimetre(name: str) -> None:
    recording = recordings()[name]
    read = Read.of(playback(recordings()["complete"], recording, recording))
    for place in (1, 2):
        expected = read.head["panels"][place]
        assert tuple(expected["markers"]) == recording.markers
        assert (expected["frames"], expected["rate"]) == (recording.frames, recording.rate)
        assert np.array_equal(read.origin(place), recording.origin)
        error = np.abs(read.positions(place) - recording.positions)
        assert np.array_equal(np.isnan(error), np.isnan(recording.positions))
        assert np.nanmax(error, initial=0.0) <= 0.005 + 1e-9


def test_what_fills_of_one_damaged_take_share_is_packed_once() -> None:
    random = np.random.default_rng(0)
    markers = tuple(f"m{column}" for column in range(60))
    truth = Trajectories(positions=random.normal(0, 30, (200, 60, 3)), markers=markers, rate=60.0)
    captured = truth.positions + random.normal(0, 0.1, truth.positions.shape)
    fills = []
    for method in range(17):
        filled = captured.copy()
        filled[50:60, 7] += method
        fills.append(replace(truth, positions=filled))
    alone = len(packed(playback(fills[0], truth=truth)))
    assert len(packed(playback(*fills, truth=truth))) < 1.15 * alone


def test_a_head_that_several_share_is_reported_once() -> None:
    first, second = animations()["complete"], animations()["gaps"]
    read = Read.of(playback(first, second))
    (head,) = read.head["heads"]
    assert [panel["head"] for panel in read.head["panels"]] == [0, 0]
    vertices = read.steps(head["vertices"]).reshape(-1, 3) * head["vertices"]["step"]
    assert np.abs(vertices - first.head.vertices).max() <= 0.005 + 1e-9
    morphs = read.steps(head["morphs"]).reshape(first.head.morphs.shape) * head["morphs"]["step"]
    assert np.abs(morphs - first.head.morphs).max() <= 0.005 + 1e-9
    assert np.array_equal(read.steps(head["faces"]).reshape(-1, 3), first.head.faces)
    other = replace(second, head=replace(second.head, vertices=second.head.vertices + 1))
    assert [panel["head"] for panel in Read.of(playback(first, other)).head["panels"]] == [0, 1]


@pytest.mark.parametrize("name", animations())
def test_weights_and_motion_come_back(name: str) -> None:
    animation: Animation = animations()[name]
    read = Read.of(playback(animation))
    (expected,) = read.head["panels"]
    known = np.isfinite(animation.morph_weights)
    assert np.array_equal(read.small(expected["known"], animation.frames), known.all(axis=1))
    weights = read.steps(expected["weights"]).T * expected["weights"]["step"]
    assert np.abs(weights - animation.morph_weights)[known].max() <= 5.1e-5
    motion = animation.head_motion
    assert (expected["motion"] is None) == (motion is None)
    if motion is not None:
        twelve = read.exact(expected["motion"]).reshape(-1, 12)
        scaled = motion.scales[:, None, None] * motion.rotations
        assert twelve[:, :9] == pytest.approx(scaled.reshape(-1, 9), abs=1e-6)
        assert twelve[:, 9:] == pytest.approx(motion.translations, rel=1e-6)


def test_edges_and_the_truth_are_matched_by_name() -> None:
    truth = recordings()["complete"]
    shown = truth.keep(["lip_right", "nose", "lip_left"])
    renamed = replace(shown, markers=("lip_right", "new", "lip_left"), marker_set=None)
    read = Read.of(playback(shown, renamed, truth=truth))
    known, first, other = read.head["panels"]
    assert known["truth"] is None
    assert [truth.markers[place] for place in first["truth"]] == list(shown.markers)
    assert other["truth"][1] == -1
    assert {tuple(sorted(shown.markers[end] for end in edge)) for edge in first["edges"]} == {
        ("lip_left", "lip_right")
    }
    assert other["edges"] == []


def test_it_opens_where_most_samples_were_made() -> None:
    whole = recordings()["filled, repaired and with sigma"]
    assert Read.of(playback(recordings()["complete"], whole)).head["start"] == 10 / 60
    assert Read.of(playback(recordings()["gaps"])).head["start"] == 0.0
    nowhere = recordings()["complete"].keep(["lip_right"])
    assert Read.of(playback(whole, truth=nowhere)).head["start"] == 30 / 60


def test_gaps_are_what_methods_made_for_a_while() -> None:
    truth = recordings()["complete"]
    filled = with_filled(with_filled(with_filled(truth, 2, 5, 25), 1, 3, 12), 4, 20, 31)
    read = Read.of(playback(truth, filled, filled))
    assert read.head["gaps"] == [
        [3 / 60, 12 / 60, truth.markers[1]],
        [5 / 60, 25 / 60, truth.markers[2]],
        [20 / 60, 31 / 60, truth.markers[4]],
    ]
    assert Read.of(playback(with_filled(truth, 2, 0, 40))).head["gaps"] == []


def test_gaps_are_what_is_missing_in_any_recording(monkeypatch: pytest.MonkeyPatch) -> None:
    truth = recordings()["complete"]
    missing = np.zeros(truth.origin.shape, dtype=bool)
    for marker, start, stop in ((2, 20, 30), (3, 5, 12), (4, 0, 8), (5, 0, 40), (6, 9, 10)):
        missing[start:stop, marker] = True
    positions = np.where(missing[..., None], np.nan, truth.positions)
    gappy = truth.with_samples(positions, changed=missing, origin=Origin.MISSING)
    gaps = [(0, 8, 4), (5, 12, 3), (9, 10, 6), (20, 30, 2)]
    expected = [[start / 60, stop / 60, truth.markers[m]] for start, stop, m in gaps]
    assert Read.of(playback(gappy)).head["gaps"] == expected
    made = [[10 / 60, 14 / 60, truth.markers[1]], [20 / 60, 30 / 60, truth.markers[2]]]
    both = Read.of(playback(gappy, with_filled(with_filled(truth, 2, 20, 30), 1, 10, 14)))
    assert both.head["gaps"] == [*expected[:3], *made]
    monkeypatch.setattr(data, "_MOST_GAPS", 2)
    assert Read.of(playback(gappy)).head["gaps"] == [expected[0], expected[3]]


def test_each_panel_has_the_mean_error_of_what_was_made() -> None:
    truth = recordings()["complete"]
    filled = with_filled(truth, 2, 5, 25)
    shifted = replace(filled, positions=filled.positions + np.array([0.0, 3.0, 4.0]))
    read = Read.of(playback(shifted, replace(truth, positions=truth.positions + 0.6), truth=truth))
    errors = [panel["error"] for panel in read.head["panels"]]
    assert errors == [None, pytest.approx(5.0), pytest.approx(0.6 * np.sqrt(3))]
    assert Read.of(playback(shifted)).head["panels"][0]["error"] is None


def with_filled(recording: Trajectories, marker: int, first: int, stop: int) -> Trajectories:
    """Return a recording some of whose samples are filled, where they were."""
    changed = np.zeros(recording.origin.shape, bool)
    changed[first:stop, marker] = True
    return recording.with_samples(recording.positions, changed=changed, origin=Origin.FILLED)


def test_a_head_alone_starts_where_it_moves_most() -> None:
    moved = animations()["complete"]
    sizes = np.abs(moved.morph_weights).sum(axis=1)
    start = Read.of(playback(moved)).head["start"]
    assert sizes[round(start * moved.rate)] == sizes.max() > 0
    still = replace(moved, weights=replace(moved.weights, values=0 * moved.weights.values))
    assert Read.of(playback(still)).head["start"] == 0.0


def test_the_colours_end_above_nearly_all_errors() -> None:
    truth = recordings()["complete"]
    changed = np.zeros(truth.origin.shape, bool)
    changed[5:25, 2] = True
    moved = truth.positions + changed[..., None] * np.array([0.0, 3.1, 0.0])
    filled = truth.with_samples(moved, changed=changed, origin=Origin.FILLED)
    assert error_scale(playback(filled, truth=truth)) == 5.0
    assert (
        error_scale(playback(replace(truth, positions=truth.positions + 0.3), truth=truth)) == 1.0
    )
    assert error_scale(playback(truth, truth=truth)) == 1.0
    assert error_scale(playback(filled)) == 1.0
    assert error_scale(playback(animations()["complete"], truth=truth)) == 1.0


def test_tiny_things_are_reported_more_finely() -> None:
    face = recordings()["complete"]
    assert step_of([panel(face)]) == 0.01
    assert step_of([panel(face, radius=1.0)]) == pytest.approx(1e-4)
    assert step_of([panel(face, radius=1.0), panel(face)]) == 0.01


def test_a_sample_out_of_reach_is_reported_as_missing() -> None:
    face = recordings()["complete"]
    far = face.positions.copy()
    far[3, 2] = 1e9
    read = Read.of(playback(replace(face, positions=far)))
    assert read.origin(0)[3, 2] == Origin.MISSING
    assert np.count_nonzero(read.origin(0) == Origin.MISSING) == 1

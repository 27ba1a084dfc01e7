from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from nodegraph import Absent, Across, Refusal
from nodegraph.node.decorator import node_of
from nodegraph_mocap import Animation, Trajectories
from nodegraph_mocap.player import fitting
from nodegraph_mocap.specimens import animations, recordings
from nodegraph_mocap.view import frontal
from nodegraph_plot.playback import playback
from tests.plugins.nodegraph_plot import made_face


def across(**values: object) -> Across[Any]:
    return Across.of(values, axis="fill")


def shown(playback: Any) -> list[tuple[str, type]]:
    return [(panel.label, type(panel.shown)) for panel in playback.panels]


def test_recordings_come_before_animations_each_in_their_order() -> None:
    faces = across(b=made_face.filled(0.0), a=made_face.gappy())
    player = playback(faces, across(b=animations()["complete"]))
    assert shown(player) == [("b", Trajectories), ("a", Trajectories), ("b", Animation)]
    assert player.truth is None
    assert (player.every, player.notes) == (1, ())
    assert player.panels[0].shown is faces.values()[0]


def test_nothing_at_all_is_refused() -> None:
    empty: Across[Trajectories] = Across(("fill",), ())
    for nothing in (None, empty):
        with pytest.raises(ValueError, match="neither a recording nor an animation to play"):
            playback(nothing, truth=made_face.truth())


def test_the_truth_has_a_panel_of_its_own() -> None:
    truth = made_face.truth()
    player = playback(across(guess=made_face.filled(1.0)), truth=truth)
    assert player.truth is not None
    assert (player.truth.label, player.truth.shown) == ("truth", truth)
    assert len(player.panels) == 1
    described = node_of(playback)
    assert described is not None
    assert [str(port) for port in described.inputs] == [
        "recordings: Across[Trajectories] | None",
        "animations: Across[Animation] | None",
        "truth: Truth[Trajectories] | None",
    ]


def test_what_is_absent_is_listed() -> None:
    lost = Absent({"fill": "ridge", "trial": 3}, "refused", "needs one complete frame")
    faces = Across(("fill", "trial"), (({"fill": "a", "trial": 3}, made_face.gappy()),), (lost,))
    notes = playback(faces).notes
    assert notes == ("recording ridge, 3 is absent: refused, needs one complete frame",)


def test_it_is_seen_from_the_front_or_as_asked_for() -> None:
    face = made_face.gappy()
    (seen,) = playback(across(a=face)).panels
    expected = frontal(face, "auto")
    assert np.array_equal([seen.right, seen.up], [expected.right, expected.up])
    (seen,) = playback(across(a=face), view="-z+x").panels
    assert np.array_equal([seen.right, seen.up], [[0, 0, -1], [1, 0, 0]])


def test_too_many_frames_are_thinned_and_that_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    truth, face = recordings()["complete"], recordings()["filled, repaired and with sigma"]
    head = animations()["complete"]
    monkeypatch.setattr(fitting, "MOST_SAMPLES", 400)
    with pytest.warns(UserWarning, match="of 3 frames one is shown, and 2 are left out"):
        player = playback(across(a=face), across(a=head), truth)
    assert player.every == 3
    assert "of 3 frames one is shown" in player.notes[0]
    recording, animation = (panel.shown for panel in player.panels)
    assert isinstance(recording, Trajectories)
    assert isinstance(animation, Animation)
    assert np.array_equal(recording.positions, face.positions[::3], equal_nan=True)
    assert np.array_equal(recording.origin, face.origin[::3])
    assert np.array_equal(animation.weights.values, head.weights.values[::3])
    assert animation.head_motion is not None
    assert recording.rate == animation.rate == face.rate / 3
    assert player.truth is not None
    assert player.truth.shown.frames == recording.frames


def test_as_much_as_fits_is_played_in_full(monkeypatch: pytest.MonkeyPatch) -> None:
    face = recordings()["complete"]
    monkeypatch.setattr(fitting, "MOST_SAMPLES", 2 * face.frames * len(face.markers))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert playback(across(a=face, b=face)).every == 1
    with pytest.warns(UserWarning, match="of 2 frames one"):
        assert playback(across(a=face, b=face), truth=face).every == 2


def test_heads_that_are_too_large_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    head = animations()["complete"]
    size = head.head.vertices.size // 3 * (1 + len(head.head.names))
    monkeypatch.setattr(fitting, "MOST_VERTICES", size)
    playback(animations=across(a=head, b=head))  # a head that both share counts once
    other = replace(head, head=replace(head.head, vertices=head.head.vertices + 1))
    with pytest.raises(Refusal, match=f"have {2 * size:,} vertices .* holds {size:,}"):
        playback(animations=across(a=head, b=other))


def test_a_head_without_triangles_is_refused() -> None:
    head = animations()["complete"]
    bare = replace(head, head=replace(head.head, faces=np.empty((0, 3), dtype=np.int64)))
    with pytest.raises(Refusal, match="the head of a has no triangles"):
        playback(animations=across(a=bare))


def test_samples_out_of_reach_are_counted() -> None:
    face = recordings()["complete"]
    far = face.positions.copy()
    far[3:5, 2] = 1e9
    with pytest.warns(UserWarning, match="wild: 2 samples lie more than 10,737 m away"):
        notes = playback(across(tame=face, wild=replace(face, positions=far))).notes
    assert len(notes) == 1

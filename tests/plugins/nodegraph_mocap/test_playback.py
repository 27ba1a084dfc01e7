from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from nodegraph_mocap import Panel, Playback, Trajectories
from nodegraph_mocap.specimens import animations, recordings


def panel(shown: object = None, **changed: Any) -> Panel:
    given = {
        "label": "one",
        "shown": recordings()["complete"] if shown is None else shown,
        "centre": np.zeros(3),
        "right": np.array([1.0, 0, 0]),
        "up": np.array([0, 1.0, 0]),
        "radius": 100.0,
    }
    return Panel(**{**given, **changed})


def test_the_longest_panel_says_how_long_it_plays() -> None:
    face = recordings()["complete"]
    slower = replace(face, rate=face.rate / 2)
    whole = Playback(panels=(panel(), panel(slower), panel(animations()["one frame"])))
    assert whole.panels[0].seconds == face.frames / face.rate
    assert whole.seconds == 2 * face.frames / face.rate


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"radius": 0.0}, "radius must be positive, got 0"),
        ({"radius": np.nan}, "radius must be positive"),
        ({"up": np.array([1.0, 0, 0])}, "not unit vectors at right angles"),
        ({"right": np.array([2.0, 0, 0])}, "not unit vectors at right angles"),
        ({"centre": np.array([0, np.nan, 0])}, "centre: missing"),
    ],
)
def test_a_view_that_makes_no_sense_is_refused(changed: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        panel(**changed)


def test_a_recording_without_frames_is_refused() -> None:
    empty = Trajectories(positions=np.empty((0, 1, 3)), markers=("nose",), rate=60.0)
    with pytest.raises(ValueError, match="one has no frame"):
        panel(empty)


def test_a_playback_of_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="nothing to play"):
        Playback(panels=())
    with pytest.raises(ValueError, match="every must be at least 1, got 0"):
        Playback(panels=(panel(),), every=0)


@pytest.mark.parametrize(
    ("truth", "message"),
    [
        (lambda face: recordings()["one frame"], "has 1 frames, the recording of one 40"),
        (lambda face: replace(face, rate=30.0), "has 30 Hz, the recording of one 60 Hz"),
        (lambda face: animations()["complete"], "the truth must be a recording"),
    ],
)
def test_a_truth_that_cannot_be_compared_is_refused(truth: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Playback(panels=(panel(),), truth=panel(truth(recordings()["complete"])))


def test_an_animation_needs_no_frames_of_the_truth() -> None:
    known = panel(recordings()["complete"])
    assert Playback(panels=(panel(animations()["one frame"]),), truth=known).truth is known

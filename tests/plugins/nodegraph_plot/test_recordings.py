from __future__ import annotations

from dataclasses import replace

import numpy as np

from nodegraph import Across
from nodegraph_mocap import Origin, Trajectories
from nodegraph_plot.recordings import comparable, named_looks
from nodegraph_plot.trajectories import trajectories

FRAMES = 40


def half_known() -> tuple[Trajectories, Trajectories]:
    """Return a recording with a long fill of unknown truth and a short one of known truth."""
    random = np.random.default_rng(3)
    positions = random.normal(size=(FRAMES, 2, 3))
    origin = np.full((FRAMES, 2), Origin.MEASURED, dtype=np.uint8)
    origin[5:30, 0] = Origin.FILLED
    origin[10:14, 1] = Origin.FILLED
    known = positions.copy()
    known[5:30, 0] = np.nan
    names = ("long", "short")
    return (
        Trajectories(positions=positions, markers=names, rate=60.0, origin=origin),
        Trajectories(positions=known, markers=names, rate=60.0),
    )


def test_made_samples_with_a_known_truth_tell_the_most() -> None:
    recording, truth = half_known()
    flags = comparable(recording, truth)
    assert np.argwhere(flags).tolist() == [[frame, 1] for frame in range(10, 14)]


def test_without_a_truth_every_made_sample_tells() -> None:
    recording, _ = half_known()
    assert np.count_nonzero(comparable(recording, None)) == 25 + 4
    nowhere = Trajectories(
        positions=np.full((FRAMES, 2, 3), np.nan), markers=recording.markers, rate=60.0
    )
    assert np.count_nonzero(comparable(recording, nowhere)) == 25 + 4


def test_the_marker_that_can_be_compared_is_drawn_by_default() -> None:
    recording, truth = half_known()
    figure = trajectories(Across.of({"a": recording}, axis="fill"), truth)
    assert "short" in figure.axes[0].get_title()


def test_a_method_looks_the_same_whichever_others_are_drawn() -> None:
    recording, _ = half_known()
    fills = ("cubic", "linear", "muscle", "ridge")
    every = named_looks(Across.of(dict.fromkeys(fills, recording), axis="fill"))
    some = Across.of({"ridge": recording, "muscle": recording}, axis="recordings")
    message = named_looks(replace(some, known={"recordings": fills}))
    assert message["muscle"] == every["muscle"]
    assert message["ridge"] == every["ridge"]
    assert named_looks(some)["muscle"] != every["muscle"]

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from nodegraph import Across
from nodegraph_mocap import Figure, Origin, Trajectories
from nodegraph_plot.faces import faces
from nodegraph_plot.playback import playback
from nodegraph_plot.recordings import comparable, named_looks
from nodegraph_plot.spectra import spectra
from nodegraph_plot.trajectories import trajectories
from nodegraph_tables.figures import store_figure

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


PLOTS: dict[str, Callable[[Across[Trajectories]], object]] = {
    "faces": faces,
    "playback": playback,
    "spectra": spectra,
    "trajectories": trajectories,
}


@pytest.mark.parametrize("name", PLOTS)
def test_what_cannot_be_drawn_is_refused_by_every_plot(name: str) -> None:
    plot, (whole, _) = PLOTS[name], half_known()
    none = replace(whole, positions=whole.positions[:0], origin=whole.origin[:0])
    with pytest.raises(ValueError, match=r"b (has no frame|is too short)"):
        plot(Across.of({"a": whole, "b": none}, axis="fill"))
    with pytest.raises(ValueError, match=r"no recording to draw|neither a recording nor"):
        plot(Across(("fill",), ()))
    twice = (({"a": "x", "b": ""}, whole), ({"a": "", "b": "x"}, whole))
    with pytest.raises(ValueError, match="several recordings are labelled x"):
        plot(Across(("a", "b"), twice))
    if name != "playback":
        with pytest.raises(ValueError, match="a has no markers: there is nothing to draw"):
            plot(Across.of({"a": whole.keep(())}, axis="fill"))


@pytest.mark.parametrize("plot", [faces, trajectories])
def test_the_truth_is_matched_by_name(plot: Callable[..., Figure]) -> None:
    recording, truth = half_known()
    recordings = Across.of({"a": recording}, axis="fill")
    both = (truth, truth.keep(truth.markers[::-1]))
    first, second = (store_figure(plot(recordings, known)).svg for known in both)
    assert first == second

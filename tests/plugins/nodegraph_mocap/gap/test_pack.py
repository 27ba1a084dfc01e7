"""What is packed for the view of a block is what the methods made of it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from nodegraph_mocap import Mask, Trajectories
from nodegraph_mocap.gap.data import MOST_FRAMES, pack
from tests.plugins.nodegraph_mocap.gap import unpacked
from tests.plugins.nodegraph_plot import made_face

GAP = {"marker": "mouth_l", "start": 15, "frames": 6}


def inputs(*offsets: float) -> dict[str, dict[str, Any]]:
    """Return what scores of fills read that are off by so many mm along each axis."""
    hidden = np.zeros((made_face.FRAMES, len(made_face.MARKERS)), bool)
    hidden[made_face.GAP, made_face.GAP_MARKER] = True
    mask = Mask(hidden=hidden, markers=made_face.MARKERS)
    return {
        f"off by {offset}": {
            "estimate": made_face.filled(offset),
            "truth": made_face.truth(),
            "hidden": mask,
        }
        for offset in offsets
    }


def packed(
    block: Mapping[str, object], given: Mapping[str, Mapping[str, object]]
) -> dict[str, Any]:
    view = pack(block, given)
    assert view is not None
    return json.loads(json.dumps(view, allow_nan=False))  # type: ignore[no-any-return]


@pytest.mark.parametrize("block", [GAP, {"gap": 0}, {"gap": "0", "trial": 3}])
def test_a_gap_comes_back_to_the_rounding_with_as_much_around_it(block: dict[str, object]) -> None:
    given = inputs(0.5, -900.0)
    view = packed(block, given)
    shown = slice(view["start"], view["start"] + view["frames"])
    assert (shown, view["judged"]) == (slice(5, 31), {"name": "hidden", "runs": [[10, 15]]})
    assert np.abs(unpacked.truth(view) - made_face.truth().positions[shown, 7]).max() < 1e-3
    for method, positions in unpacked.estimates(view).items():
        step = 1e-3 if method == "off by 0.5" else 0.03
        expected = given[method]["estimate"].positions[shown, 7]
        assert np.abs(positions - expected).max() < step


def test_the_face_is_that_of_the_truth() -> None:
    view = packed(GAP, inputs(0.5))
    truth = made_face.truth()
    assert np.abs(unpacked.faces(view) - truth.positions[5:31]).max() < 0.05
    assert view["face"]["markers"] == list(made_face.MARKERS)
    assert view["axes"] == ["to the side", "up", "to the front"]
    assert [7, 8] in view["face"]["edges"]


def test_an_impulse_of_the_truth_is_suspect() -> None:
    given = inputs(0.5)
    (ports,) = given.values()
    spiked = ports["truth"].positions.copy()
    spiked[17, 7, 2] += 9.0
    ports["truth"] = replace(ports["truth"], positions=spiked)
    assert packed(GAP, given)["suspects"] == [17 - 5]


def test_a_marker_is_shown_where_a_method_errs_most() -> None:
    truth = made_face.truth()
    off = truth.positions.copy()
    off[33, 4] += 3.0
    off[2, 5] += 9.0
    given = {
        name: {"estimate": estimate, "truth": truth}
        for name, estimate in (("good", truth), ("bad", replace(truth, positions=off)))
    }
    view = packed({"marker": made_face.MARKERS[4]}, given)
    assert (view["start"], view["frames"]) == (3, 37)
    assert "frame 33" in view["reason"]
    assert packed({"marker": "all"}, given)["marker"] == made_face.MARKERS[5]
    alone = {name: {"recording": ports["estimate"]} for name, ports in given.items()}
    view = packed({"marker": made_face.MARKERS[4]}, alone)
    assert view["truth"] is None
    assert "frame 33" in view["reason"]


def test_the_track_of_a_marker_is_the_one_that_has_it_most_often() -> None:
    truth = made_face.truth()
    switched = truth.positions.copy()
    switched[30:, [0, 7]] = switched[30:, [7, 0]]
    tracks = Trajectories(
        positions=switched, markers=tuple(f"track {k}" for k in range(9)), rate=60.0
    )
    view = packed({"marker": "nose"}, {"a": {"estimate": tracks, "truth": truth}})
    positions = unpacked.estimates(view)["a"]
    assert np.abs(positions - switched[view["start"] :, 0]).max() < 5e-3


def test_missing_samples_and_methods_stay_missing() -> None:
    given = inputs(0.5)
    given["none"] = {**given["off by 0.5"], "estimate": made_face.gappy()}
    given["other"] = {**given["off by 0.5"], "estimate": made_face.filled(1.0).keep(["nose"])}
    shown = unpacked.estimates(packed(GAP, given))
    assert set(shown) == {"off by 0.5", "none"}
    assert np.flatnonzero(np.isnan(shown["none"][:, 0])).tolist() == [10, 11, 12, 13, 14, 15]
    assert pack({"marker": "ear"}, {"a": {"estimate": made_face.truth().keep(())}}) is None
    assert pack(GAP, {}) is None


def test_a_gap_of_45_frames_and_17_methods_takes_little() -> None:
    random = np.random.default_rng(0)
    markers = tuple(f"L_marker{k}" for k in range(60))
    paths = random.normal(0, 60, (60, 3)) + random.normal(0, 1, (600, 60, 3)).cumsum(axis=0)
    truth = Trajectories(positions=paths, markers=markers, rate=60.0)
    hidden = np.zeros((600, 60), bool)
    hidden[200:245, 5] = True
    changed = paths.copy()
    given = {}
    for method in range(17):
        changed = changed.copy()
        changed[200:245, 5] += random.normal(0, 1, (45, 3))
        estimate = replace(truth, positions=changed)
        given[f"method {method}"] = {"estimate": estimate, "truth": truth}
    view = packed({"marker": markers[5], "start": 200, "frames": 45}, given)
    assert len(json.dumps(view, separators=(",", ":"))) < 20_000
    long = packed({"marker": markers[5], "start": 10, "frames": 500}, given)
    assert (long["every"], long["frames"]) == (2, 300)
    assert long["frames"] <= MOST_FRAMES
    assert np.abs(unpacked.truth(long) - paths[::2, 5]).max() < 0.01

"""Specimens are what their names say, and those of one name belong together."""

from __future__ import annotations

import numpy as np

from nodegraph_mocap import Origin
from nodegraph_mocap.shape_names import matched
from nodegraph_mocap.specimens import (
    animations,
    heads,
    masks,
    models,
    recordings,
    selections,
    weights,
)


def test_recordings_are_what_their_names_say() -> None:
    cases = recordings()
    gaps = ~cases["gaps"].present
    assert cases["complete"].present.all()
    assert gaps[0].any()
    assert gaps[-1].any()
    assert gaps.sum(axis=1).max() == 1
    assert (~cases["several markers missing at once"].present).sum(axis=1).max() > 2
    assert not cases["a marker never seen"].present.any(axis=0).all()
    assert not cases["a frame without any marker"].present.any(axis=1).all()
    assert [cases[name].frames for name in ("one frame", "two frames")] == [1, 2]
    assert cases["one marker"].markers == ("nose",)
    assert not cases["all missing"].present.any()
    assert not cases["another memory order"].positions.flags.c_contiguous
    assert set(np.unique(cases["filled, repaired and with sigma"].origin)) == set(Origin)


def test_a_mask_hides_samples_that_its_recording_has() -> None:
    cases = recordings()
    for name, mask in masks().items():
        assert mask.markers == cases[name].markers
        assert not np.any(mask.hidden & ~cases[name].present)
    assert masks()["complete"].hidden.any()


def test_selections_choose_markers_of_the_recordings_of_their_names() -> None:
    for name, value in selections().items():
        assert set(value.chosen) <= set(recordings()[name].markers)


def test_recording_model_head_and_weights_are_one_face() -> None:
    model = models()["complete"]
    head, driven = heads()["complete"], weights()["complete"]
    assert recordings()["complete"].markers == model.markers == head.markers
    assert model.names == head.names == driven.names
    np.testing.assert_array_equal(head.vertices[head.marker_vertices], model.neutral)
    np.testing.assert_array_equal(head.morphs[:, head.marker_vertices], model.shapes)
    assert driven.frames == recordings()["complete"].frames


def test_heads_and_weights_are_what_their_names_say() -> None:
    assert not heads()["a head without markers"].markers
    assert not heads()["a head without morph targets"].names
    cases = weights()
    assert np.isnan(cases["gaps"].values).any(axis=0).tolist() == [True, True, False]
    np.testing.assert_array_equal(cases["gaps"].values, animations()["gaps"].weights.values)
    names = cases["complete"].names
    assert set(matched(cases["weights of another program"].names, names).values()) == {
        "mouthSmileRight",
        "jawOpen",
    }

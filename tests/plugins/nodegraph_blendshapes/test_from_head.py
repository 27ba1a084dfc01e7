from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from nodegraph import Refusal
from nodegraph_blendshapes.from_head import from_head
from nodegraph_files.readers import read_head, read_marker_set, read_model
from nodegraph_mocap import MarkerSet
from nodegraph_mocap.specimens import heads, models
from tests.studies import DATA, needs_recordings

FACECAP = DATA / "facecap"
MODEL = models()["complete"]
HEAD = heads()["complete"]


def test_the_specimens_head_and_model_are_one_face() -> None:
    model = from_head(HEAD).model
    assert (model.names, model.markers) == (MODEL.names, MODEL.markers)
    np.testing.assert_array_equal(model.neutral, MODEL.neutral)
    np.testing.assert_array_equal(model.shapes, MODEL.shapes)


def test_shapes_are_the_morph_targets_at_the_marker_s_vertices() -> None:
    head = replace(HEAD, markers=("b", "a"), marker_vertices=np.array([7, 2]))
    model, neutral = from_head(head, MarkerSet(markers=("a", "b"), pairs=(("a", "b"),)))
    assert model.markers == ("b", "a")
    np.testing.assert_array_equal(model.neutral, HEAD.vertices[[7, 2]])
    for shape, morph in zip(model.shapes, HEAD.morphs, strict=True):
        np.testing.assert_array_equal(shape[0], morph[7])
        np.testing.assert_array_equal(shape[1], morph[2])
    np.testing.assert_array_equal(neutral.positions[0], model.neutral)
    assert neutral.marker_set is not None
    assert neutral.marker_set.pairs == (("a", "b"),)
    assert from_head(head).neutral.marker_set is None


def test_a_head_without_marker_vertices_is_refused() -> None:
    head = replace(HEAD, markers=(), marker_vertices=np.zeros(0, np.int64))
    with pytest.raises(
        Refusal, match=r"does not say which vertices carry markers; give read\.head"
    ):
        from_head(head)


def test_a_head_without_morph_targets_is_refused() -> None:
    with pytest.raises(Refusal, match="the head has no morph targets"):
        from_head(replace(HEAD, names=(), morphs=np.zeros((0, 10, 3))))


def test_a_marker_set_of_another_head_is_an_error() -> None:
    other = MarkerSet(markers=("nose", "chin"))
    with pytest.raises(ValueError, match="the marker set names chin, which the model lacks; it ha"):
        from_head(HEAD, other)


def test_a_morph_target_that_the_markers_do_not_see_is_reported() -> None:
    head = replace(HEAD, morphs=HEAD.morphs * np.array([1.0, 0.0, 1.0])[:, None, None])
    with pytest.warns(UserWarning, match="1 of 3 shapes move no marker: mouthSmileLeft"):
        from_head(head)


@needs_recordings
@pytest.mark.filterwarnings("ignore:.*mm is taken, giving 235.7 mm")
@pytest.mark.filterwarnings("ignore:1 of 52 shapes move no marker. tongueOut")
def test_a_published_head_gives_its_published_model() -> None:
    known = read_model(path=FACECAP / "model_60_markers.npz").model
    model, neutral = from_head(
        read_head(path=FACECAP), read_marker_set(path=FACECAP / "markers.yaml")
    )
    assert (model.names, model.markers) == (known.names, known.markers)
    np.testing.assert_array_equal(model.neutral, known.neutral)
    # the file of the head holds its morph targets in half precision
    np.testing.assert_array_equal(model.shapes, known.shapes.astype(np.float16))
    np.testing.assert_allclose(model.shapes, known.shapes, rtol=0, atol=0.015)
    assert neutral.marker_set is not None
    assert set(neutral.marker_set.markers) == set(known.markers)

"""Landmarks come from the user or from a marker set, and are what both recordings have."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import nodegraph as ng
from nodegraph import Refusal
from nodegraph_align.landmarks import landmarks_of
from nodegraph_mocap import MarkerSet, Trajectories
from tests.plugins.nodegraph_align.heads import make_recording


@pytest.fixture
def face() -> Trajectories:
    return make_recording(np.zeros((1, 8, 3)), stable=4)


def test_stable_markers_of_the_references_where_the_recordings_says_nothing(
    face: Trajectories,
) -> None:
    for marker_set in (None, MarkerSet(markers=face.markers)):
        bare = replace(face, marker_set=marker_set)
        assert landmarks_of(bare, face, None)[0] == ("m0", "m1", "m2", "m3")


def test_the_recordings_marker_set_comes_first(face: Trajectories) -> None:
    other = MarkerSet(markers=face.markers, stable=("m5", "m6", "m7"))
    assert landmarks_of(replace(face, marker_set=other), face, None)[0] == ("m5", "m6", "m7")


def test_stable_markers_that_one_of_them_lacks_are_reported(face: Trajectories) -> None:
    chosen, notes = landmarks_of(face, face.keep(["m7", "m3", "m0", "m1"]), None)
    assert chosen == ("m0", "m1", "m3")
    assert notes == ["1 stable markers are not landmarks, as not all have them: m2"]


def test_no_stable_marker_at_all(face: Trajectories) -> None:
    bare = replace(face, marker_set=None)
    for reference in (None, bare):
        with pytest.raises(ValueError, match="give `landmarks`"):
            landmarks_of(bare, reference, None)


def test_too_few_stable_ones(face: Trajectories) -> None:
    with pytest.raises(Refusal, match=r"of m0, m1, m2, m3 they have m0, m1$"):
        landmarks_of(face, face.keep(["m0", "m1", "m7"]), None)


@pytest.mark.parametrize(
    ("names", "text"),
    [
        (["m0", "m1"], "landmarks: must be 3 or more, or [*] alone, got m0, m1"),
        ([], "landmarks: must be 3 or more, or [*] alone, got none"),
        (["*", "m1"], "landmarks: must be 3 or more, or [*] alone, got [*], m1"),
        (["m0", "m1", "m0", "m2"], "landmarks: the recording: duplicate markers m0"),
        (
            ["m0", "M1", "nose"],
            "the recording has no marker 'M1' [(]did you mean 'm1'[?][)]; 'nose'; it has m0, m1",
        ),
    ],
)
def test_names_that_will_not_do(face: Trajectories, names: list[str], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        landmarks_of(face, face, names)


def test_a_name_that_the_reference_lacks(face: Trajectories) -> None:
    with pytest.raises(ValueError, match="the reference has no marker 'm2'"):
        landmarks_of(face, face.keep(["m0", "m1", "m7"]), ["m0", "m1", "m2"])


def test_a_star_is_every_marker_that_both_have_and_names_keep_their_order(
    face: Trajectories,
) -> None:
    assert landmarks_of(face, None, ["*"]) == (face.markers, [])
    assert landmarks_of(face, None, ["m6", "m0", "m5"]) == (("m6", "m0", "m5"), [])
    part = face.keep(["m7", "m3", "m5"])
    assert landmarks_of(face, part, ("*",)) == (("m3", "m5", "m7"), [])


ALIGNMENTS = ("procrustes", "trimmed", "huber", "generalized")


def graph_of(folder: Path, align: str, landmarks: str) -> Path:
    graph = folder / "graph.yaml"
    graph.write_text(
        f"""\
nodegraph: 1
inputs: {{path: "sample:actor_a"}}
nodes:
  capture: {{use: read.recording, with: {{path: $path}}}}
  face: {{use: align.{align}, in: capture, with: {{landmarks: {landmarks}}}}}
"""
    )
    return graph


@pytest.mark.parametrize("landmarks", ["[a, b]", '["*", a]'])
@pytest.mark.parametrize("align", ALIGNMENTS)
def test_a_graph_with_too_few_is_not_loaded(align: str, landmarks: str, tmp_path: Path) -> None:
    with pytest.raises(ng.GraphError) as error:
        ng.load(graph_of(tmp_path, align, landmarks))
    text = f"face: setting 'landmarks' of align.{align} must be 3 or more, or * alone, got ["
    assert text in str(error.value)


@pytest.mark.parametrize("landmarks", ["[a, b, c]", '["*"]'])
@pytest.mark.parametrize("align", ALIGNMENTS)
def test_a_graph_with_enough_is_loaded(align: str, landmarks: str, tmp_path: Path) -> None:
    ng.load(graph_of(tmp_path, align, landmarks))

"""Whole files: what is read of them, and that one, however damaged, is no more than refused."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nodegraph_files import head_bytes
from nodegraph_files.glb.buffers import joined_glb, split_glb
from nodegraph_files.glb.reading import read_glb
from nodegraph_mocap.specimens import heads
from tests.studies import DATA, needs_recordings

HEAD = heads()["complete"]
CONTENT = head_bytes(HEAD)
FACECAP = DATA / "facecap"


@pytest.fixture
def file(tmp_path: Path) -> Callable[..., Path]:
    """What writes the head's file with changes to its JSON, and returns its path."""

    def written(change: Callable[[dict[str, Any]], object] = lambda document: None) -> Path:
        text, binary = split_glb(CONTENT)
        document = json.loads(text)
        change(document)
        path = tmp_path / "it.glb"
        path.write_bytes(joined_glb(document, binary))
        return path

    return written


def test_a_head_is_read(file: Callable[..., Path]) -> None:
    head = read_glb(file())
    np.testing.assert_allclose(head.vertices * 1000, HEAD.vertices, rtol=1e-7)
    np.testing.assert_array_equal(head.faces, HEAD.faces)
    assert tuple(head.morphs) == HEAD.names
    assert (head.unit, head.unit_stated) == ("m", True)
    assert tuple(head.marker_vertices) == HEAD.markers


def test_a_file_of_another_program_does_not_state_its_unit(file: Callable[..., Path]) -> None:
    assert not read_glb(file(lambda document: document["asset"].pop("extras"))).unit_stated


def test_meshes_without_morph_targets_are_left_out_beside_others(
    file: Callable[..., Path],
) -> None:
    def with_more(document: dict[str, Any]) -> None:
        primitive = {"attributes": {"POSITION": 0}, "indices": 1}
        document["meshes"].append({"name": "teeth", "primitives": [primitive]})
        document["nodes"] += [{"mesh": 1}, {"mesh": 0}]
        document["scenes"] = [{"nodes": [1, 0]}]

    with pytest.warns(UserWarning, match="1 meshes without morph targets are left out: teeth"):
        head = read_glb(file(with_more))
    assert len(head.vertices) == len(HEAD.vertices)


def test_meshes_with_morph_targets_are_one_head(file: Callable[..., Path]) -> None:
    def with_more(document: dict[str, Any]) -> None:
        primitive = {"attributes": {"POSITION": 0}, "indices": 1, "targets": [{"POSITION": 2}]}
        extras = {"targetNames": ["jawOpen"]}
        document["meshes"].append({"primitives": [primitive], "extras": extras})
        document["nodes"].append({"mesh": 1, "translation": [0.5, 0, 0]})
        document["scenes"] = [{"nodes": [0, 1]}]

    head = read_glb(file(with_more))
    count = len(HEAD.vertices)
    assert tuple(head.morphs) == HEAD.names
    np.testing.assert_allclose(head.vertices[count:] - [0.5, 0, 0], head.vertices[:count])
    np.testing.assert_array_equal(head.faces[len(HEAD.faces) :], HEAD.faces + count)
    jaw, smile = head.morphs["jawOpen"], head.morphs["mouthSmileLeft"]
    np.testing.assert_array_equal(jaw[count:], jaw[:count])
    assert not smile[count:].any()


def test_a_head_without_morph_targets_is_read(file: Callable[..., Path]) -> None:
    def plain(document: dict[str, Any]) -> None:
        document["meshes"][0]["primitives"][0].pop("targets")
        document["meshes"][0] |= {"weights": [], "extras": {}}

    head = read_glb(file(plain))
    assert len(head.vertices) == len(HEAD.vertices)
    assert (head.morphs, head.marker_vertices) == ({}, {})


@pytest.mark.parametrize("where", ["meshes", "nodes"])
def test_morph_targets_that_are_shown_from_the_start_are_reported(
    file: Callable[..., Path], where: str
) -> None:
    path = file(lambda document: document[where][0].update(weights=[0, 0.5, 1]))
    with pytest.warns(UserWarning, match="2 morph targets have a weight from the start"):
        head = read_glb(path)
    np.testing.assert_allclose(head.vertices * 1000, HEAD.vertices, rtol=1e-7)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda document: document.update(nodes=[{}], scenes=[]), "it shows no mesh"),
        (lambda document: document.update(nodes=[], meshes=[], scenes=[]), "it shows no mesh"),
        (lambda document: document["nodes"][0].update(mesh=3), "node 0: there is no mesh 3"),
        (
            lambda document: document["accessors"][0].update(count=10**15),
            "accessor 0: 1000000000000000 values need 12000000000000000 bytes",
        ),
        (
            lambda document: document["accessors"][0].update(count=1000),
            "accessor 0: 1000 values need 12000 bytes, but buffer view 0 has 120",
        ),
        (
            lambda document: document.update(extensionsRequired=["KHR_draco_mesh_compression"]),
            "its meshes are compressed",
        ),
        (
            lambda document: (
                document.update(scenes=[{"nodes": [0, 1]}]),
                document["nodes"].append({"mesh": 0}),
            ),
            "two meshes name the same marker",
        ),
    ],
)
def test_a_file_without_a_usable_head_is_refused(
    file: Callable[..., Path], change: object, message: str
) -> None:
    with pytest.raises(ValueError, match=rf"it\.glb: not a readable GLB head: .*{message}"):
        read_glb(file(change))


@needs_recordings
def test_a_real_head_is_read() -> None:
    head = read_glb(FACECAP / "head.glb")
    assert (head.vertices.shape, head.faces.shape, len(head.morphs)) == ((2659, 3), (5032, 3), 52)
    assert (head.unit, head.unit_stated) == ("m", False)
    assert head.extent == pytest.approx(235.66, abs=0.01)

"""Each file is read by the node of its format, whatever its name."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import nodegraph as ng
from nodegraph.errors import NodegraphError
from nodegraph.execute.read_files import ReadFile, read_files
from nodegraph.plugin.registry import default_registry
from nodegraph_mocap.specimens import animations, masks, models, recordings, selections, weights

FACE = recordings()["complete"]


def read(path: Path | str) -> ReadFile:
    (file,) = read_files([str(path)], default_registry())
    return file


def written(folder: Path, node: str, value: object, **settings: object) -> Path:
    """Return the file that a node writes of a value."""
    files = ng.get_node(node)(value, **settings)
    ((name, content),) = files.content.items()
    path = folder / str(name)
    path.write_bytes(content)
    return path


@pytest.mark.parametrize(
    ("node", "value", "reader"),
    [
        ("write.c3d", FACE, "read.recording"),
        ("write.trc", FACE, "read.recording"),
        ("write.csv", FACE, "read.recording"),
        ("write.npz", FACE, "read.recording"),
        ("write.weights_csv", weights()["complete"], "read.weights"),
        ("write.model_npz", models()["complete"], "read.model"),
        ("write.marker_set_yaml", FACE.marker_set, "read.marker_set"),
        ("write.mask_csv", masks()["complete"], "read.marks"),
        ("write.selection_yaml", selections()["complete"], "read.selection"),
        ("write.glb", animations()["complete"], "read.animation"),
    ],
)
def test_what_is_written_is_read_by_its_reader(
    tmp_path: Path, node: str, value: object, reader: str
) -> None:
    path = written(tmp_path, node, value)
    file = read(path)
    assert (file.node, bool(file.facts)) == (reader, True)
    folder = tmp_path / "folder"
    folder.mkdir()
    name = "markers" if reader == "read.marker_set" else reader.removeprefix("read.")
    shutil.move(path, folder / (name + path.suffix))
    assert read(folder).node == reader


@pytest.mark.parametrize(
    ("text", "reader"),
    [
        ("frame,time,nose.X,nose.Y,nose.Z\n0,0.0,1,2,3\n1,0.1,1,2,4\n", "read.recording"),
        ("time,marker,x,y,z\n0.0,nose,1,2,3\n0.1,nose,1,2,4\n", "read.recording"),
        ("time,jawOpen,eyeBlinkLeft\n0.0,0.1,0.2\n0.1,0.2,0.3\n", "read.weights"),
    ],
)
def test_tables_that_begin_alike_are_told_apart(tmp_path: Path, text: str, reader: str) -> None:
    path = tmp_path / "table.csv"
    path.write_text(text)
    assert read(path).node == reader


def test_the_samples_are_recordings_and_say_so() -> None:
    facts = {fact.name: fact.text for fact in read("sample:face").facts}
    assert (facts["frames"], facts["rate"], facts["duration"]) == ("600", "60 Hz", "10 s")
    assert facts["missing samples"] == "1,800"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"\x1f\x8b\x08\x00rest", "compressed by gzip; unpack it first"),
        (b"C3D?", "no node reads it; formats that are read: "),
        (b"", "no node reads it"),
    ],
)
def test_a_file_of_another_format_is_named(tmp_path: Path, content: bytes, message: str) -> None:
    path = tmp_path / "take.zip"
    path.write_bytes(content)
    with pytest.raises(NodegraphError, match=message):
        read(path)


def test_a_damaged_archive_is_a_damaged_recording(tmp_path: Path) -> None:
    path = written(tmp_path, "write.npz", FACE)
    whole = path.read_bytes()
    directory = whole.rindex(b"PK\x01\x02")
    newer = whole[: directory + 6] + b"\xff" + whole[directory + 7 :]  # version of ZIP
    for content in (whole[:300], newer):
        path.write_bytes(content)
        with pytest.raises(NodegraphError, match=rf"{path.name}: not a readable NPZ recording"):
            read(path)

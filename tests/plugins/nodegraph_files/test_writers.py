"""What is written reads back: by the nodes, from the folder of a run, and by hand."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from nodegraph import Files
from nodegraph.cli.main import main
from nodegraph_files import writers
from nodegraph_files.readers import read_marker_set, read_model, read_recording
from nodegraph_mocap import Origin, Trajectories
from nodegraph_mocap.specimens import marker_sets, recordings

WRITERS = (writers.write_c3d, writers.write_trc, writers.write_csv, writers.write_npz)
TOLERANCE = {".c3d": 1e-5, ".trc": 0.0, ".csv": 0.0, ".npz": 0.0}
GRAPH = """\
nodegraph: 1
title: Files
inputs: {recording: "sample:face"}
nodes:
  face: {use: read.recording, with: {path: $recording}}
  fill: {in: face, alternatives: {linear: {use: fill.linear}, muscle: {use: fill.muscle}}}
  out: {use: write.npz, in: fill, with: {name: filled}}
"""


def written(files: Files, folder: Path) -> Path:
    ((name, content),) = files.content.items()
    (folder / name).write_bytes(content)
    return folder / name


@pytest.mark.parametrize("writer", WRITERS, ids=lambda value: str(value.__name__))
@pytest.mark.parametrize("specimen", ["complete", "gaps", "a marker never seen", "one frame"])
def test_what_is_written_reads_back(
    writer: Callable[..., Files], specimen: str, tmp_path: Path
) -> None:
    recording = recordings()[specimen]
    path = written(writer(recording, name="a take"), tmp_path)
    assert path.stem == "a take"
    back = read_recording(path=path)
    assert (back.markers, back.rate) == (recording.markers, recording.rate)
    np.testing.assert_array_equal(back.present, recording.present)
    np.testing.assert_allclose(
        back.positions, recording.positions, rtol=0, atol=TOLERANCE[path.suffix]
    )


@pytest.mark.parametrize("writer", WRITERS[:3], ids=lambda value: str(value.__name__))
def test_what_a_form_cannot_say_is_told(writer: Callable[..., Files]) -> None:
    recording = recordings()["filled, repaired and with sigma"]
    processed = np.isin(recording.origin, (Origin.FILLED, Origin.REPAIRED)).sum()
    with pytest.warns(
        UserWarning, match=f"which {processed} samples are filled or repaired, sigma"
    ):
        writer(recording)


def test_npz_keeps_all(tmp_path: Path) -> None:
    recording = recordings()["filled, repaired and with sigma"]
    back = read_recording(path=written(writers.write_npz(recording), tmp_path))
    assert back.marker_set == recording.marker_set
    np.testing.assert_array_equal(back.origin, recording.origin)
    np.testing.assert_array_equal(back.sigma, recording.sigma)


def test_a_marker_set_reads_back(tmp_path: Path) -> None:
    marker_set = marker_sets()["complete"]
    path = written(writers.write_marker_set(marker_set), tmp_path)
    assert path.name == "markers.yaml"
    assert read_marker_set(path=path) == marker_set
    assert read_marker_set(path=tmp_path) == marker_set


def test_a_model_reads_back(tmp_path: Path) -> None:
    model = read_model(path=Path("sample:actor_a")).model
    back = read_model(path=written(writers.write_model(model), tmp_path)).model
    assert (back.names, back.markers) == (model.names, model.markers)
    np.testing.assert_array_equal(back.shapes, model.shapes)
    np.testing.assert_array_equal(back.neutral, model.neutral)


def test_a_suffix_is_not_doubled_and_a_name_stays_in_its_folder() -> None:
    recording = recordings()["one frame"]
    assert list(writers.write_csv(recording, name="take.CSV").content) == ["take.CSV"]
    with pytest.raises(ValueError, match=r"'\.\./take\.csv' is not a file name"):
        writers.write_csv(recording, name="../take")


@pytest.mark.parametrize("suffix", [".c3d", ".trc", ".csv", ".npz"])
def test_a_run_writes_files_and_exports_values(
    suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("files.yaml").write_text(GRAPH)
    assert main(["run", "files.yaml"]) == 0
    filled = read_recording(path=Path("runs/files/out_fill-muscle/filled.npz"))
    assert np.any(filled.origin == Origin.FILLED)
    out = f"exported{suffix}"
    assert main(["export", "runs/files", "fill", "--at", "fill=muscle", "--out", out]) == 0
    back = read_recording(path=Path(out), marker_set=Path("sample:face"))
    same(back, filled, TOLERANCE[suffix], whole=suffix == ".npz")


def same(back: Trajectories, filled: Trajectories, tolerance: float, *, whole: bool) -> None:
    expected = filled if whole else replace(filled, origin=(filled.present).astype(np.uint8))
    assert (back.markers, back.rate, back.marker_set) == (
        filled.markers,
        filled.rate,
        filled.marker_set,
    )
    np.testing.assert_array_equal(back.origin, expected.origin)
    np.testing.assert_allclose(back.positions, filled.positions, rtol=0, atol=tolerance)

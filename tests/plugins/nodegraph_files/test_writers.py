"""What is written reads back: by the nodes, from the folder of a run, and by hand."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from nodegraph import Files
from nodegraph.cli.main import main
from nodegraph_files import writers
from nodegraph_files.readers import read_marker_set, read_model, read_recording
from nodegraph_mocap import Mask, Origin, Selection, Trajectories, Weights
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

SCORES = """\
nodegraph: 1
title: Gaps of three lengths, one of them too long
axes: {length: [5, 9, 5000]}
nodes:
  face: {use: read.recording, with: {path: "sample:face"}}
  gaps: {use: gaps.cut, in: face, with: {length: $length, count: 3}}
  fill: {use: fill.linear, in: gaps}
  error: {use: score.gaps, in: {estimate: fill, truth: gaps.truth, hidden: gaps.hidden}}
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
def test_what_a_form_cannot_say_is_reported(writer: Callable[..., Files]) -> None:
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


def test_weights_masks_and_selections_are_written_for_other_programs(tmp_path: Path) -> None:
    values = np.array([[0.5, np.nan], [1.0, 0.25]])
    weights = Weights(values=values, names=("jawOpen", "smile, left"), rate=50.0)
    hidden = np.array([[True, False], [True, True], [False, False], [True, False]])
    mask = Mask(hidden=hidden, markers=("a", "b"))
    selection = Selection(
        chosen=("c", "l", "r"),
        pairs=(("l", "r"), ("c",), ("d",)),
        frequencies=np.array([1.0, 0.75, 0.0]),
        columns=("k", "error"),
        history=np.array([[2.0, np.nan], [3.0, 0.5]]),
    )
    assert written(writers.write_weights(weights), tmp_path).read_text() == (
        'time,jawOpen,"smile, left"\n0.0,0.5,\n0.02,1.0,0.25\n'
    )
    assert written(writers.write_mask(mask), tmp_path).read_text() == (
        "marker,start,frames\na,0,2\na,3,1\nb,1,1\n"
    )
    text = written(writers.write_selection(selection, name="kept"), tmp_path).read_text()
    assert yaml.safe_load(text) == {
        "chosen": ["c", "l", "r"],
        "pairs": [["l", "r"], ["c"], ["d"]],
        "frequencies": [1.0, 0.75, 0.0],
        "columns": ["k", "error"],
        "history": [[2.0, None], [3.0, 0.5]],
    }
    bare = writers.write_selection(Selection(chosen=("a",)))
    assert bare.content == {"selection.yaml": b"chosen: [a]\n"}


def test_the_rows_of_a_score_at_all_labels_are_exported_as_one_table(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("scores.yaml").write_text(SCORES)
    assert main(["run", "scores.yaml", "--store", "kept"]) == 1
    words = ("export", "runs/scores", "error", "--store", "kept", "--out")
    assert main([*words, "all.csv"]) == 0
    rows = pd.read_csv("all.csv")
    assert list(rows.columns[:3]) == ["length", "gap", "marker"]
    assert rows["length"].tolist() == [5, 5, 5, 9, 9, 9, 5000]
    assert (rows["frames"] == rows["length"])[:6].all()
    assert rows["state"].tolist() == ["done"] * 6 + ["skipped"]
    assert "3 gaps of 5000 frames" in rows["reason"][6]
    capsys.readouterr()
    assert main(["export", "runs/scores", "gaps", "--store", "kept", "--out", "gappy.csv"]) == 2
    err = capsys.readouterr().err
    assert "gaps has 3 values; choose a label of each axis, such as --at length=5; " in err
    assert "axes: length (5, 9, 5000)" in err

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from nodegraph_files import read_marker_set_yaml, sample_folder
from nodegraph_files.readers import read_model
from tests.studies import DATA, needs_recordings

FACECAP = DATA / "facecap"


@pytest.mark.parametrize("name", ["face", "actor_a", "actor_b", "actor_c"])
def test_a_sample_gives_its_model_and_its_face_at_rest(name: str) -> None:
    model, neutral = read_model(path=Path(f"sample:{name}"))
    assert model.shapes.shape == (len(model.names), len(model.markers), 3)
    assert neutral.markers == model.markers
    np.testing.assert_array_equal(neutral.positions, model.neutral[None])
    assert neutral.marker_set == read_marker_set_yaml(sample_folder(name) / "markers.yaml")


def test_a_file_alone_has_no_marker_set_unless_one_is_named() -> None:
    folder = sample_folder("face")
    assert read_model(path=folder / "model.npz").neutral.marker_set is None
    named = read_model(path=folder / "model.npz", marker_set=folder / "markers.yaml").neutral
    assert named.marker_set == read_marker_set_yaml(folder / "markers.yaml")


def test_a_folder_without_marker_set_is_read(tmp_path: Path) -> None:
    shutil.copy(sample_folder("face") / "model.npz", tmp_path)
    assert read_model(path=tmp_path).neutral.marker_set is None


def test_a_marker_set_of_other_markers_is_refused(tmp_path: Path) -> None:
    shutil.copy(sample_folder("face") / "model.npz", tmp_path)
    (tmp_path / "markers.yaml").write_text("markers: [M_nose1, chin]\n")
    with pytest.raises(ValueError, match=r"model\.npz: the marker set names chin, which"):
        read_model(path=tmp_path)


@needs_recordings
def test_a_real_model_is_read() -> None:
    path = FACECAP / "model_60_markers.npz"
    model, neutral = read_model(path=path, marker_set=FACECAP / "markers.yaml")
    assert model.shapes.shape == (52, 60, 3)
    assert neutral.marker_set is not None
    with np.load(path) as stored:
        np.testing.assert_array_equal(model.neutral, stored["neutral"])
        assert model.names == tuple(stored["shape_names"].tolist())

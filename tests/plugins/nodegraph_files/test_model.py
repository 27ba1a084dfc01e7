from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nodegraph.testing import same
from nodegraph_files import model_bytes, read_model_npz, sample_folder
from nodegraph_mocap import BlendshapeModel
from nodegraph_mocap.specimens import models


def arrays(**changes: object) -> dict[str, object]:
    given = {
        "neutral": np.zeros((2, 3), np.float32),
        "shapes": np.ones((1, 2, 3)),
        "shape_names": np.array(["smile"]),
        "markers": np.array(["a", "b"]),
    }
    return {name: value for name, value in {**given, **changes}.items() if value is not None}


def written(folder: Path, content: dict[str, Any]) -> Path:
    path = folder / "model.npz"
    np.savez(path, **content)
    return path


def test_what_is_written_reads_back(tmp_path: Path) -> None:
    model = models()["complete"]
    path = tmp_path / "model.npz"
    path.write_bytes(model_bytes(model))
    assert same(read_model_npz(path), model)
    assert model_bytes(model) == model_bytes(read_model_npz(path))


def test_a_model_without_shapes_reads_back(tmp_path: Path) -> None:
    model = BlendshapeModel(neutral=np.ones((1, 3)), shapes=np.zeros((0, 1, 3)), names=(),
                            markers=("nose",))  # fmt: skip
    path = tmp_path / "model.npz"
    path.write_bytes(model_bytes(model))
    assert same(read_model_npz(path), model)


def test_the_samples_are_what_is_written_today() -> None:
    for name in ("face", "actor_a", "actor_b", "actor_c"):
        path = sample_folder(name) / "model.npz"
        with np.load(path) as there, np.load(BytesIO(model_bytes(read_model_npz(path)))) as here:
            assert there.files == here.files
            for array in there.files:
                np.testing.assert_array_equal(there[array], here[array])


def test_more_arrays_may_be_there(tmp_path: Path) -> None:
    model = read_model_npz(written(tmp_path, arrays(observable=np.array([True]))))
    assert (model.names, model.markers) == (("smile",), ("a", "b"))
    assert model.neutral.dtype == np.float64


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"shapes": None}, "no array shapes; there is neutral, shape_names, markers"),
        ({"neutral": np.zeros((3, 3))}, r"neutral: must be \(2, 3\), got \(3, 3\)"),
        ({"shapes": np.ones((2, 2, 3))}, r"shapes: must be \(1, 2, 3\)"),
        ({"shapes": np.full((1, 2, 3), np.nan)}, r"shapes: missing \(NaN\) at \(0, 0, 0\)"),
        ({"markers": np.array(["a", "a"])}, "markers: named twice: a"),
        ({"markers": np.array([1, 2])}, "array 'markers' is of type int64"),
        ({"neutral": np.zeros((2, 3), complex)}, "array 'neutral' is of type complex128"),
        ({"neutral": np.array([None])}, "array 'neutral' is of type object"),
    ],
)
def test_a_bad_model_is_refused(tmp_path: Path, changes: dict[str, object], message: str) -> None:
    path = written(tmp_path, arrays(**changes))
    with pytest.raises(ValueError, match=rf"model\.npz: not a readable NPZ model: {message}"):
        read_model_npz(path)

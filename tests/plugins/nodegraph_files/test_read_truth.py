"""The noise-free recording beside a recording, or the recording itself."""

from __future__ import annotations

import shutil
import warnings
from pathlib import Path

import numpy as np
import pytest

from nodegraph_files import sample_folder
from nodegraph_files.readers import read_recording, read_truth


@pytest.mark.parametrize("as_folder", [False, True], ids=["sample", "folder"])
def test_the_truth_of_a_folder_is_complete_and_of_the_same_markers(as_folder: bool) -> None:
    path = sample_folder("face_1") if as_folder else Path("sample:face_1")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        truth = read_truth(path=path)
    recording = read_recording(path=path)
    assert (truth.markers, truth.rate, truth.marker_set, truth.frames) == (
        recording.markers,
        recording.rate,
        recording.marker_set,
        recording.frames,
    )
    assert truth.present.all()
    errors = np.linalg.norm(truth.positions - recording.positions, axis=2)
    assert np.nanmedian(errors) == pytest.approx(0.03 * np.sqrt(2.366), rel=0.05)  # chi2, df 3


@pytest.mark.parametrize("name", ["recording.npz", "", "truth.npz"])
def test_without_a_truth_the_recording_is_its_own_and_a_warning_says_so(
    name: str, tmp_path: Path
) -> None:
    """A truth beside counts only where the folder is named: a file's key is its own content."""
    shutil.copy(sample_folder("face_1") / "recording.npz", tmp_path)
    if name:
        shutil.copy(sample_folder("face_1") / "truth.npz", tmp_path)
    with pytest.warns(UserWarning, match="no noise-free truth") as caught:
        truth = read_truth(path=tmp_path / name)
    assert str(tmp_path / name) in str(caught[0].message)
    np.testing.assert_array_equal(truth.positions, read_recording(path=tmp_path / name).positions)

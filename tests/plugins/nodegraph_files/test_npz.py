from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nodegraph_files import read_npz

ARRAYS: dict[str, Any] = {"positions": np.ones((4, 2, 3)), "markers": ["a", "b"], "rate": 60.0}


def saved(folder: Path, **changed: object) -> Path:
    path = folder / "take.npz"
    np.savez(path, **{name: x for name, x in (ARRAYS | changed).items() if x is not None})
    return path


@pytest.mark.parametrize("lacking", ["positions", "markers"])
def test_an_array_that_lacks_is_reported_with_those_there_are(tmp_path: Path, lacking: str) -> None:
    there = ", ".join(name for name in ARRAYS if name != lacking)
    with pytest.raises(ValueError, match=rf"take\.npz.*no array {lacking}; there is {there}"):
        read_npz(saved(tmp_path, **{lacking: None}))


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"positions": np.ones((4, 2))}, r"positions must be \(frames, markers, 3\), got \(4, 2\)"),
        ({"positions": np.ones((4, 3, 3))}, r"\(frames, 2 markers, 3\)"),
        ({"positions": np.ones((4, 2, 3), dtype=complex)}, "'positions' is of type complex128"),
        ({"positions": np.full((4, 2, 3), "a")}, "'positions' is of type"),
        ({"markers": [1, 2]}, "'markers' is of type int64"),
        ({"markers": ["a", "a"]}, "named twice: a"),
        ({"rate": [1.0, 2.0]}, ""),
        ({"rate": 0.0}, "rate must be from 0.001 to 1e6 frames"),
        ({"rate": "60"}, "'rate' is of type"),
        ({"origin": np.zeros((4, 2), dtype=np.uint8)}, "origin must call"),
        ({"origin": np.ones((4, 2))}, "'origin' is of type float64"),
        ({"sigma": np.ones(4)}, r"sigma must be \(4, 2\)"),
        ({"marker_set": "{"}, ""),
        ({"marker_set": '{"markers": ["a"], "pears": []}'}, "unknown key 'pears'"),
        ({"marker_set": "[" * 100_000}, ""),
        ({"positions": np.array([None])}, "'positions' is of type object"),
        ({"markers": np.array([None, None])}, "'markers' is of type object"),
        ({"sigma": np.array([None])}, "'sigma' is of type object"),
    ],
)
def test_wrong_arrays_are_refused(tmp_path: Path, changed: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=rf"take\.npz: not a readable NPZ recording: .*{message}"):
        read_npz(saved(tmp_path, **changed))


def test_an_archive_that_does_not_tell_origins_is_read_like_any_file(tmp_path: Path) -> None:
    positions = np.ones((4, 2, 3))
    positions[1, 0] = 0
    path = saved(tmp_path, positions=positions)
    with pytest.warns(UserWarning, match="1 samples are at exactly"):
        assert np.count_nonzero(~read_npz(path).present) == 1
    assert read_npz(path, zeros_missing=False).present.all()


def test_positions_and_their_spread_are_of_one_unit(tmp_path: Path) -> None:
    read = read_npz(saved(tmp_path, sigma=np.full((4, 2), 0.5)), unit="cm")
    assert read.sigma is not None
    assert (read.positions[0, 0, 0], read.sigma[0, 0]) == (10, 5)


def test_an_archive_that_tells_origins_keeps_its_zeros(tmp_path: Path) -> None:
    origin = np.ones((4, 2), dtype=np.uint8)
    path = saved(tmp_path, positions=np.zeros((4, 2, 3)), origin=origin)
    assert read_npz(path).present.all()


def test_what_else_an_archive_holds_is_not_read(
    tmp_path: Path, peak_memory: Callable[[], int]
) -> None:
    path = saved(tmp_path, other=np.zeros(10_000_000), more=np.array([None]))
    before = peak_memory()
    assert read_npz(path).frames == 4
    assert peak_memory() == before

"""Tables of numbered landmarks, as programs write that use MediaPipe."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest

from nodegraph import get_node

FRAMES = 3
IN_PICTURE = "478 landmarks, as MediaPipe"


def table(form: str, count: int, *, leading: str = "time", more: str = "") -> tuple[str, object]:
    """Return a table of landmarks in a picture, and its numbers."""
    numbers = np.random.default_rng(0).uniform(0.3, 0.6, (FRAMES, count, 3)).round(4)
    names = [form.format(axis=axis, n=n) for n in range(count) for axis in "xyz"]
    lines = [",".join([leading, *names])]
    for frame, row in enumerate(numbers.reshape(FRAMES, -1)):
        lines.append(",".join([f"{frame / 50:g}", *map(str, row)]))
    return more + "\n".join(lines) + "\n", numbers


@pytest.mark.parametrize("form", ["{axis}{n}", "{axis}_{n}", "landmark_{n}_{axis}"])
def test_landmarks_of_a_picture_are_warned_of(tmp_path: Path, form: str) -> None:
    text, numbers = table(form, 478)
    (tmp_path / "take.csv").write_text(text)
    read = get_node("read.recording")
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        recording = read(path=tmp_path / "take.csv")
    assert any(IN_PICTURE in str(each.message) for each in warned)
    assert recording.markers[:2] == ("landmark_0", "landmark_1")
    assert recording.rate == 50.0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        recording = read(path=tmp_path / "take.csv", unit="m")
    np.testing.assert_allclose(recording.positions, np.asarray(numbers) * 1000)


@pytest.mark.parametrize(
    ("header", "message"),
    [
        ("time,x0,y0,x1,y1", ":1: 2 markers have X and Y and no Z"),
        ("time,x0,y0,z0,x1", ":1: marker 'landmark_1' has no column for Y, Z"),
        ("time,x0,y0,z0,x_0", ":1:5: the column 'x_0' is there twice"),
        ("x0,y0,z0,u,v", ": no rate"),
    ],
)
@pytest.mark.filterwarnings("ignore:2 columns are")
def test_tables_that_lack_something_are_refused(tmp_path: Path, header: str, message: str) -> None:
    (tmp_path / "take.csv").write_text(f"{header}\n0,1,2,3,4\n1,1,2,3,5\n")
    with pytest.raises(ValueError, match=rf"take\.csv{message}"):
        get_node("read.recording")(path=tmp_path / "take.csv")

from __future__ import annotations

from pathlib import Path

import pytest

from nodegraph_files.readers import marker_set_for, with_marker_set
from nodegraph_mocap import MarkerSet, Trajectories

MARKERS = "markers: [a, é]\n"


def test_the_one_beside_counts_if_the_folder_was_named(tmp_path: Path) -> None:
    (tmp_path / "markers.yaml").write_text(MARKERS, encoding="utf-8")
    file = tmp_path / "recording.c3d"
    markers = MarkerSet(markers=("a", "é"))
    assert marker_set_for(tmp_path, file, None) == markers
    assert marker_set_for(Path("sample:x"), file, None) == markers
    assert marker_set_for(file, file, None) is None


def test_there_may_be_none_beside(tmp_path: Path) -> None:
    assert marker_set_for(tmp_path, tmp_path / "recording.c3d", None) is None


def test_one_that_is_named_comes_first(tmp_path: Path) -> None:
    (tmp_path / "markers.yaml").write_text(MARKERS, encoding="utf-8")
    other = tmp_path / "other.yaml"
    other.write_text("markers: [b]\n")
    file = tmp_path / "recording.c3d"
    for named in (tmp_path, file):
        assert marker_set_for(named, file, other) == MarkerSet(markers=("b",))


def test_a_marker_that_the_recording_lacks_is_named(gappy: Trajectories) -> None:
    file = Path("it.c3d")
    assert with_marker_set(gappy, None, file) is gappy
    known = MarkerSet(markers=("é", "a"))
    assert with_marker_set(gappy, known, file).marker_set == known
    with pytest.raises(ValueError, match=r"it\.c3d: the marker set names x, y, which .* a, b c, é"):
        with_marker_set(gappy, MarkerSet(markers=("x", "a", "y")), file)

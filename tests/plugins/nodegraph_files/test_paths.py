from __future__ import annotations

from pathlib import Path

import pytest

from nodegraph import NodegraphError
from nodegraph_files import sample_folder
from nodegraph_files.paths import find_file

WANTED = ("recording.c3d", "recording.csv")


def test_a_file_is_itself(tmp_path: Path) -> None:
    path = tmp_path / "any.name"
    path.write_text("x")
    assert find_file(path, WANTED) == find_file(str(path), WANTED) == path


def test_a_folder_gives_the_best_of_the_wanted(tmp_path: Path) -> None:
    (tmp_path / "recording.csv").write_text("x")
    assert find_file(tmp_path, WANTED) == tmp_path / "recording.csv"
    (tmp_path / "recording.c3d").write_text("x")
    assert find_file(tmp_path, WANTED) == tmp_path / "recording.c3d"


def test_a_sample_is_a_folder() -> None:
    expected = sample_folder("face") / "recording.c3d"
    assert find_file("sample:face", WANTED) == find_file(Path("sample:face"), WANTED) == expected


def test_a_folder_without_it_tells_what_is_there(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"no recording\.c3d or recording\.csv; there is none"):
        find_file(tmp_path, WANTED)
    (tmp_path / "b.txt").write_text("x")
    (tmp_path / "a.c3d").write_text("x")
    with pytest.raises(ValueError, match=r"there is a\.c3d, b\.txt"):
        find_file(tmp_path, WANTED)


def test_nothing_and_an_empty_file_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"away\.c3d: no such file"):
        find_file(tmp_path / "away.c3d", WANTED)
    (tmp_path / "empty.c3d").touch()
    with pytest.raises(ValueError, match=r"empty\.c3d: the file is empty"):
        find_file(tmp_path / "empty.c3d", WANTED)


@pytest.mark.parametrize(
    ("name", "message"),
    [("actor_aa", "did you mean 'actor_a'.*actor_b, actor_c, face, face_1"), ("..", "no sample"),
     ("", "no sample"), ("face/", "no sample"), ("../samples/face", "no sample")],
)  # fmt: skip
def test_an_unknown_sample_is_refused(name: str, message: str) -> None:
    with pytest.raises(NodegraphError, match=f"no sample {name!r}.*{message}|{message}"):
        find_file(f"sample:{name}", WANTED)

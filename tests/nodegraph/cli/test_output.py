"""Commands print aligned columns and short lists, and write files whole or not at all."""

from __future__ import annotations

import resource
from collections import Counter
from pathlib import Path

import pytest

from nodegraph import NodegraphError
from nodegraph.cli.output import (
    MOST,
    columns,
    counted,
    few,
    refuse_unwritable,
    write_file,
)


def test_columns_are_aligned() -> None:
    assert columns([("a", "bb"), ("ccc", "d")]) == "a    bb\nccc  d"
    assert columns([]) == ""


def test_counts_are_listed_by_node() -> None:
    assert counted(Counter({"fill": 4, "one": 0, "total": 1})) == "fill (4), total (1)"


def test_the_rest_of_a_long_list_is_counted() -> None:
    lines = [str(number) for number in range(MOST + 2)]
    assert list(few(lines[:MOST])) == lines[:MOST]
    assert list(few(lines))[MOST:] == ["and 2 more"]
    assert list(few(lines, "changes"))[MOST:] == ["and 2 more changes"]


def test_folders_are_made_and_files_replaced() -> None:
    for content in (b"one", b"two"):
        write_file(Path("new/deep/a.txt"), content)
        assert [path.name for path in Path("new/deep").iterdir()] == ["a.txt"]
        assert Path("new/deep/a.txt").read_bytes() == content


@pytest.mark.parametrize(
    ("place", "reason"),
    [
        ("taken/a.txt", "taken/a.txt: cannot be written: taken is a file"),
        ("taken/deep/a.txt", "taken is a file"),
        ("folder", "folder: cannot be written: it is a folder"),
        (f"{'n' * 300}.txt", "File name too long"),
        (f"{'n' * 300}/a.txt", "File name too long"),
    ],
)
def test_an_unwritable_place_is_refused_before_and_when_it_is_written(
    place: str, reason: str
) -> None:
    Path("taken").write_text("mine")
    Path("folder").mkdir()
    before = sorted(Path().rglob("*"))
    with pytest.raises(NodegraphError) as early:
        refuse_unwritable(Path(place))
    with pytest.raises(NodegraphError) as late:
        write_file(Path(place), b"x")
    for message in (str(early.value), str(late.value)):
        assert reason in message
        assert "--out" in message
    assert sorted(Path().rglob("*")) == before


def test_nothing_is_left_of_a_file_that_was_not_written_whole() -> None:
    Path("a.txt").write_text("before")
    before = sorted(Path().iterdir())
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, hard))
    try:
        with pytest.raises(NodegraphError, match=r"a\.txt: cannot be written: File too large"):
            write_file(Path("a.txt"), b"a" * 2000)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert sorted(Path().iterdir()) == before
    assert Path("a.txt").read_text() == "before"


def test_a_writable_place_is_left_as_it_was() -> None:
    before = sorted(Path().rglob("*"))
    for place in ("new.txt", "new/deep/a.txt", "toy.yaml"):
        refuse_unwritable(Path(place))
    assert sorted(Path().rglob("*")) == before

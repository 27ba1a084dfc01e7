"""What a command writes is there whole or not at all, and nothing else is left behind."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from nodegraph import NodegraphError
from nodegraph.cli.output import refuse_unwritable, write_file


def test_folders_are_made_and_files_replaced() -> None:
    for content in (b"one", b"two"):
        write_file(Path("new/deep/a.txt"), content)
        assert [one.name for one in Path("new/deep").iterdir()] == ["a.txt"]
        assert Path("new/deep/a.txt").read_bytes() == content


@pytest.mark.parametrize(
    ("place", "said"),
    [
        ("taken/a.txt", "taken/a.txt: cannot be written: taken is a file, not a folder"),
        ("taken/deep/a.txt", "taken is a file, not a folder"),
        ("folder", "folder: cannot be written: it is a folder; name a file"),
        (f"{'n' * 300}.txt", "File name too long"),
        (f"{'n' * 300}/a.txt", "File name too long"),
    ],
)
def test_a_place_that_cannot_be_is_told_before_and_when_it_is_written(
    place: str, said: str
) -> None:
    Path("taken").write_text("mine")
    Path("folder").mkdir()
    before = sorted(Path().rglob("*"))
    tries: list[Callable[[], None]] = [
        lambda: refuse_unwritable(Path(place)),
        lambda: write_file(Path(place), b"x"),
    ]
    for one in tries:
        with pytest.raises(NodegraphError) as caught:
            one()
        assert said in str(caught.value)
        assert str(caught.value).endswith("; name another place with --out")
        assert sorted(Path().rglob("*")) == before


def test_nothing_is_left_of_what_could_not_be_written_whole(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    Path("a.txt").write_text("before")
    before = sorted(Path().iterdir())
    whole = Path.write_bytes

    def full(path: Path, content: bytes) -> int:
        whole(path, content[:1])
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(NodegraphError, match=r"a\.txt: cannot be written: No space left"):
        write_file(Path("a.txt"), b"after")
    assert sorted(Path().iterdir()) == before
    assert Path("a.txt").read_text() == "before"


def test_a_place_that_can_be_is_left_as_it_was() -> None:
    before = sorted(Path().rglob("*"))
    for place in ("new.txt", "new/deep/a.txt", "toy.yaml"):
        refuse_unwritable(Path(place))
    assert sorted(Path().rglob("*")) == before

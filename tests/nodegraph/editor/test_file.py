"""An edited file keeps its bytes, every earlier text, and what other programs write."""

from __future__ import annotations

import os
import stat
from pathlib import Path

import pytest

from nodegraph.editor.file import MOST_BYTES, EditedFile
from nodegraph.editor.merge import merged
from nodegraph.errors import GraphError, NodegraphError
from tests.nodegraph.edit.graph_texts import Writer

BASE = "one\ntwo\nthree\nfour\nfive\n"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "graph.yaml"
    path.write_text(BASE)
    return path


def copy_of(path: Path) -> Path:
    return path.with_name("graph.yaml.unsaved")


@pytest.mark.parametrize("seed", range(40))
def test_an_edit_changes_no_byte_of_other_lines(tmp_path: Path, seed: int) -> None:
    path = tmp_path / "graph.yaml"
    content = Writer(seed).text.encode()
    path.write_bytes(content)
    file = EditedFile(path)
    file.edit(file.shown)
    file.save()
    assert path.read_bytes() == content
    lines = file.shown.split("\n")
    line_break = b"\r\n" if b"\r\n" in content else b"\n"
    for place in range(len(lines) - 1):
        file.edit("\n".join([*lines[:place], "# added", *lines[place:]]))
        assert file.text.encode().replace(b"# added" + line_break, b"", 1) == content
        file.edit("\n".join(lines))
        assert file.text.encode() == content


def test_every_earlier_text_comes_back(path: Path) -> None:
    file = EditedFile(path)
    for text in ("a", "b", "c"):
        file.edit(text)
    seen = []
    while file.can_undo:
        file.undo()
        seen.append(file.text)
    assert seen == ["b", "a", BASE]
    assert file.is_saved
    file.redo()
    file.edit("other")
    assert (file.text, file.can_redo) == ("other", False)
    file.undo()
    assert file.text == "a"


def test_nothing_but_the_copy_is_written_before_saving(path: Path) -> None:
    path.chmod(0o640)
    file = EditedFile(path)
    file.edit("changed")
    assert (path.read_text(), copy_of(path).read_text()) == (BASE, "changed")
    again = EditedFile(path)
    assert (again.text, again.is_saved) == ("changed", False)
    assert copy_of(path).name in again.notice
    again.undo()
    assert again.text == BASE
    again.redo()
    again.save()
    assert path.read_text() == "changed"
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    assert os.listdir(path.parent) == ["graph.yaml"]


def test_a_folder_that_cannot_be_written_is_said_and_the_edit_stays(path: Path) -> None:
    copy_of(path).mkdir()
    with pytest.raises(GraphError, match=r"graph\.yaml\.unsaved: is no regular file"):
        EditedFile(path)
    copy_of(path).rmdir()
    file = EditedFile(path)
    copy_of(path).mkdir()
    file.edit("changed")
    assert (file.text, file.can_undo) == ("changed", True)
    assert "cannot be kept" in file.notice


def test_a_link_is_followed_and_stays(path: Path, tmp_path: Path) -> None:
    link = tmp_path / "link.yaml"
    link.symlink_to(path)
    file = EditedFile(link)
    file.edit("changed")
    file.save()
    assert link.is_symlink()
    assert path.read_text() == "changed"


def test_a_new_file_begins_empty(tmp_path: Path) -> None:
    file = EditedFile(tmp_path / "new.yaml")
    assert (file.text, file.is_saved) == ("", True)
    assert os.listdir(tmp_path) == []
    file.edit("nodegraph: 1\n")
    file.save()
    assert (tmp_path / "new.yaml").read_text() == "nodegraph: 1\n"


def test_changes_of_other_lines_on_the_disk_are_taken_over(path: Path) -> None:
    file = EditedFile(path)
    file.edit(BASE.replace("one", "ONE"))
    path.write_text(BASE.replace("five", "FIVE"))
    with pytest.raises(NodegraphError, match=r"not saved: graph\.yaml has changed on the disk"):
        file.save()  # nobody has seen the merged text
    assert path.read_text() == BASE.replace("five", "FIVE")
    assert file.text == "ONE\ntwo\nthree\nfour\nFIVE\n"
    file.save()
    assert path.read_text() == file.text
    file.undo()
    assert file.text == BASE.replace("one", "ONE")


@pytest.mark.parametrize("choice", ["take_theirs", "keep_mine"])
def test_changes_of_the_same_line_wait_for_a_choice(path: Path, choice: str) -> None:
    file = EditedFile(path)
    file.edit(BASE.replace("two", "mine"))
    path.write_text(BASE.replace("two", "theirs"))
    file.look()
    revision = file.revision
    file.look()
    assert (file.revision, file.theirs) == (revision, BASE.replace("two", "theirs"))
    with pytest.raises(NodegraphError, match="not saved"):
        file.save()
    assert "theirs" in path.read_text()
    getattr(file, choice)()
    assert file.text == BASE.replace("two", choice.partition("_")[2])
    file.save()
    assert path.read_text() == file.text
    file.undo()  # the other text is not lost
    assert file.text == BASE.replace("two", "mine" if choice == "take_theirs" else "theirs")


def test_a_choice_is_withdrawn_with_the_change_on_the_disk(path: Path) -> None:
    file = EditedFile(path)
    file.edit(BASE.replace("two", "mine"))
    path.write_text(BASE.replace("two", "theirs"))
    file.look()
    path.write_text(BASE)
    file.look()
    assert file.theirs is None
    file.save()
    assert "mine" in path.read_text()


def test_a_file_that_is_removed_can_be_saved_again(path: Path) -> None:
    file = EditedFile(path)
    path.unlink()
    with pytest.raises(NodegraphError, match="was removed"):
        file.save()
    file.save()
    assert path.read_text() == BASE


@pytest.mark.parametrize(
    ("mine", "theirs", "both"),
    [
        (BASE, BASE, BASE),
        (BASE + "six\n", "zero\n" + BASE, "zero\n" + BASE + "six\n"),
        ("two\nthree\nfour\nfive\n", BASE.replace("three\n", ""), "two\nfour\nfive\n"),
        (BASE.replace("two", "2"), BASE.replace("two", "2"), BASE.replace("two", "2")),
        (BASE.replace("two", "2"), BASE.replace("three", "3"), None),
        (BASE + "6\n", BASE + "six\n", None),
        ("", BASE.replace("two", "2"), None),
    ],
)
def test_changes_that_do_not_touch_are_merged(mine: str, theirs: str, both: str | None) -> None:
    assert merged(BASE, mine, theirs) == both
    assert merged(BASE, theirs, mine) == both


def test_what_cannot_be_edited_is_refused_with_its_place(path: Path, tmp_path: Path) -> None:
    path.write_bytes(b"a\nb \xff\n")
    with pytest.raises(GraphError, match=r"graph\.yaml:2:1: not text in UTF-8: byte 0xff"):
        EditedFile(path)
    path.write_bytes(b"#" * (MOST_BYTES + 1))
    with pytest.raises(GraphError, match="too large to be edited"):
        EditedFile(path)
    with pytest.raises(GraphError, match="no regular file"):
        EditedFile(tmp_path)
    with pytest.raises(GraphError, match="there is no folder"):
        EditedFile(tmp_path / "none" / "graph.yaml")
    with pytest.raises(GraphError, match=r"no such file\n +a graph file ends in \.yaml"):
        EditedFile(tmp_path / "fill")
    file = EditedFile(tmp_path / "new.yaml")
    for text in ("\ud800", "#" * (MOST_BYTES + 1)):
        with pytest.raises(NodegraphError):
            file.edit(text)
        assert file.text == ""

"""The files that a run read are found by their content, and no two have one name."""

from __future__ import annotations

import hashlib
from pathlib import Path

from nodegraph.archive.inputs import files_read
from nodegraph.fingerprint.keys import Files
from nodegraph.runs.record import RecordedStep
from nodegraph.state import State


def step(path: str, digest: str) -> RecordedStep:
    """Return a step that read a file."""
    settings, files = {"path": path}, {"path": digest}
    return RecordedStep(0, "a", "read.file", {}, settings, {}, State.DONE, 0.0, files=files)


def test_files_of_one_name_do_not_meet_and_names_of_the_archive_are_free(tmp_path: Path) -> None:
    written = ["one/a.txt", "../two/a.txt", "run/a.txt", "a/b.txt"]
    steps = []
    (tmp_path / "g").mkdir()
    for text in written:
        path = tmp_path / "g" / text
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        digest = hashlib.sha256(text.encode()).hexdigest() + ".txt"
        steps.append(step(text, digest))
    steps.append(step("sample:x", "0"))
    found = files_read(steps, [tmp_path / "g"], {"run"}, lambda one: one.startswith("sample:"))
    assert {one.written: one.name for one in found} == {
        "one/a.txt": "one/a.txt",
        "../two/a.txt": "inputs/a.txt",
        "run/a.txt": "inputs/a-2.txt",
        "a/b.txt": "a/b.txt",
        "sample:x": "sample:x",
    }
    assert [one.size for one in found if one.is_shipped] == [0]


def test_a_folder_goes_in_with_all_its_files(tmp_path: Path) -> None:
    (tmp_path / "takes" / "deep").mkdir(parents=True)
    (tmp_path / "takes" / "deep" / "a.txt").write_text("a")
    (tmp_path / "takes" / "b.txt").write_text("bb")
    digest = Files().digest(tmp_path / "takes")
    [found] = files_read([step("takes", digest)], [tmp_path], (), lambda _: False)
    assert [name for name, _ in found.contents()] == ["takes/b.txt", "takes/deep/a.txt"]
    assert found.size == 3


def test_a_file_is_where_its_content_is_and_nowhere_else(tmp_path: Path) -> None:
    digest = hashlib.sha256(b"then").hexdigest() + ".txt"
    steps = [step("a.txt", digest)]
    folders = [tmp_path / "gone", tmp_path / "edited", tmp_path / "same"]
    for folder, text in zip(folders[1:], ("later", "then"), strict=True):
        folder.mkdir()
        (folder / "a.txt").write_text(text)
    [found] = files_read(steps, folders, (), lambda _: False)
    assert (found.path, found.name) == (folders[2] / "a.txt", "inputs/a.txt")
    [found] = files_read(steps, folders[:2], (), lambda _: False)
    assert (found.path, found.name, found.size) == (None, "a.txt", 0)

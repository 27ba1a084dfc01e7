"""Files that a run read, and their names in an archive."""

from __future__ import annotations

import hashlib
from pathlib import Path

from nodegraph.archive.inputs import files_read
from nodegraph.cache_key import FileDigests
from nodegraph.runs.record import RecordedStep
from nodegraph.state import State


def step(path: str, digest: str) -> RecordedStep:
    """Return a step that read a file."""
    settings, files = {"path": path}, {"path": digest}
    return RecordedStep(0, "a", "read.file", {}, settings, {}, State.DONE, 0.0, files=files)


def test_names_in_the_archive_are_unique(tmp_path: Path) -> None:
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
    files = files_read(steps, [tmp_path / "g"], {"run"}, lambda path: path.startswith("sample:"))
    assert {file.written: file.name for file in files} == {
        "one/a.txt": "one/a.txt",
        "../two/a.txt": "inputs/a.txt",
        "run/a.txt": "inputs/a-2.txt",
        "a/b.txt": "a/b.txt",
        "sample:x": "sample:x",
    }
    assert [file.size for file in files if file.is_shipped] == [0]


def test_a_folder_has_all_its_files(tmp_path: Path) -> None:
    (tmp_path / "takes" / "deep").mkdir(parents=True)
    (tmp_path / "takes" / "deep" / "a.txt").write_text("a")
    (tmp_path / "takes" / "b.txt").write_text("bb")
    digest = FileDigests().digest(tmp_path / "takes")
    [file] = files_read([step("takes", digest)], [tmp_path], (), lambda _: False)
    assert [name for name, _ in file.contents()] == ["takes/b.txt", "takes/deep/a.txt"]
    assert file.size == 3


def test_a_file_is_identified_by_its_content(tmp_path: Path) -> None:
    digest = hashlib.sha256(b"then").hexdigest() + ".txt"
    steps = [step("a.txt", digest)]
    folders = [tmp_path / "gone", tmp_path / "edited", tmp_path / "same"]
    for folder, text in zip(folders[1:], ("later", "then"), strict=True):
        folder.mkdir()
        (folder / "a.txt").write_text(text)
    [file] = files_read(steps, folders, (), lambda _: False)
    assert (file.path, file.name) == (folders[2] / "a.txt", "inputs/a.txt")
    [file] = files_read(steps, folders[:2], (), lambda _: False)
    assert (file.path, file.name, file.size) == (None, "a.txt", 0)

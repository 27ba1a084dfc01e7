from __future__ import annotations

import errno
import os
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from nodegraph.cli import cache
from nodegraph.store import About, Packer, Store
from tests.nodegraph.cli.conftest import Command

DAY = 86400


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A store with three results: one of a number, two of arrays, each used a day earlier."""
    folder = tmp_path / "kept"
    store = Store(folder, Packer(), print)
    about = About("toy.number", "a", "done", seconds=0.0042)
    cut = About("toy.cut", "gaps(length=5)", "done", seconds=200.0)
    refused = About("fill.strict", "fill(length=5)", "refused", "too small", seconds=3.21)
    store.save("aa" * 32, about, (1.5,))
    store.save("bb" * 32, cut, (np.zeros(500_000),))
    store.save("cc" * 32, refused, ())
    now = (folder / "format-2" / "README").stat().st_mtime
    for days, name in enumerate(("aa", "bb", "cc"), 1):
        entry = folder / "format-2" / "entries" / f"{name * 32}.json"
        os.utime(entry, (now, now - days * DAY * 10))
    for blob in (folder / "format-2" / "blobs").rglob("*"):
        os.utime(blob, (now, now - 90 * DAY))
    return folder


def test_how_much_there_is(command: Command, folder: Path) -> None:
    status, out, err = command("cache", "--store", str(folder), nodes=False)
    assert (status, err) == (0, "")
    assert out == f"3 results (4.0 MB, arrays in 1 file) in {folder}\n"


def test_the_store_of_the_environment(
    command: Command, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NODEGRAPH_STORE", str(folder))
    assert str(folder) in command("cache", nodes=False)[1]


def test_results_of_another_version_are_mentioned(command: Command, tmp_path: Path) -> None:
    (tmp_path / "format-0").mkdir()
    _, out, _ = command("cache", "--store", str(tmp_path), nodes=False)
    assert out.startswith("0 results")
    assert "other versions" in out
    assert "format-0" in out


def test_a_list_of_what_there_is_the_last_used_first(command: Command, folder: Path) -> None:
    status, out, _ = command("cache", "list", "--store", str(folder), nodes=False)
    heads, *rows, total = out.splitlines()
    cells = [re.split(r"  +", row) for row in [heads, *rows]]
    assert status == 0
    assert cells[0] == ["node", "step", "state", "size", "took", "last used"]
    assert [row[:3] for row in cells[1:]] == [
        ["toy.number", "a", "done"],
        ["toy.cut", "gaps(length=5)", "done"],
        ["fill.strict", "fill(length=5)", "refused"],
    ]
    assert [row[4:] for row in cells[1:]] == [
        ["4.2 ms", "10 d ago"],
        ["3 min", "20 d ago"],
        ["3.21 s", "30 d ago"],
    ]
    assert cells[2][3] == "4.0 MB"
    assert re.fullmatch(r"\d+ B", cells[1][3])
    assert total.startswith("3 results")


def test_a_list_is_cut_after_those_that_were_used_last(
    command: Command, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cache, "_MOST_ROWS", 2)
    _, out, _ = command("cache", "list", "--store", str(folder), nodes=False)
    _, first, second, more, _ = out.splitlines()
    assert (first.split()[0], second.split()[0], more) == ("toy.number", "toy.cut", "and 1 more")


def test_a_list_of_nothing(command: Command, tmp_path: Path) -> None:
    _, out, _ = command("cache", "list", "--store", str(tmp_path / "none"), nodes=False)
    assert out.startswith("0 results (0 B")
    assert not (tmp_path / "none").exists()


@pytest.mark.parametrize(
    ("words", "removed", "left"),
    [
        (["--older", "25d"], "1 result (", "2 results ("),
        (["--older", "360h"], "2 results (4.0 MB", "1 result ("),
        (["--older", "100000m"], "0 results (0 B", "3 results ("),
        (["--keep", "1MB"], "2 results (4.0 MB", "1 result ("),
        (["--keep", "0.005GB"], "0 results (0 B", "3 results ("),
        (["--keep", "10kb", "--older", "99d"], "2 results (4.0 MB", "1 result ("),
    ],
)
def test_the_longest_unused_goes(
    command: Command, folder: Path, words: list[str], removed: str, left: str
) -> None:
    status, out, _ = command("cache", "prune", *words, "--store", str(folder), nodes=False)
    assert status == 0
    assert out.startswith(f"removed {removed}")
    assert f"; {left}" in out
    assert command("cache", "--store", str(folder), nodes=False)[1].startswith(left)


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["prune"], "--older"),
        (["prune", "--older", "30"], "such as 30d, 12h, 45m"),
        (["prune", "--older", "-3d"], "expected one argument"),
        (["prune", "--older", "3 weeks"], "such as 30d"),
        (["prune", "--keep", "10"], "such as 10GB"),
        (["prune", "--keep", "10 gigabytes"], "such as 10GB"),
        (["clear", "--older", "30d"], "belong to `nodegraph cache prune`"),
        (["list", "--keep", "1GB"], "belong to `nodegraph cache prune`"),
    ],
)
def test_a_wrong_word_removes_nothing(
    command: Command, folder: Path, words: list[str], reason: str
) -> None:
    status, out, err = command("cache", *words, "--store", str(folder), nodes=False)
    assert status == 2
    assert out == ""
    assert reason in err
    assert command("cache", "--store", str(folder), nodes=False)[1].startswith("3 results")


def test_arrays_of_no_result_are_told(command: Command, folder: Path) -> None:
    (folder / "format-2" / "entries" / f"{'bb' * 32}.json").unlink()
    (blob,) = (folder / "format-2" / "blobs").iterdir()
    os.utime(blob)
    _, out, _ = command("cache", "prune", "--keep", "100KB", "--store", str(folder), nodes=False)
    removed, why = out.splitlines()
    assert removed.startswith("removed 0 results (0 B, arrays in 0 files); 2 results (4.0 MB")
    assert why.startswith("1 file (4.0 MB) of no result: arrays younger than an hour stay")


def test_a_store_of_another_user_is_named(
    command: Command, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*words: object, **options: object) -> int:
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(os, "open", refuse)
    status, _, err = command("cache", "list", "--store", str(folder), nodes=False)
    assert status == 2
    assert f"results cannot be read: {folder}: Permission denied; it belongs to" in err
    assert "name another folder with --store" in err


def test_all_goes(command: Command, folder: Path) -> None:
    status, out, _ = command("cache", "clear", "--store", str(folder), nodes=False)
    assert status == 0
    assert out == f"removed 3 results (4.0 MB, arrays in 1 file) from {folder}\n"
    assert command("cache", "--store", str(folder), nodes=False)[1].startswith("0 results (0 B")


@pytest.mark.parametrize("part", ["", "entries", "blobs"])
@pytest.mark.parametrize(
    "words",
    [["cache", "clear"], ["cache", "prune", "--keep", "0B"], ["run", "toy.yaml", "--out", "run"]],
    ids=" ".join,
)
def test_nothing_is_written_or_removed_through_a_link(
    command: Command, folder: Path, words: list[str], part: str
) -> None:
    shutil.copytree(folder, "other")
    theirs = Path("other/format-2", part)
    theirs.mkdir(exist_ok=True)
    linked = folder / "format-2" / part
    shutil.rmtree(linked, ignore_errors=True)
    linked.symlink_to(theirs.resolve())
    before = files_below(Path("other"))
    _, out, err = command(*words, "--store", str(folder), nodes=words[0] == "run")
    assert files_below(Path("other")) == before
    told = f"{linked} is a symbolic link, which is not followed" in out + err
    assert told or (words[0] == "run" and part == "blobs")


def test_the_folder_of_a_store_may_be_a_link(command: Command, folder: Path) -> None:
    Path("linked").symlink_to(folder)
    assert command("run", "toy.yaml", "--out", "run", "--store", "linked")[0] == 0
    _, out, _ = command("cache", "--store", str(folder), nodes=False)
    assert int(out.split()[0]) > 3
    _, removed, _ = command("cache", "clear", "--store", "linked", nodes=False)
    assert removed.startswith(f"removed {out.partition(' in /')[0]}")
    _, out, _ = command("cache", "--store", str(folder), nodes=False)
    assert out.startswith("0 results (0 B")


def files_below(folder: Path) -> dict[Path, tuple[int, int]]:
    paths = (path for path in folder.rglob("*") if path.is_file())
    return {path: (path.stat().st_size, path.stat().st_mtime_ns) for path in paths}

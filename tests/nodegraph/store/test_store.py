"""Results are found again as they were, by whoever asks with the same key."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np
import pytest

from nodegraph import Across, Kind
from nodegraph.store import About, Packer, Store, Upkeep, store_folder

from .forged import seal

ROOT = Path(__file__).parents[3]
ABOUT = About("fill.muscle", "fill(length=45)", "done", "", ("3 gaps",), 1.5)
KEY = "ab" + "0" * 62
Files = Callable[..., list[Path]]


def key_of(number: int) -> str:
    return f"{number:064x}"


def test_what_is_saved_is_found_and_loaded(store: Store, messages: list[str]) -> None:
    long = np.arange(9000.0)[::-1]
    values = (1.5, np.arange(5.0), {"a": long, "b": b"x" * 3000})
    saved = store.save(KEY, ABOUT, values)
    assert store.saved == 1
    entry = store.find(KEY)
    assert entry == saved
    assert entry is not None
    assert (entry.key, entry.node, entry.step) == (KEY, "fill.muscle", "fill(length=45)")
    assert (entry.state, entry.reason, entry.warnings) == ("done", "", ("3 gaps",))
    assert entry.seconds == 1.5
    assert entry.created > 1.7e9
    assert entry.faithful == (True, True, True)
    assert entry.digests == tuple(store.packer.digest(value) for value in values)
    number, short, more = store.load(entry)
    assert number == 1.5
    assert short.tolist() == [0, 1, 2, 3, 4]
    assert more["a"].tobytes() == long.tobytes()
    assert more["b"] == b"x" * 3000
    assert not more["a"].flags.writeable
    assert messages == []


def test_another_store_in_the_same_folder_finds_it(tmp_path: Path) -> None:
    folder = tmp_path / "deep" / "down"
    Store(folder, Packer(), print).save(KEY, ABOUT, (1,))
    other = Store(folder, Packer(), print)
    entry = other.find(KEY)
    assert entry is not None
    assert other.load(entry) == (1,)
    assert (folder / "format-2" / "README").is_file()


def test_what_is_not_there_is_not_found(store: Store, messages: list[str]) -> None:
    assert store.find(KEY) is None
    assert store.find("") is None
    assert messages == []


def test_a_refusal_is_kept_with_its_reason(store: Store) -> None:
    refused = About("fill.muscle", "fill", "refused", "needs one complete frame")
    store.save(KEY, refused, ())
    entry = store.find(KEY)
    assert entry is not None
    assert (entry.state, entry.reason) == ("refused", "needs one complete frame")
    assert store.load(entry) == ()


def test_the_last_one_saved_is_found(store: Store) -> None:
    for value in (1, 2):
        store.save(KEY, ABOUT, (value,))
    entry = store.find(KEY)
    assert entry is not None
    assert store.load(entry) == (2,)


def test_equal_arrays_lie_there_once(store: Store, files: Files) -> None:
    array = np.random.default_rng(1).normal(size=1000)
    store.save(key_of(1), ABOUT, (array, array.copy()))
    store.save(key_of(2), ABOUT, ([array.reshape(10, 100)],))
    assert len(files("blobs")) == 1
    for number, parts in ((1, 2), (2, 1)):
        entry = store.find(key_of(number))
        assert entry is not None
        assert entry.size == 8000 + files("entries")[number - 1].stat().st_size
        assert len(store.load(entry)) == parts


def test_small_arrays_lie_in_the_entry(store: Store, files: Files) -> None:
    store.save(KEY, ABOUT, (np.zeros(256),))
    assert files("blobs") == []
    store.save(KEY, ABOUT, (np.zeros(257),))
    assert len(files("blobs")) == 1


def test_many_gathered_values_do_not_make_looking_up_slow(store: Store, files: Files) -> None:
    gathered = Across.of({number: float(number) for number in range(2000)}, axis="trial")
    store.save(KEY, ABOUT, (gathered,))
    assert files("entries")[0].stat().st_size < 2000
    entry = store.find(KEY)
    assert entry is not None
    assert store.load(entry) == (gathered,)


def test_a_blob_that_is_there_is_not_written_again(
    store: Store, files: Files, age: Callable[[Path, float], None]
) -> None:
    array = np.arange(1000.0)
    store.save(key_of(1), ABOUT, (array,))
    (blob,) = files("blobs")
    age(blob, 7200)
    before = blob.stat()
    store.save(key_of(2), ABOUT, (array,))
    after = blob.stat()
    assert after.st_ino == before.st_ino
    assert after.st_mtime > before.st_mtime + 3600  # in use again: nobody may remove it now


def test_a_blob_of_another_size_is_written_again(store: Store, files: Files) -> None:
    array = np.arange(1000.0)
    store.save(key_of(1), ABOUT, (array,))
    (blob,) = files("blobs")
    blob.write_bytes(b"half")
    entry = store.save(key_of(2), ABOUT, (array,))
    assert entry is not None
    assert store.load(entry)[0].tolist() == array.tolist()


def test_use_is_marked_once_an_hour(
    store: Store, files: Files, age: Callable[[Path, float], None]
) -> None:
    store.save(KEY, ABOUT, (1,))
    (entry,) = files("entries")
    age(entry, 1800)
    before = entry.stat().st_mtime
    store.find(KEY)
    assert entry.stat().st_mtime == before
    age(entry, 3600)
    store.find(KEY)
    assert entry.stat().st_mtime > before


def test_what_cannot_be_kept_is_counted(store: Store, messages: list[str], files: Files) -> None:
    for number in range(2):
        assert store.save(key_of(number), ABOUT, (1, [{1, 2}])) is None
    assert store.save(key_of(3), ABOUT, (np.array([None]),)) is None
    assert store.unstorable == {"set": 2, "array of object": 1}
    assert store.writable
    assert files("entries") == []
    assert messages == []


def test_a_stand_in_is_marked_as_one(tmp_path: Path) -> None:
    storage = Kind(frozenset, take_apart=sorted, put_together=list, faithful=False)
    store = Store(tmp_path, Packer([storage]), print)
    store.save(KEY, ABOUT, (1.5, frozenset("ab")))
    entry = store.find(KEY)
    assert entry is not None
    assert entry.faithful == (True, False)
    assert store.load(entry) == (1.5, ["a", "b"])


def test_something_small_is_remembered(store: Store, messages: list[str], files: Files) -> None:
    assert store.recall("code") == {}
    store.remember("code", {"a": [1, "é"]})
    store.remember("files", {"b": {}})
    store.remember("code", {"c": 0.1})
    assert store.recall("code") == {"c": 0.1}
    assert store.recall("files") == {"b": {}}
    seal(store.folder / "format-2" / "files.json", b"[" * 100_000)
    assert store.recall("files") == {}
    code = next(file for file in files() if file.name == "code.json")
    code.write_bytes(code.read_bytes().replace(b"0.1", b"0.2"))
    assert store.recall("code") == {}
    code.write_bytes(b"")
    assert store.recall("code") == {}
    assert messages == []


def test_a_working_directory_that_changes_does_not_matter(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    store = Store(Path("here"), Packer(), print)
    (tmp_path / "other").mkdir()
    monkeypatch.chdir(tmp_path / "other")
    store.save(KEY, ABOUT, (1,))
    assert store.find(KEY) is not None
    assert list(Path().iterdir()) == []


def test_where_results_lie(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NODEGRAPH_STORE", str(tmp_path / "named"))
    assert store_folder(tmp_path) == tmp_path
    assert store_folder() == tmp_path / "named"
    monkeypatch.setenv("NODEGRAPH_STORE", "~/kept")
    assert store_folder() == Path.home() / "kept"
    monkeypatch.delenv("NODEGRAPH_STORE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert store_folder().parts[-2:] == ("nodegraph", "store")


def test_many_threads_share_a_store(store: Store, messages: list[str], files: Files) -> None:
    array = np.random.default_rng(1).normal(size=(20, 500))
    wrong: list[object] = []

    def work(first: int) -> None:
        for number in range(40):
            index = (first + number) % 20
            store.save(
                key_of(index), ABOUT, (array[index], {index}) if index % 5 == 4 else (array[index],)
            )
            entry = store.find(key_of(index))
            if entry is not None and not np.array_equal(store.load(entry)[0], array[index]):
                wrong.append(index)

    in_all([threading.Thread(target=work, args=(first,)) for first in range(8)])
    assert wrong == messages == []
    assert len(files("entries")) == len(files("blobs")) == 16
    assert store.unstorable == {"set": 64}


RACE = """
import sys
import numpy as np
from pathlib import Path
from nodegraph.store import About, Packer, Store, Upkeep

folder, first = Path(sys.argv[1]), int(sys.argv[2])
store = Store(folder, Packer(), lambda text: sys.exit(text))
for number in range(120):
    index = (7 * first + number) % 30
    array = np.full(1000, index // 2, float)
    store.save(f"{index:064x}", About("n", "s", "done"), (index, array))
    found = store.find(f"{index:064x}")
    assert found is not None
    value, back = store.load(found)
    assert value == index and (back == index // 2).all()
    store.remember("code", {str(first): number})
    if number % 40 == first:
        Upkeep(folder).prune(older_than=3600)
assert len(store.recall("code")) == 1
"""


def test_many_programs_share_a_folder(store: Store, files: Files) -> None:
    path = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    racing = [
        subprocess.Popen(
            [sys.executable, "-c", RACE, str(store.folder), str(first)],
            env={**os.environ, "PYTHONPATH": path},
            stderr=subprocess.PIPE,
            text=True,
        )
        for first in range(4)
    ]
    for process in racing:
        _, message = process.communicate()
        assert process.returncode == 0, message
    assert len(files("entries")) == 30
    assert {listed.entry.key for listed in Upkeep(store.folder).entries()} == {
        key_of(index) for index in range(30)
    }
    assert len(files("blobs")) == 15
    assert not [process for process in files() if process.suffix == ".part"]
    for index in range(30):
        entry = store.find(key_of(index))
        assert entry is not None
        assert store.load(entry)[0] == index


def test_an_entry_can_be_read_by_a_person(store: Store, files: Files) -> None:
    store.save(KEY, ABOUT, ({"a": 1.5},))
    _, text = files("entries")[0].read_text().split("\n")
    written = json.loads(text)
    assert written["step"] == "fill(length=45)"
    assert json.loads(written["outputs"][0][0]) == ["dict", "a", 1.5]


def in_all(threads: Iterable[threading.Thread]) -> None:
    listed = list(threads)
    for each in listed:
        each.start()
    for each in listed:
        each.join()

"""Damage, a full disk or a folder that nobody may write to costs results, never a run."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nodegraph.store import About, DamagedEntry, Entry, Packer, Store

from .forged import forge, output, payload

ABOUT = About("fill.muscle", "fill(length=45)", "done")
KEY, OTHER = "ab" + "0" * 62, "ab" + "1" * 62
ARRAY = np.arange(5000.0)
Files = Callable[..., list[Path]]


def kept(store: Store, key: str = KEY, value: object = ARRAY) -> Entry:
    entry = store.save(key, ABOUT, (value,))
    assert entry is not None
    return entry


@pytest.mark.parametrize(
    "damage",
    [
        lambda content: b"",
        lambda content: content[:-1],
        lambda content: content[: len(content) // 2],
        lambda content: content + b" ",
        lambda content: content.replace(b'"done"', b'"gone"'),
        lambda content: content.replace(b"\n", b" "),
        lambda content: bytes([content[0] ^ 1]) + content[1:],
        lambda content: bytes(len(content)),
    ],
)
def test_a_damaged_entry_is_removed_and_reported_once(
    store: Store, messages: list[str], files: Files, damage: Callable[[bytes], bytes]
) -> None:
    kept(store)
    (path,) = files("entries")
    path.write_bytes(damage(path.read_bytes()))
    assert store.find(KEY) is None
    assert store.find(KEY) is None
    assert not path.exists()
    assert len(messages) == 1
    assert "damaged" in messages[0]
    assert str(path) in messages[0]
    assert kept(store)


def test_an_entry_in_the_place_of_another_is_not_believed(
    store: Store, messages: list[str], files: Files
) -> None:
    kept(store, KEY, 1.0)
    kept(store, OTHER, 2.0)
    first, other = files("entries")
    os.replace(first, other)
    assert store.find(OTHER) is None
    assert not other.exists()
    assert len(messages) == 1


def test_an_entry_that_is_sealed_and_makes_no_sense_is_damaged(
    store: Store, messages: list[str], files: Files
) -> None:
    from nodegraph.store.files import seal

    kept(store)
    (path,) = files("entries")
    for text in ("[]", "{}", "1", f'{{"key":"{KEY}"}}', "x"):
        path.write_bytes(seal(text))
        assert store.find(KEY) is None
    assert "damaged" in messages[0]


@pytest.mark.parametrize(
    "damage",
    [
        lambda path: path.unlink(),
        lambda path: path.write_bytes(path.read_bytes()[:-1]),
        lambda path: path.write_bytes(path.read_bytes() + b"\0"),
        lambda path: path.write_bytes(bytes(40000)),
        lambda path: path.write_bytes(b""),
    ],
)
def test_a_damaged_blob_goes_with_its_entry(
    store: Store, messages: list[str], files: Files, damage: Callable[[Path], object]
) -> None:
    entry = kept(store)
    damage(files("blobs")[0])
    with pytest.raises(DamagedEntry, match=r"fill\(length=45\) .*fill\.muscle.*" + KEY):
        store.load(entry)
    assert files("entries") == files("blobs") == []
    assert len(messages) == 1
    assert store.find(KEY) is None
    assert store.load(kept(store))[0].tolist() == ARRAY.tolist()


def test_an_array_stays_that_is_whole_though_an_entry_says_otherwise(
    store: Store, files: Files
) -> None:
    kept(store)
    other = kept(store, OTHER)
    own = payload(files("entries")[0])["outputs"][0]
    name, size = own[1][0]
    forge(files("entries")[0], output(own[0], [name, size + 8]))
    forged = store.find(KEY)
    assert forged is not None
    with pytest.raises(DamagedEntry):
        store.load(forged)
    assert store.load(other)[0].tolist() == ARRAY.tolist()


def test_values_of_other_types_or_numbers_than_a_node_has_are_damage(
    store: Store, messages: list[str]
) -> None:
    entry = kept(store)
    assert store.load(entry, (np.ndarray,))[0].tolist() == ARRAY.tolist()
    with pytest.raises(DamagedEntry, match="ndarray, not float"):
        store.load(entry, (float,))
    kept(store)
    assert store.find(KEY, outputs=1) is not None
    assert store.find(KEY, outputs=2) is None
    assert store.find(KEY) is None
    assert store.save(KEY, replace(ABOUT, state="refused", reason="no"), ()) is not None
    assert store.find(KEY, outputs=2) is not None
    assert len(messages) == 2


def test_a_step_that_is_named_after_an_unreadable_file_is_found(store: Store) -> None:
    about = replace(ABOUT, step="read(file=take_\udcff.c3d)")
    saved = store.save(KEY, about, (1.5,))
    assert saved is not None
    assert store.find(KEY) == saved
    assert saved.step.startswith("read(file=take_")
    saved.step.encode()


def test_what_cannot_be_put_together_any_more_is_removed(store: Store, files: Files) -> None:
    entry = store.save(KEY, ABOUT, ((1, 2),))
    assert entry is not None
    (path,) = files("entries")
    entry.outputs[0] = ('["nobody knows this"]', [])
    with pytest.raises(DamagedEntry, match="cannot be used"):
        store.load(entry)
    assert not path.exists()


@pytest.fixture
def failing(monkeypatch: pytest.MonkeyPatch) -> Callable[[str, int, int], None]:
    """Make a call of the system fail from its n-th time on."""

    def make(name: str, number: int, after: int = 0) -> None:
        real = getattr(os, name)
        left = [after]

        def call(*given: Any, **more: Any) -> Any:
            if name == "open" and not given[1] & os.O_CREAT:
                return real(*given, **more)
            left[0] -= 1
            if left[0] < 0:
                raise OSError(number, os.strerror(number))
            if name == "write":  # as a disk does that is nearly full
                return real(given[0], given[1][:1000])
            return real(*given, **more)

        monkeypatch.setattr(os, name, call)

    return make


@pytest.mark.parametrize(
    ("call", "number", "after"),
    [
        ("open", errno.EROFS, 0),
        ("open", errno.EACCES, 1),
        ("open", errno.ENOSPC, 0),
        ("write", errno.ENOSPC, 0),
        ("write", errno.ENOSPC, 3),  # in the middle of the blob
        ("write", errno.EDQUOT, 40),  # in the entry
        ("replace", errno.EIO, 0),
        ("replace", errno.EIO, 1),
    ],
)
def test_what_cannot_be_written_is_reported_once_and_leaves_nothing_half(
    store: Store,
    messages: list[str],
    files: Files,
    failing: Callable[[str, int, int], None],
    monkeypatch: pytest.MonkeyPatch,
    call: str,
    number: int,
    after: int,
) -> None:
    kept(store, OTHER, 1.5)
    failing(call, number, after)
    for _ in range(3):
        assert store.save(KEY, ABOUT, (ARRAY,)) is None
    store.remember("code", {"a": 1})
    assert not store.writable
    [message] = messages
    assert message.startswith(f"results are no longer kept: {store.folder}: {os.strerror(number)}")
    owned = f"it belongs to {store.folder.owner()}; name another folder with --store"
    assert (owned in message) == (number in (errno.EACCES, errno.EROFS))
    assert [file.name for file in files("entries")] == [f"{OTHER}.json"]
    assert not [file for file in files() if file.suffix == ".part"]
    assert store.recall("code") == {}
    entry = store.find(OTHER)  # what is there is used all the same
    assert entry is not None
    assert store.load(entry) == (1.5,)
    monkeypatch.undo()
    assert all(file.stat().st_size == ARRAY.nbytes for file in files("blobs"))


def test_a_folder_that_cannot_be_made_is_an_empty_store(
    tmp_path: Path, messages: list[str]
) -> None:
    (tmp_path / "taken").write_text("a file")
    for folder in (tmp_path / "taken", tmp_path / "taken" / "below"):
        messages.clear()
        store = Store(folder, Packer(), messages.append)
        assert not store.writable
        assert store.find(KEY) is None
        assert store.save(KEY, ABOUT, (1,)) is None
        store.remember("code", {})
        assert store.recall("code") == {}
        assert len(messages) == 1
        assert "no longer kept" in messages[0]
        assert str(folder) in messages[0]


def test_entries_that_cannot_be_read_are_reported_once(
    store: Store, messages: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    kept(store)
    real = os.open

    def refuse(path: Any, flags: int, *rest: int, **more: Any) -> int:
        if str(path).endswith(".json"):
            raise PermissionError(errno.EACCES, "Permission denied")
        return real(path, flags, *rest, **more)

    monkeypatch.setattr(os, "open", refuse)
    assert store.find(KEY) is None
    assert store.find(OTHER) is None
    assert messages == [f"stored results cannot be read: {store.folder}: Permission denied"]
    monkeypatch.undo()
    assert store.find(KEY) is not None


def test_a_folder_that_is_only_for_reading_is_read(
    store: Store, messages: list[str], monkeypatch: pytest.MonkeyPatch, files: Files
) -> None:
    entry = kept(store)
    os.utime(files("entries")[0], (0, 0))

    def refuse(*given: object, **more: object) -> None:
        raise OSError(errno.EROFS, "Read-only file system")

    for name in ("utime", "replace", "unlink", "mkdir"):
        monkeypatch.setattr(os, name, refuse)
    again = Store(store.folder, Packer(), messages.append)
    result = again.find(KEY)
    assert result == entry
    assert again.load(result)[0].tolist() == ARRAY.tolist()
    assert messages == []


def test_a_folder_of_another_format_is_left_alone(tmp_path: Path) -> None:
    old = tmp_path / "format-0" / "entries" / KEY[:2] / f"{KEY[2:]}.json"
    old.parent.mkdir(parents=True)
    old.write_text("older")
    store = Store(tmp_path, Packer(), print)
    assert store.find(KEY) is None
    kept(store)
    assert old.read_text() == "older"


def test_an_interrupted_write_leaves_nothing(
    store: Store, files: Files, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(*given: object) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "write", interrupt)
    with pytest.raises(KeyboardInterrupt):
        store.save(KEY, ABOUT, (ARRAY,))
    assert [file.name for file in files()] == ["README"]
    assert store.writable

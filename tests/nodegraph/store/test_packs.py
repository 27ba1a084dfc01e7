"""Entries that lie together are as those in files of their own, whatever happens to their pack."""

from __future__ import annotations

import errno
import fcntl
import os
import shutil
import struct
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from random import Random
from threading import Thread

import numpy as np
import pytest

from nodegraph import node
from nodegraph.execute import execute
from nodegraph.graph import build
from nodegraph.graphfile import read_graph_text
from nodegraph.plan import plan
from nodegraph.plugin.registry import Registry
from nodegraph.store import About, DamagedEntry, Packer, Store, Upkeep, upkeep

HOUR, DAY = 3600.0, 86400.0
COUNT = 40
Files = Callable[..., list[Path]]
Age = Callable[[Path, float], None]


def key_of(number: int) -> str:
    return f"{number * 2654435761 % 2**32:08x}" * 8


def save(store: Store, number: int, *more: object) -> None:
    about = About("n", f"s{number}", "done")
    assert store.save(key_of(number), about, (number, *more)) is not None


def values(store: Store) -> dict[int, object]:
    """Return what is there by number, after reading all of it."""
    result: dict[int, object] = {}
    for number in range(COUNT):
        entry = store.find(key_of(number))
        if entry is not None:
            try:
                result[number] = store.load(entry)[0]
            except DamagedEntry:
                continue
    return result


@pytest.fixture(autouse=True)
def _soon(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(upkeep, "_FEW", 4)


@pytest.fixture
def packed(store: Store, files: Files, age: Age) -> Store:
    """A store of entries in one pack, each used a day earlier than the one before."""
    for number in range(COUNT):
        save(store, number, np.full(1000, number % 4, float))
        path = store.folder / "format-1/entries" / key_of(number)[:2] / f"{key_of(number)[2:]}.json"
        age(path, number * DAY)
    for path in files("blobs"):
        age(path, 100 * DAY)
    assert Upkeep(store.folder).tidy() == ""
    return store


def packs(store: Store) -> list[Path]:
    return sorted(store.folder.glob("format-1/packs/*.pack"))


def test_many_entries_lie_in_one_file(packed: Store, files: Files, messages: list[str]) -> None:
    assert not files("entries")
    assert len(packs(packed)) == 1
    listed = sorted(Upkeep(packed.folder).entries(), key=lambda each: -each.used)
    assert [each.entry.step for each in listed] == [f"s{number}" for number in range(COUNT)]
    assert values(packed) == {number: number for number in range(COUNT)}
    assert packed.find("1" * 64) is None
    amount = Upkeep(packed.folder).size()
    assert (amount.entries, amount.blobs) == (COUNT, 4)
    assert amount.size == packs(packed)[0].stat().st_size + 4 * 8000
    assert messages == []


def test_packs_are_few_and_an_entry_that_was_saved_again_is_the_last(
    packed: Store, files: Files
) -> None:
    for number in range(COUNT, 8 * COUNT):
        save(packed, number)
        Upkeep(packed.folder).tidy()
    assert len(packs(packed)) <= 8
    packed.save(key_of(3), About("n", "s3", "done"), ("again",))
    assert values(packed)[3] == "again"
    for number in range(3):
        save(packed, 9 * COUNT + number)
    Upkeep(packed.folder).tidy()
    assert values(packed) == {number: number for number in range(COUNT)} | {3: "again"}


def test_what_was_used_lately_stays_and_the_pack_gets_smaller(packed: Store, files: Files) -> None:
    before = packs(packed)[0].stat().st_size
    other = Store(packed.folder, Packer(), pytest.fail)
    assert other.find(key_of(COUNT - 1)) is not None
    removed = Upkeep(packed.folder).prune(older_than=9.5 * DAY)
    assert removed.entries == COUNT - 11
    left = [*range(10), COUNT - 1]
    # whoever has the former pack open sees that, too
    assert list(values(other)) == list(values(packed)) == left
    assert packs(packed)[0].stat().st_size < before / 2
    assert len(files("blobs")) == 4
    assert Upkeep(packed.folder).prune(keep=0).entries == 11
    assert not packs(packed)
    assert not files("blobs")


def test_a_program_that_ends_in_between_loses_nothing(
    packed: Store, files: Files, monkeypatch: pytest.MonkeyPatch
) -> None:
    for number in range(COUNT, COUNT + 6):
        save(packed, number)

    def end(path: str, *, dir_fd: int) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(os, "unlink", end)
        with pytest.raises(KeyboardInterrupt):
            Upkeep(packed.folder).tidy()
    assert len(files("entries")) == 6
    assert len(packs(packed)) == 2
    assert len(values(packed)) == COUNT
    Upkeep(packed.folder).tidy()
    assert not files("entries")
    assert len(packs(packed)) == 2


def test_all_goes_with_the_packs(packed: Store, files: Files) -> None:
    assert Upkeep(packed.folder).clear().entries == COUNT
    assert [path.name for path in files()] == ["README"]
    assert values(packed) == {}
    save(packed, 2)
    assert values(packed) == {2: 2}


@pytest.mark.parametrize("seed", range(60))
def test_a_damaged_or_forged_pack_gives_no_wrong_value(
    packed: Store, seed: int, messages: list[str]
) -> None:
    chance, (path,) = Random(seed), packs(packed)
    content = bytearray(path.read_bytes())
    head = 24 + COUNT * (32 + 20)
    for _ in range(chance.choice([1, 3, 30])):
        at = chance.randrange(min(len(content), chance.choice([24, head, 10**6])) or 1)
        content = content or bytearray(1)
        match chance.randrange(4):
            case 0:
                content[at] = chance.randrange(256)
            case 1:
                content[at : at + 8] = chance.choice([b"\xff" * 8, b"\0" * 8])
            case 2:
                content[at : at + 52] = content[at + 52 : at + 104]
            case _ if chance.random() < 0.2:
                del content[at:]
                content += b"\0"
            case _:
                content[at : at + 32] = chance.randbytes(32)
    path.write_bytes(content)
    for number in range(COUNT, COUNT + 5):
        save(packed, number)
    for _ in range(2):
        again = Store(packed.folder, Packer(), messages.append)
        assert all(number == value for number, value in values(again).items())
        assert len(list(Upkeep(packed.folder).entries())) <= 2 * COUNT
        Upkeep(packed.folder).tidy()
    Upkeep(packed.folder).prune(older_than=20 * DAY)
    assert all(number == value for number, value in values(packed).items())
    Upkeep(packed.folder).clear()
    assert not packs(packed)


def test_a_pack_that_claims_more_than_it_holds_does_not_grow(packed: Store) -> None:
    (path,) = packs(packed)
    content, size = bytearray(path.read_bytes()), path.stat().st_size
    first = 24 + COUNT * 32
    for index in range(COUNT):
        record = first + index * 20
        content[record + 8 : record + 12] = struct.pack("<I", 2**32 - 1 if index % 2 else size // 2)
    path.write_bytes(content)
    Upkeep(packed.folder).prune(older_than=50 * DAY)
    for number in range(COUNT, COUNT + 50):
        save(packed, number)
    Upkeep(packed.folder).tidy()
    assert sum(each.stat().st_size for each in packs(packed)) < 4 * size


def test_a_pack_that_claims_more_than_memory_holds_is_none(packed: Store) -> None:
    (path,) = packs(packed)
    content = bytearray(path.read_bytes())
    for count in (2**32, 2**62):
        forged = path.with_name(f"{count}.pack")
        forged.write_bytes(struct.pack("<16sQ", content[:16], count))
        os.truncate(forged, 2**43)  # without taking room on the disk
    first = 24 + COUNT * 32
    content[first + 8 : first + 12] = struct.pack("<I", 2**32 - 1)
    path.write_bytes(content)
    os.truncate(path, 2**34)
    assert len(values(packed)) == COUNT - 1
    Upkeep(packed.folder).prune(keep=0)
    assert values(packed) == {}


def test_many_packs_leave_room_for_other_files(packed: Store) -> None:
    (path,) = packs(packed)
    for number in range(400):
        shutil.copy(path, path.with_name(f"{number}.pack"))
    before = len(os.listdir("/proc/self/fd"))
    assert len(values(packed)) == COUNT
    assert len(os.listdir("/proc/self/fd")) - before < 300


def test_packs_that_claim_millions_of_entries_take_no_memory_and_hide_no_other(
    packed: Store,
) -> None:
    (path,) = packs(packed)
    for number in range(200):
        forged = path.with_name(f"+{number}.pack")
        forged.write_bytes(struct.pack("<16sQ", path.read_bytes()[:16], 2**23))
        os.truncate(forged, 2**23 * (32 + 20) + 24)  # without taking room on the disk
        path.with_name(f"-{number}.pack").write_bytes(b"no pack")
    tracemalloc.start()
    assert len(values(packed)) == COUNT
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 20e6


def test_a_damaged_entry_in_a_pack_goes_with_the_next_pruning(packed: Store) -> None:
    (path,) = packs(packed)
    path.write_bytes(path.read_bytes().replace(b'"step":"s7"', b'"step":"s8"'))
    assert Upkeep(packed.folder).prune(older_than=1000 * DAY).entries == 0
    assert Upkeep(packed.folder).size().entries == COUNT - 1


def devour(path: Path) -> None:
    path.symlink_to("/dev/zero")


@pytest.mark.parametrize("put", [os.mkfifo, devour])
def test_a_pipe_or_device_in_place_of_a_file_is_damage(
    store: Store, files: Files, put: Callable[[Path], None]
) -> None:
    save(store, 1, np.zeros(1000))
    entry = store.find(key_of(1))
    assert entry is not None
    (path,) = files("blobs")
    path.unlink()
    put(path)
    with pytest.raises(DamagedEntry):
        store.load(entry)
    save(store, 1, np.zeros(1000))
    (path,) = files("entries")
    path.unlink()
    put(path)
    assert store.find(key_of(1)) is None
    Upkeep(store.folder).prune(keep=0)


@pytest.mark.parametrize("remove", [Upkeep.clear, lambda upkeep: upkeep.prune(keep=0)])
def test_what_is_removed_while_another_program_packs_is_gone(
    packed: Store, remove: Callable[[Upkeep], object]
) -> None:
    with (packed.folder / "format-1/packs/lock").open("ab") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        waiting = Thread(target=remove, args=(Upkeep(packed.folder),))
        waiting.start()
        waiting.join(0.1)
        assert len(values(packed)) == COUNT
    waiting.join()
    assert values(packed) == {}


def test_a_pack_is_read_on_a_disk_where_nothing_can_be_written(
    packed: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    opens = os.open

    def refusing(path: str, flags: int, *mode: int, dir_fd: int | None = None) -> int:
        if flags & os.O_RDWR:  # as a mount for reading does
            raise OSError(errno.EROFS, "Read-only file system")
        return opens(path, flags, *mode, dir_fd=dir_fd)

    monkeypatch.setattr(os, "open", refusing)
    assert values(Store(packed.folder, Packer(), pytest.fail)) == {
        number: number for number in range(COUNT)
    }


def test_a_damaged_entry_is_reported_once_and_the_others_stay(
    packed: Store, messages: list[str]
) -> None:
    (path,) = packs(packed)
    content = path.read_bytes()
    assert content.count(b'"step":"s7"') == 1
    path.write_bytes(content.replace(b'"step":"s7"', b'"step":"s8"'))
    left = {number: number for number in range(COUNT) if number != 7}
    assert values(packed) == left
    assert messages == [
        f"a stored result is damaged, and is computed again when it is needed: {path}"
    ]
    assert values(Store(packed.folder, Packer(), pytest.fail)) == left


@node("words.word")
def word(*, number: int) -> str:
    """Write a number."""
    return f"{number:0100000d}"


def test_a_store_is_bounded_and_a_run_says_so_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, age: Age
) -> None:
    monkeypatch.setattr(upkeep, "_FEW", 100)
    registry, lines = Registry.of([word]), list[str]()
    disk = shutil.disk_usage(tmp_path)._replace(total=5 * 1_000_000)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: disk)
    folder = tmp_path / "store"

    def run(first: int, count: int) -> None:
        axes = f"axes: {{x: {list(range(first, first + count))}}}"
        nodes = "nodes: {a: {use: words.word, with: {number: $x}}}"
        text = f"nodegraph: 1\n{axes}\n{nodes}"
        graph = build(read_graph_text(text, "words.yaml", tmp_path), registry)
        run = execute(plan(graph), store=Store(folder, Packer(), lines.append))
        run.tidy()
        assert run.ok

    run(0, 7)
    assert lines == []
    for path in (folder / "format-1").rglob("*"):
        age(path, 30 * DAY)
    run(7, 7)
    assert lines == [
        f"stored results had more than a fifth of the disk, 1.0 MB: the 5 that were unused for "
        f"longest are removed from {folder}"
    ]
    steps = {listed.entry.step for listed in Upkeep(folder).entries()}
    assert {f"a(x={number})" for number in range(7, 14)} <= steps
    assert Upkeep(folder).size().size < 1_000_000

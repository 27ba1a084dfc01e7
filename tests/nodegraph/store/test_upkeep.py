"""What was long unused goes first, and nothing that another program may need just now."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from nodegraph.store import About, Amount, Packer, Store, Upkeep

from .forged import forge

HOUR, DAY = 3600.0, 86400.0
Files = Callable[..., list[Path]]
Age = Callable[[Path, float], None]


def key_of(number: int) -> str:
    return f"{number:02x}" * 32


@pytest.fixture
def upkeep(store: Store) -> Upkeep:
    return Upkeep(store.folder)


@pytest.fixture
def filled(store: Store, files: Files, age: Age) -> Store:
    """Four results that were used 40, 30, 20 and 10 days ago; the first two share an array."""
    for number in range(4):
        shared = np.full(1000, max(1, number), float)
        store.save(key_of(number), About("n", f"s{number}", "done"), (number, shared))
    for number, entry in enumerate(files("entries")):
        age(entry, (40 - 10 * number) * DAY)
    for blob in files("blobs"):
        age(blob, 50 * DAY)
    return store


def left(store: Store) -> list[int]:
    """Return which results are there, after seeing that each is whole."""
    entry = [store.find(key_of(number)) for number in range(4)]
    return [store.load(listed)[0] for listed in entry if listed is not None]


def test_an_empty_store(upkeep: Upkeep) -> None:
    assert list(upkeep.entries()) == []
    assert upkeep.size() == Amount()
    assert upkeep.prune(older_than=0, keep=0) == Amount()
    assert upkeep.other_formats() == []


def test_a_folder_that_is_not_there_is_not_made(tmp_path: Path) -> None:
    upkeep = Upkeep(tmp_path / "none")
    assert upkeep.size() == upkeep.clear() == upkeep.prune(0, 0) == Amount()
    assert not (tmp_path / "none").exists()


def test_how_much_there_is(filled: Store, upkeep: Upkeep, files: Files) -> None:
    entries = sum(file.stat().st_size for file in files("entries"))
    assert upkeep.size() == Amount(4, 3, entries + 3 * 8000)
    listed = sorted(upkeep.entries(), key=lambda listed: listed.used)
    assert [each.entry.step for each in listed] == ["s0", "s1", "s2", "s3"]
    assert all(each.entry.size == 8000 + each.entry.length for each in listed)


def test_an_entry_in_the_place_of_another_is_not_listed(
    filled: Store, upkeep: Upkeep, files: Files
) -> None:
    first, second, *_ = files("entries")
    second.write_bytes(first.read_bytes())
    assert [listed.entry.step for listed in upkeep.entries()].count("s0") == 1
    forge(first, lambda data: data.update(key="../../../victim"))
    assert sorted(listed.entry.step for listed in upkeep.entries()) == ["s2", "s3"]


def test_no_result_goes_for_the_size_that_another_entry_claims(
    filled: Store, upkeep: Upkeep, files: Files
) -> None:
    forge(files("entries")[3], lambda data: data["outputs"][1][1].append(["0" * 64, 2**60]))
    upkeep.prune(keep=10**6)
    assert sorted(listed.entry.step for listed in upkeep.entries()) == ["s0", "s1", "s2", "s3"]


@pytest.mark.parametrize(
    ("days", "stay"), [(45, [0, 1, 2, 3]), (35, [1, 2, 3]), (15, [3]), (5, [])]
)
def test_what_was_not_used_for_so_long_goes(
    filled: Store, upkeep: Upkeep, files: Files, days: float, stay: list[int]
) -> None:
    removed = upkeep.prune(older_than=days * DAY)
    assert removed.entries == 4 - len(stay)
    assert removed.blobs == 3 - len(files("blobs"))
    assert len(files("blobs")) == len({max(1, number) for number in stay})
    assert left(filled) == stay


def test_what_is_dated_in_the_future_goes_first(
    filled: Store, upkeep: Upkeep, files: Files, age: Age
) -> None:
    age(files("entries")[0], -60 * DAY)
    assert upkeep.prune(older_than=45 * DAY).entries == 1
    age(files("blobs")[0], -60 * DAY)
    upkeep.prune(keep=0)
    assert not files("blobs")


def test_what_was_found_lately_stays(filled: Store, upkeep: Upkeep) -> None:
    filled.find(key_of(0))
    upkeep.prune(older_than=15 * DAY)
    assert left(filled) == [0, 3]


@pytest.mark.parametrize(
    ("blobs", "stay"),
    [(3, [0, 1, 2, 3]), (2, [2, 3]), (1, [3]), (0, [])],  # the first two share an array
)
def test_the_longest_unused_goes_until_the_rest_fits(
    filled: Store, upkeep: Upkeep, blobs: int, stay: list[int]
) -> None:
    keep = blobs * 8000 + 4 * 1000
    assert upkeep.prune(keep=keep if stay else 100).entries == 4 - len(stay)
    assert left(filled) == stay
    assert upkeep.size().size <= keep


def test_an_array_that_another_entry_needs_frees_nothing(filled: Store, upkeep: Upkeep) -> None:
    everything = upkeep.size().size
    assert upkeep.prune(keep=everything) == Amount()
    first = min(upkeep.entries(), key=lambda listed: listed.used)
    assert upkeep.prune(keep=everything - 1) == Amount(1, 0, first.entry.length)
    assert left(filled) == [1, 2, 3]


def test_age_and_size_together(filled: Store, upkeep: Upkeep) -> None:
    assert upkeep.prune(older_than=35 * DAY, keep=8000 + 1000).entries == 3
    assert left(filled) == [3]


def test_an_array_that_was_written_just_now_stays(
    store: Store, upkeep: Upkeep, files: Files, age: Age
) -> None:
    store.save(key_of(1), About("n", "s", "done"), (np.zeros(1000),))
    files("entries")[0].unlink()  # as if its entry were still to come
    (blob,) = files("blobs")
    age(blob, 0.9 * HOUR)
    assert upkeep.prune(older_than=0, keep=0) == Amount()
    age(blob, 0.2 * HOUR)
    assert upkeep.prune(older_than=DAY) == Amount(0, 1, 8000)


def test_young_arrays_go_with_their_entries_unless_they_were_written_again(
    store: Store, upkeep: Upkeep, files: Files, age: Age
) -> None:
    for number in range(2):
        store.save(key_of(number), About("n", "s", "done"), (np.full(1000, number, float),))
    size = upkeep.size()
    first, second = files("blobs")
    age(first, -30)  # for an entry that is still to come
    removed = upkeep.prune(keep=0)
    assert removed == Amount(2, 1, size.size - 8000)
    assert (first.exists(), second.exists()) == (True, False)


def test_what_a_killed_program_left_half_written_goes_after_an_hour(
    filled: Store, upkeep: Upkeep, files: Files, age: Age
) -> None:
    places = [files("entries")[0], files("blobs")[0], filled.folder / "format-2" / "README"]
    half = [part.with_name(f"{number:08x}-{number}-0.part") for number, part in enumerate(places)]
    for part in half:
        part.write_bytes(b"half")
    assert upkeep.prune(older_than=1000 * DAY) == Amount()
    for part in half:
        age(part, 1.1 * HOUR)
    assert upkeep.prune(older_than=1000 * DAY) == Amount(0, 0, 12)
    assert not any(part.exists() for part in half)
    assert left(filled) == [0, 1, 2, 3]


def test_a_damaged_entry_is_not_listed_and_goes(
    filled: Store, upkeep: Upkeep, files: Files, age: Age
) -> None:
    damaged = files("entries")[0]
    damaged.write_bytes(b"damage")
    assert {listed.entry.step for listed in upkeep.entries()} == {"s1", "s2", "s3"}
    assert upkeep.size().entries == 4
    assert upkeep.prune(older_than=100 * DAY) == Amount()
    age(damaged, 2 * HOUR)
    assert upkeep.prune(older_than=100 * DAY) == Amount(1, 0, 6)
    assert not damaged.exists()


def test_all_goes_but_what_is_not_ours(filled: Store, upkeep: Upkeep, files: Files) -> None:
    filled.remember("code", {"a": 1})
    other = filled.folder / "format-0" / "entries" / "x.json"
    other.parent.mkdir(parents=True)
    other.write_text("{}")
    (filled.folder / "notes.json").write_text("{}")
    before = upkeep.size()
    removed = upkeep.clear()
    assert (removed.entries, removed.blobs) == (4, 3)
    assert removed.size >= before.size
    assert [file.name for file in files()] == ["README"]
    assert upkeep.size() == Amount()
    assert filled.recall("code") == {}
    assert other.exists()
    assert (filled.folder / "notes.json").exists()
    assert upkeep.other_formats() == ["format-0"]
    filled.save(key_of(1), About("n", "s", "done"), (1, np.ones(1000)))
    assert left(filled) == [1]


def test_a_store_goes_on_while_it_is_cleared(filled: Store, upkeep: Upkeep) -> None:
    entry = filled.find(key_of(2))
    upkeep.clear()
    again = Store(filled.folder, Packer(), print)
    assert again.find(key_of(2)) is None
    assert entry is not None
    assert again.save(key_of(2), About("n", "s", "done"), (2, 3)) is not None
    assert left(again) == [2]

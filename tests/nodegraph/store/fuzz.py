"""A program that reads forged entries: it prints what became of them, or dies of it.

``fuzz.py FOLDER SEED COUNT``
"""

from __future__ import annotations

import json
import resource
import sys
import warnings
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any

import numpy as np

from nodegraph import Absent, Across, Value
from nodegraph.execute.resume import open_store
from nodegraph.plugin.registry import Registry
from nodegraph.store import About, DamagedEntry, Store, Unstorable, Upkeep
from tests.nodegraph.store import forged

ABOUT = About("fuzz.make", "a(number=1)", "done")
GIB = 2**30
LARGE = 700


@dataclass(frozen=True)
class Sample(Value):
    """A class that checks its fields."""

    numbers: Any
    name: str
    rate: float

    def __post_init__(self) -> None:
        if len(self.numbers) != 3 or not self.rate > 0:
            raise ValueError("no sample")


def values() -> dict[str, Any]:
    """Return values of every kind that is kept."""
    rng = np.random.default_rng(5)
    own: dict[str, object] = {
        "plain": {"a": [1, 2.5, None, True], "b": (b"abc", "é", Path("x/y")), "c": 2**80},
        "array": np.arange(12.0).reshape(3, 4),
        "order": np.asfortranarray(rng.normal(size=(4, 5))),
        "gaps": rng.normal(size=(6, 5, 4))[:, 1:3, ::2],
        "large": rng.normal(size=LARGE),
        "kinds": [np.arange(4).astype(kind) for kind in ("?", "u1", ">i4", "f2", "c8", "M8[s]")],
        "texts": [np.array(["a", "bcd"]), np.array([b"xy"]), np.str_("a\0"), np.bytes_(b"b")],
        "numbers": [np.float32(0.5), np.int64(7), float("inf"), np.datetime64("2020-01-01")],
        "sample": Sample(np.arange(3), "s", 2.0),
        "gathered": Across(
            ("fill",), (({"fill": "a"}, 1.5),), (Absent({"fill": "b"}, "refused", "why"),)
        ),
        "empty": [np.zeros((5, 0, 3)), {}, (), b""],
    }
    for kind in Registry.installed().hooks.having("specimens"):
        assert kind.specimens is not None
        for name, value in kind.specimens().items():
            own[f"{kind.type.__name__} {name}"] = value
    return own


class Fuzz:
    """A store with one entry for each value, which are forged and read again and again."""

    def __init__(self, folder: Path, seed: int) -> None:
        self.chance = Random(seed)
        self.messages: list[str] = []
        self.store = open_store(Registry.installed(), folder, self.messages.append)
        self.counts: Counter[str] = Counter()
        self.kept: list[tuple[str, Path, bytes, type, str]] = []
        for number, (name, value) in enumerate(values().items()):
            key = f"{number:064x}"
            entry = self.store.save(key, ABOUT, (value, 1.5))
            assert entry is not None, name
            path = folder / "format-2" / "entries" / f"{key}.json"
            stored = self.store.load(entry)[0]
            digest = self.store.packer.digest(stored)
            self.kept.append((key, path, path.read_bytes(), type(stored), digest))
        self.blobs = {path: path.read_bytes() for path in folder.glob("format-2/blobs/*")}

    def once(self) -> None:
        """Forge an entry, and read it."""
        key, path, content, kind, digest = self.chance.choice(self.kept)
        path.write_bytes(content)
        for blob, whole in self.blobs.items():
            if not blob.exists():
                blob.write_bytes(whole)
        way = self.chance.choice(["bytes", "anything", "output", "output", "output"])
        if way == "bytes":
            forged.any_bytes(path, self.chance)
        elif way == "anything":
            forged.forge(path, forged.any_change(self.chance))
        else:
            forged.forge(path, forged.any_other_output(self.chance))
        self.messages.clear()
        # another one, because each says a thing once
        self.store = Store(self.store.folder, self.store.packer, self.messages.append)
        became = self.read(key, kind, None if way == "output" else digest)
        assert (became == "damaged") == bool(self.messages), (became, self.messages)
        # without its plugin an entry cannot be told from a forged one: it is not used, and stays
        stays = became != "damaged" or "may need --plugin" in self.messages[0]
        assert path.exists() == stays, self.messages
        assert all(blob.exists() for blob in self.blobs)
        self.counts[f"{way}: {became}"] += 1

    def read(self, key: str, kind: type, digest: str | None) -> str:
        """Read an entry; its first value must be of a type, and of a digest if there is one."""
        list(Upkeep(self.store.folder).entries())
        entry = self.store.find(key, outputs=2)
        if entry is None:
            return "damaged"
        if entry.state == "refused":
            return "refused"
        stands_in = not entry.faithful[0]
        try:
            value = self.store.load(entry, (object if stands_in else kind, float))[0]
        except DamagedEntry:
            return "damaged"
        lent = self.store.packer.lend(value)
        repr(lent)
        try:
            packed = self.store.packer.pack(value)
        except Unstorable:
            return "another value"
        if digest is not None:
            assert packed.digest == digest, entry
            return "the same value"
        return "another value"


def main() -> None:
    """Forge and read entries within little memory."""
    folder, seed, count = Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    warnings.simplefilter("ignore")
    fuzz = Fuzz(folder, seed)
    for _ in range(20):
        fuzz.once()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + GIB, used + GIB))
    for _ in range(count):
        fuzz.once()
    after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(json.dumps({"counts": fuzz.counts, "megabytes": (after - before) // 1024}))


if __name__ == "__main__":
    main()

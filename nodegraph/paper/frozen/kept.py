"""Values that a lock was made of, where a store still has them."""

from __future__ import annotations

import hashlib
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from typing import Any

from nodegraph.store import DamagedEntry, Store, Upkeep

_DIGITS = 10


class Kept:
    """Finds values in a store by the digests that a lock holds.

    Parameters
    ----------
    store
        Looked through once, when something is asked for.
    """

    def __init__(self, store: Store) -> None:
        self._store = store

    def values(self, node: str, digest: str, opaque: Sequence[bool]) -> tuple[Any, ...]:
        """Return the values of a digest; none if they are not stored.

        Parameters
        ----------
        node
            Name of the node that gave them: ``fill.muscle``.
        digest
            As `joined` makes it.
        opaque
            Which outputs do not count in it.
        """
        for key, digests in self._by_node.get(node, ()):
            if len(digests) == len(opaque) and digest:
                counted = zip(digests, opaque, strict=True)
                if joined(one for one, left_out in counted if not left_out) == digest:
                    return self._load(key)
        return ()

    def _load(self, key: str) -> tuple[Any, ...]:
        entry = self._store.find(key)
        try:
            return self._store.load(entry) if entry is not None else ()
        except DamagedEntry:
            return ()

    @cached_property
    def _by_node(self) -> Mapping[str, list[tuple[str, tuple[str, ...]]]]:
        found: dict[str, list[tuple[str, tuple[str, ...]]]] = defaultdict(list)
        for one in Upkeep(self._store.folder).entries():
            found[one.entry.node].append((one.entry.key, one.entry.digests))
        return found


def joined(digests: Iterable[str]) -> str:
    """Return one short digest of several; empty of none."""
    text = "\n".join(digests)
    return hashlib.sha256(text.encode()).hexdigest()[:_DIGITS] if text else ""

"""Values as a text and buffers, and back, without pickle: on disk, and to other processes.

What comes back is what went in, to the bit, or `Unstorable` says what cannot be kept. Numbers,
texts, truths and nothing stand for themselves in the text, which is JSON; anything else is a list
that begins with what it is.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Sequence
from copy import deepcopy
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar

from nodegraph.ports import Across
from nodegraph.store.numpys import is_numpys
from nodegraph.store.plain import (
    BASIC,
    Apart,
    Together,
    restorers,
    way_of,
)
from nodegraph.store.unstorable import Unreadable, Unstorable
from nodegraph.values import Value

if TYPE_CHECKING:
    from nodegraph.hooks import Storage
    from nodegraph.store.arrays import Buffer

__all__ = ["Packed", "Packer", "Unreadable", "Unstorable"]

T = TypeVar("T")

_encode = json.JSONEncoder(check_circular=False, allow_nan=False, separators=(",", ":")).encode


@dataclass(frozen=True)
class Packed:
    """A value as a text and the bytes of its arrays.

    Attributes
    ----------
    head : str
        JSON, in ASCII.
    buffers : tuple of memoryview
        Contiguous bytes; of large arrays these are the arrays' own memory.
    faithful : bool
        Whether what is put together from it is the value itself, and not a stand-in.
    """

    head: str
    buffers: tuple[memoryview, ...] = ()
    faithful: bool = True

    @cached_property
    def sums(self) -> tuple[str, ...]:
        """The SHA-256 of each buffer."""
        return tuple(hashlib.sha256(buffer).hexdigest() for buffer in self.buffers)

    @cached_property
    def digest(self) -> str:
        """The SHA-256 over the text, which has types, shapes and layouts, and all buffers."""
        said = "\n".join((self.head, *self.sums))
        return hashlib.sha256(said.encode("ascii")).hexdigest()


class Packer:
    """Takes values apart and puts them together.

    Parameters
    ----------
    storages
        How values of further types are kept; the first that fits a type is used, before all that
        is known here.
    packages
        Tells of a top-level package whether a stored value may make the program import it. What
        is imported already needs no leave.
    """

    def __init__(
        self,
        storages: Iterable[Storage] = (),
        packages: Callable[[str], bool] = lambda package: False,
    ) -> None:
        self._storages = tuple(storages)
        self._storage = _ByType(self._storage_of)
        self._ways = _ByType(lambda kind: way_of(kind, self._storage[kind]))
        self._lenders = _ByType(self._lender_of)
        self._restorers = restorers(self._storages, packages)

    def pack(self, value: Any) -> Packed:
        """Take a value apart.

        Raises
        ------
        Unstorable
            If it, or anything inside it, cannot be kept.
        """
        apart = Apart(self._ways)
        try:
            head = _encode(apart.plain(value))
        except RecursionError:
            raise Unstorable(type(value).__name__, "it is nested too deeply") from None
        return Packed(head, tuple(apart.buffers), apart.faithful)

    def unpack(self, head: str, buffers: Sequence[Buffer] = ()) -> Any:
        """Put a value together; its arrays lie in the given buffers, and nobody can write there.

        Raises
        ------
        Unreadable
            If that is not possible.
        """
        try:
            return Together(self._restorers, buffers).value(json.loads(head))
        except (Unreadable, MemoryError):
            raise
        except Exception as error:
            raise Unreadable(f"{type(error).__name__}: {error}") from error

    def digest(self, value: Any) -> str:
        """Return the SHA-256 of a value, or of what `pack` made of it."""
        return (value if isinstance(value, Packed) else self.pack(value)).digest

    def travels(self, kind: type) -> bool:
        """Return whether values declared to be of that type come back as themselves.

        Only the type is looked at: a list travels, and yet may hold what does not.
        """
        storage = self._storage[kind]
        if storage is not None:
            return storage.faithful
        return kind in BASIC or kind is Across or issubclass(kind, Value) or is_numpys(kind)

    def lend(self, value: Any) -> Any:
        """Return what one reader gets of a value."""
        lender = self._lenders[type(value)]
        return value if lender is None else lender(value)

    def _storage_of(self, kind: type) -> Storage | None:
        return next((one for one in self._storages if issubclass(kind, one.type)), None)

    def _lender_of(self, kind: type) -> Callable[[Any], Any] | None:
        storage = self._storage[kind]
        if storage is None and kind in (list, dict):
            return deepcopy
        return storage.lend if storage is not None else None


class _ByType(dict[type, T]):
    """What is found out once for each type."""

    def __init__(self, find: Callable[[type], T]) -> None:
        super().__init__()
        self._find = find

    def __missing__(self, kind: type) -> T:
        found = self[kind] = self._find(kind)
        return found

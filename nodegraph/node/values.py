"""What may travel between nodes: frozen records whose arrays nobody can change."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy.typing import NDArray

_PLAIN = (str, int, float, bytes, type(None))


class Value:
    """Base class of frozen dataclasses that travel as one value.

    A node may return several outputs as a frozen dataclass, whose fields are the ports. A
    dataclass that derives from `Value` is not taken apart: it is one output.
    """

    __slots__ = ()


@dataclass(frozen=True)
class Files(Value):
    """Files that a node has made: the machine alone writes them, into the folder of the run.

    Attributes
    ----------
    content : mapping of str to bytes
        By name: ``recording.c3d``, or ``takes/one.csv`` in a folder of its own.

    Raises
    ------
    ValueError
        If a name is empty, or leads out of the folder; or if what stands there is no bytes.
    """

    content: Mapping[str, bytes]

    def __post_init__(self) -> None:
        for name, content in self.content.items():
            parts = PurePosixPath(name).parts
            plain = "/".join(parts) == name and name.isprintable() and "\\" not in name
            if not parts or not plain or ".." in parts or name.startswith("/") or ":" in name:
                raise ValueError(f"{name!r} is no name of a file: write one such as recording.c3d")
            if not isinstance(content, bytes):
                raise ValueError(f"file {name!r}: must be bytes, got {type(content).__name__}")
        object.__setattr__(self, "content", dict(self.content))


def read_only(array: NDArray[Any]) -> NDArray[Any]:
    """Return the array such that nobody can write to it any more.

    An array that owns its memory is locked in place, without a copy: whoever made it gets an
    error on the next write, instead of a value that changes behind a reader's back. A view into
    memory that somebody else can still write to is copied.
    """
    if not array.flags.writeable and _base_is_locked(array):
        return array
    if array.base is not None:
        # sums run along the order in memory: in another one they differ in their last bit
        array = array.copy(order="K")
    array.flags.writeable = False
    return array


def locked(value: Any) -> Any:
    """Return a value of which nobody can change an array any more.

    An array is locked, and so are those in tuples and in the fields of a `Value`. Whatever else a
    value holds is its own concern.
    """
    if isinstance(value, _PLAIN):
        return value
    if isinstance(value, Value):
        for field in fields(value):  # type: ignore[arg-type]
            held = getattr(value, field.name, None)
            kept = locked(held)
            if kept is not held:
                object.__setattr__(value, field.name, kept)
        return value
    if type(value) is tuple:
        kept = tuple(map(locked, value))
        same = all(one is other for one, other in zip(kept, value, strict=True))
        return value if same else kept
    numpy = sys.modules.get("numpy")
    if not numpy or not isinstance(value, numpy.ndarray):
        return value
    array = read_only(value)
    # its owner could be unlocked again, a view of it cannot
    return array.view() if array.base is None else array


def _base_is_locked(array: NDArray[Any]) -> bool:
    base = array.base
    while base is not None:
        if isinstance(base, (bytes, memoryview)):
            return isinstance(base, bytes) or base.readonly
        flags = getattr(base, "flags", None)
        if flags is None or flags.writeable:
            return False
        base = base.base
    return True

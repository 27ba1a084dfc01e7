"""What may travel between nodes: frozen records whose arrays nobody can change."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Value:
    """Base class of frozen dataclasses that travel as one value.

    A node may return several outputs as a frozen dataclass, whose fields are the ports. A
    dataclass that derives from `Value` is not taken apart: it is one output.
    """

    __slots__ = ()


def read_only(array: NDArray[Any]) -> NDArray[Any]:
    """Return the array such that nobody can write to it any more.

    An array that owns its memory is locked in place, without a copy: whoever made it gets an
    error on the next write, instead of a value that changes behind a reader's back. A view into
    memory that somebody else can still write to is copied.
    """
    if not array.flags.writeable and _base_is_locked(array):
        return array
    if array.base is not None:
        array = array.copy()
    array.flags.writeable = False
    return array


def _base_is_locked(array: NDArray[Any]) -> bool:
    base = array.base
    while base is not None:
        flags = getattr(base, "flags", None)
        if flags is None or flags.writeable:
            return False
        base = base.base
    return True

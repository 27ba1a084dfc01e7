"""Values that travel between nodes: frozen records with read-only arrays."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import PurePosixPath
from reprlib import Repr
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_PLAIN = (str, int, float, bytes, type(None))
_PLAIN_TYPES = frozenset({*_PLAIN, bool})


class Value:
    """Base class of frozen dataclasses that travel as one value.

    The fields of a frozen dataclass that a node returns are separate outputs. A dataclass that
    derives from `Value` is one output. It is printed with its arrays' shapes and the first items
    of its tuples.
    """

    __slots__ = ()

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        cls.__repr__ = cls.__repr__  # type: ignore[method-assign]  # its own: dataclass keeps it

    def __repr__(self) -> str:
        return _ShortRepr().of_fields(self)


@dataclass(frozen=True)
class Files(Value):
    """Files that a node returns; the machine writes them into the folder of the run.

    Attributes
    ----------
    content : mapping of str to bytes
        By name: ``recording.c3d``, or ``takes/one.csv`` in a subfolder. A name that some system
        does not accept, or that differs from another in case only, is written with a digest in it.

    Raises
    ------
    ValueError
        If a name is empty or leads out of the folder, or if a content is not bytes.
    """

    content: Mapping[str, bytes]

    def __post_init__(self) -> None:
        for name, content in self.content.items():
            parts = PurePosixPath(name).parts
            plain = "/".join(parts) == name and name.isprintable() and "\\" not in name
            if not parts or not plain or ".." in parts or name.startswith("/") or ":" in name:
                raise ValueError(f"{name!r} is not a file name: write one such as recording.c3d")
            if not isinstance(content, bytes):
                raise ValueError(f"file {name!r}: must be bytes, got {type(content).__name__}")
        object.__setattr__(self, "content", dict(self.content))


Scalar = TypeVar("Scalar", bound="np.generic")


def read_only(array: NDArray[Scalar]) -> NDArray[Scalar]:
    """Return an array with the same content that can no longer be written to.

    An array that owns its memory is locked in place, without a copy: code that still writes to it
    gets an error, instead of changing a value behind a reader's back. A view into memory that can
    still be written to is copied, and so is one with gaps: stored results have none.
    """
    if not array.flags.writeable and _base_is_locked(array) and _is_dense(array):
        return array
    if array.base is not None:
        # sums run along the order in memory: in another one they differ in their last bit
        array = array.copy(order="K")
    array.flags.writeable = False
    return array


def locked(value: object) -> object:
    """Return a value whose arrays can no longer be written to.

    Arrays in tuples and in the fields of a `Value` are locked as well, those in other containers
    are not.
    """
    if isinstance(value, _PLAIN):
        return value
    if isinstance(value, Value):
        for field in fields(value):  # type: ignore[arg-type]
            part = getattr(value, field.name, None)
            locked_part = locked(part)
            if locked_part is not part:
                object.__setattr__(value, field.name, locked_part)
        return value
    if type(value) is tuple:
        if _PLAIN_TYPES.issuperset(map(type, value)):  # such as many names
            return value
        parts = tuple(map(locked, value))
        is_same = all(new is old for new, old in zip(parts, value, strict=True))
        return value if is_same else parts
    numpy = sys.modules.get("numpy")
    if not numpy or not isinstance(value, numpy.ndarray):
        return value
    array = read_only(value)
    # its owner could be unlocked again, a view of it cannot
    return array.view() if array.base is None else array


class _ShortRepr(Repr):
    """Arrays by their shapes, of tuples and texts what fits into a line."""

    def __init__(self) -> None:
        super().__init__()
        self.maxtuple = 3
        self.maxother = self.maxstring = 60

    def of_fields(self, value: Value) -> str:
        parts = (
            f"{field.name}={self.repr(getattr(value, field.name))}"
            for field in fields(value)  # type: ignore[arg-type]
            if field.repr
        )
        return f"{type(value).__qualname__}({', '.join(parts)})"

    def repr_ndarray(self, array: NDArray[np.generic], _: int) -> str:
        return f"{array.dtype} array of {' x '.join(map(str, array.shape))}"

    def repr_instance(self, value: object, level: int) -> str:
        return repr(value) if isinstance(value, Value) else super().repr_instance(value, level)


def _is_dense(array: NDArray[np.generic]) -> bool:
    """Return whether an array has all bytes between its ends, whatever the order of its axes."""
    if array.flags.forc:
        return True
    order = sorted(range(array.ndim), key=lambda axis: -abs(array.strides[axis]))
    return array.transpose(order).flags.c_contiguous


def _base_is_locked(array: NDArray[np.generic]) -> bool:
    base = array.base
    while base is not None:
        if isinstance(base, (bytes, memoryview)):
            return isinstance(base, bytes) or base.readonly
        flags = getattr(base, "flags", None)
        if flags is None or flags.writeable:
            return False
        base = base.base
    return True

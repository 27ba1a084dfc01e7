"""Arrays as a type, a shape and bytes, and back, upon the same bytes."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from math import prod
from typing import TYPE_CHECKING

from nodegraph.store.errors import Unreadable, Unstorable

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Buffer = bytes | bytearray | memoryview | NDArray[np.uint8]

_KINDS = frozenset("biufcmMSU")
_OF_ONE_MACHINE = frozenset("gG")
"""Long doubles: the same name means other numbers on another processor."""
_MOST_AXES = 64
_EMPTY = 2**28
"""Bytes of an array whose axes of no length had one: what is computed of it may take them."""
_LAST_CHARACTER = 0x10FFFF


def encode_array(array: NDArray[np.generic]) -> tuple[list[object], memoryview]:
    """Return an array's type, shape and order of axes, and its bytes: no copy unless it has gaps.

    The order is that from the slowest axis to the fastest in memory, left out where it is their
    own.
    """
    kind = type_name(array.dtype)
    shape = list(array.shape)
    if not array.nbytes and _is_too_long(shape, array.itemsize):
        raise Unstorable(f"array of shape {array.shape}", "it has no numbers, and is too long")
    if array.flags.c_contiguous:
        return [kind, shape], _bytes_of(array)
    order = sorted(range(array.ndim), key=lambda axis: -abs(array.strides[axis]))
    moved = array.transpose(order)
    return [kind, shape, order], _bytes_of(moved if moved.flags.c_contiguous else moved.copy("C"))


def decode_array(
    buffer: Buffer,
    name: str,
    shape: list[int],
    order: list[int] | None = None,
) -> NDArray[np.generic]:
    """Return the array again, read-only, upon the given bytes themselves.

    Parameters
    ----------
    buffer
        Its bytes.
    name, shape, order
        As `encode_array` returned them; everything is checked before any memory is taken.

    Raises
    ------
    Unreadable
        If that describes no array of these bytes.
    """
    import numpy as np

    kind, size = _type_named(name), len(buffer)
    _check_shape(shape, kind.itemsize, size)
    axes = range(len(shape))
    if order is not None and sorted(order) != list(axes):
        raise Unreadable(f"{order} is not an order of {len(axes)} axes")
    memory = np.frombuffer(buffer, np.uint8) if size else np.empty(0, np.uint8)
    lengths = shape if order is None else [shape[axis] for axis in order]
    slow_to_fast: NDArray[np.generic] = np.ndarray(lengths, kind, memory)
    if not slow_to_fast.flags.aligned:
        slow_to_fast = slow_to_fast.copy()
    if kind.kind == "U" and size:
        _check_characters(slow_to_fast)
    slow_to_fast.flags.writeable = False
    if order is None:
        return slow_to_fast
    return slow_to_fast.transpose([order.index(axis) for axis in axes])


def type_name(kind: np.dtype[np.generic]) -> str:
    """Return a text from which numpy makes the very same type.

    Raises
    ------
    Unstorable
        If there is none: objects, records, types of other libraries, long doubles.
    """
    import numpy as np

    shown = f"array of {kind.name}"
    if kind.kind not in _KINDS:
        raise Unstorable(shown, "only numbers, strings and times are kept as arrays")
    if kind.char in _OF_ONE_MACHINE:
        raise Unstorable(shown, "its bytes mean other numbers on another processor")
    for name in (kind.str, f"{kind.str[0]}{kind.char}"):
        again = np.dtype(name)
        if again == kind and again.char == kind.char:
            return name
    raise Unstorable(shown)


def encode_number(number: np.generic) -> list[str]:
    """Return the type and the bytes of a number of numpy's, such as ``numpy.float32(1)``."""
    return [type_name(number.dtype), number.tobytes().hex()]


def decode_number(name: str, content: str) -> object:
    """Return the number again.

    Raises
    ------
    Unreadable
        If that describes no number.
    """
    import numpy as np

    kind, memory = _type_named(name), bytes.fromhex(content)
    if len(memory) != kind.itemsize:
        raise Unreadable(f"a number of {kind.itemsize} bytes has {len(memory)}")
    return np.frombuffer(memory, kind)[0]


def _bytes_of(array: NDArray[np.generic]) -> memoryview:
    import numpy as np

    if not array.nbytes:
        return memoryview(b"")
    # through uint8, because times have no buffer of their own
    return array.reshape(-1).view(np.uint8).data


@lru_cache(maxsize=256)
def _type_named(name: str) -> np.dtype[np.generic]:
    """Return the type that `type_name` gives that name."""
    import numpy as np

    kind = np.dtype(name)
    if kind.kind not in _KINDS or type_name(kind) != name:
        raise Unreadable(f"{name!r} is not a type of an array that is kept")
    return kind


def _check_shape(shape: list[int], itemsize: int, size: int) -> None:
    if len(shape) > _MOST_AXES:
        raise Unreadable(f"an array has {len(shape)} axes")
    for length in shape:
        if type(length) is not int or length < 0:
            raise Unreadable(f"an array has the shape {shape}")
    needed = prod(shape) * itemsize
    if needed != size:
        raise Unreadable(f"an array of {needed} bytes has {size}")
    if not size and _is_too_long(shape, itemsize):
        raise Unreadable(f"an array without numbers has the shape {shape}")


def _is_too_long(shape: Iterable[int], itemsize: int) -> bool:
    return prod(length or 1 for length in shape) * max(itemsize, 1) > _EMPTY


def _check_characters(texts: NDArray[np.generic]) -> None:
    """Refuse strings with invalid code points: numpy fails when one of them is read."""
    codes = texts.reshape(-1).view(texts.dtype.str[0] + "u4")
    if codes.max() > _LAST_CHARACTER:
        raise Unreadable("an array of strings has an invalid code point")


def is_numpy(kind: type) -> bool:
    """Return whether values of the type are arrays of numpy, or numbers taken from them."""
    if not kind.__module__.startswith("numpy"):
        return False
    import numpy as np

    return kind is np.ndarray or (issubclass(kind, np.generic) and kind.__module__ == "numpy")

"""Arrays and numbers of numpy as plain data and bytes, and back: same type, same memory order.

The order in memory is kept because sums run along it: an array in another order gives later
results that differ in their last bit.
"""

from __future__ import annotations

from math import prod
from typing import TYPE_CHECKING, Any

from nodegraph.store.unstorable import Unreadable, Unstorable

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Buffer = bytes | bytearray | memoryview | NDArray[np.uint8]

_KINDS = frozenset("biufcmMSU")
_OF_ONE_MACHINE = frozenset("gG")
"""Long doubles: the same name means other numbers on another processor."""


def array_apart(array: NDArray[Any]) -> tuple[list[Any], memoryview]:
    """Return an array's type, shape and layout, and its bytes: no copy unless it has gaps.

    The layout is the order of axes from the slowest to the fastest in memory, or nothing where
    that is their own order; strides follow only where they do not result from it.
    """
    kind = type_name(array.dtype)
    shape = list(array.shape)
    if array.flags.c_contiguous:
        return [kind, shape], _bytes_of(array)
    order = sorted(range(array.ndim), key=lambda axis: -abs(array.strides[axis]))
    moved = array.transpose(order)
    if moved.flags.c_contiguous:
        return [kind, shape, order], _bytes_of(moved)
    return [kind, shape, order, list(array.strides)], _bytes_of(moved.copy(order="C"))


def array_together(parts: list[Any], buffer: Buffer) -> NDArray[Any]:
    """Return the array again, read-only, upon the given bytes themselves."""
    import numpy as np

    kind, shape = np.dtype(parts[0]), tuple(parts[1])
    order = list(parts[2] if len(parts) > 2 else range(len(shape)))
    memory = _memory(buffer, prod(shape) * kind.itemsize)
    slow_to_fast = np.ndarray(tuple(shape[axis] for axis in order), kind, memory)
    if not slow_to_fast.flags.aligned:
        slow_to_fast = slow_to_fast.copy()
    slow_to_fast.flags.writeable = False
    if len(parts) > 3:
        return _with_gaps(slow_to_fast, order, shape, tuple(parts[3]))
    return slow_to_fast.transpose([order.index(axis) for axis in range(len(shape))])


def type_name(kind: np.dtype[Any]) -> str:
    """Return a text from which numpy makes the very same type.

    Raises
    ------
    Unstorable
        If there is none: objects, records, types of other libraries, long doubles.
    """
    import numpy as np

    shown = f"array of {kind.name}"
    if kind.kind not in _KINDS:
        raise Unstorable(shown, "only numbers, texts and times are kept as arrays")
    if kind.char in _OF_ONE_MACHINE:
        raise Unstorable(shown, "its bytes mean other numbers on another processor")
    for name in (kind.str, f"{kind.str[0]}{kind.char}"):
        again = np.dtype(name)
        if again == kind and again.char == kind.char:
            return name
    raise Unstorable(shown)


def number_apart(number: np.generic) -> list[str]:
    """Return the type and the bytes of a number of numpy's, such as ``numpy.float32(1)``."""
    return [type_name(number.dtype), number.tobytes().hex()]


def number_together(parts: list[str]) -> Any:
    """Return the number again."""
    import numpy as np

    return np.frombuffer(bytes.fromhex(parts[1]), parts[0])[0]


def _bytes_of(array: NDArray[Any]) -> memoryview:
    import numpy as np

    if not array.nbytes:
        return memoryview(b"")
    # through uint8, because times have no buffer of their own
    return array.reshape(-1).view(np.uint8).data


def _memory(buffer: Buffer, size: int) -> NDArray[np.uint8]:
    import numpy as np

    if len(buffer) != size:
        raise Unreadable(f"an array of {size} bytes has {len(buffer)}")
    return np.frombuffer(buffer, np.uint8) if size else np.empty(0, np.uint8)


def _with_gaps(
    packed: NDArray[Any], order: list[int], shape: tuple[int, ...], strides: tuple[int, ...]
) -> NDArray[Any]:
    """Return the array in memory of its own, spaced as it was."""
    import numpy as np

    reach = [(length - 1) * stride for length, stride in zip(shape, strides, strict=True)]
    memory = np.zeros(sum(map(abs, reach)) + packed.itemsize, np.uint8)
    start = -sum(one for one in reach if one < 0)
    spaced: NDArray[Any] = np.ndarray(shape, packed.dtype, memory, start, strides)
    spaced.transpose(order)[...] = packed
    memory.flags.writeable = spaced.flags.writeable = False
    return spaced

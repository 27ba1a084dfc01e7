"""Values as a text and buffers, and back, without pickle: on disk, and to other processes.

What comes back is what went in, to the bit, or `Unstorable` says what cannot be kept. Numbers,
texts, truths and nothing stand for themselves in the text, which is JSON; anything else is a list
that begins with what it is.
"""

from __future__ import annotations

import hashlib
import json
import math
import struct
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, fields, is_dataclass
from functools import cached_property, partial
from importlib import import_module
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from nodegraph.errors import NodegraphError
from nodegraph.node.ports import Absent, Across
from nodegraph.node.values import Value

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from nodegraph.plugin.hook_types import Storage


class Unstorable(NodegraphError):
    """A value cannot be kept without pickle.

    Attributes
    ----------
    kind : str
        The type that cannot be kept.
    inside : tuple of str
        What holds it, from the inside out.
    """

    def __init__(self, kind: str, why: str = "no plugin says how to keep it") -> None:
        self.kind = kind
        self.why = why
        self.inside: tuple[str, ...] = ()
        super().__init__(kind, why)

    def __str__(self) -> str:
        where = "".join(f" inside {one}" for one in self.inside)
        return f"a value of type {self.kind}{where} cannot be kept: {self.why}"


class Unreadable(NodegraphError):
    """What was kept cannot be put together again."""


_UNSET = object()


def class_name(kind: type) -> str:
    """Return a name by which the class is found again: ``module:Class``.

    Raises
    ------
    Unstorable
        If it is no dataclass, holds more than its fields, or is not found by its name.
    """
    if not is_dataclass(kind):
        raise Unstorable(kind.__name__, "a Value is kept if it is a dataclass")
    if kind.__new__ is not object.__new__:  # a mapping, an array, an exception besides
        raise Unstorable(kind.__name__, "it is more than its fields")
    if _found(sys.modules.get(kind.__module__), kind.__qualname__) is not kind:
        raise Unstorable(kind.__name__, f"{kind.__module__} has no class {kind.__qualname__}")
    return f"{kind.__module__}:{kind.__qualname__}"


def class_named(name: str, packages: Callable[[str], bool]) -> type[Value]:
    """Return the class of that name.

    What is stored must not make this program run code that nobody chose: a module that is not
    imported yet is imported only if `packages` takes the package that it lies in.

    Raises
    ------
    Unreadable
        If there is none, it may not be imported, or it is no dataclass that derives from `Value`.
    """
    module, _, qualified = name.partition(":")
    if module not in sys.modules and packages(module.partition(".")[0]):
        import_module(module)
    kind = _found(sys.modules.get(module), qualified)
    if isinstance(kind, type) and issubclass(kind, Value) and is_dataclass(kind):
        return kind
    raise Unreadable(f"{name!r} is no class of values here")


def contents(value: Any, names: tuple[str, ...]) -> list[Any]:
    """Return the fields of a value.

    Raises
    ------
    Unstorable
        If a field has no value, or the value has more than its fields.
    """
    found = [getattr(value, name, _UNSET) for name in names]
    if any(one is _UNSET for one in found):
        raise Unstorable(type(value).__name__, "a field of it has no value")
    more = set(getattr(value, "__dict__", ())).difference(names)
    # what it has computed from its fields, it can compute again
    kept = {name for name in more if not isinstance(_attribute(value, name), cached_property)}
    if kept:
        raise Unstorable(type(value).__name__, f"{', '.join(sorted(kept))}: not among its fields")
    return found


def with_contents(kind: type[Value], given: Mapping[str, Any]) -> Value:
    """Return a value with these fields as they are: nothing is checked or computed anew.

    Raises
    ------
    Unreadable
        If the class has other fields now.
    """
    if set(field_names(kind)) != set(given):
        raise Unreadable(f"{kind.__name__} has other fields than when it was kept")
    made = object.__new__(kind)
    for name, value in given.items():
        object.__setattr__(made, name, value)
    return made


def field_names(kind: type) -> tuple[str, ...]:
    """Return the names of a dataclass' fields."""
    return tuple(field.name for field in fields(kind))


def _attribute(value: Any, name: str) -> Any:
    return getattr(type(value), name, None)


def _found(module: Any, qualified: str) -> Any:
    """Return what a module holds under a dotted name, without asking it to import anything."""
    found = module
    for part in qualified.split("."):
        found = getattr(found, "__dict__", {}).get(part)
    return found


if TYPE_CHECKING:
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


def is_numpys(kind: type) -> bool:
    """Return whether values of the type are arrays of numpy, or numbers taken from them."""
    if not kind.__module__.startswith("numpy"):
        return False
    import numpy as np

    return kind is np.ndarray or (issubclass(kind, np.generic) and kind.__module__ == "numpy")


def numpys_way(kind: type) -> Callable[[Any, Apart], Any]:
    """Return what takes values of such a type apart."""
    import numpy as np

    def array(value: Any, apart: Apart) -> Any:
        parts, buffer = array_apart(value)
        return ["array", apart.keep(buffer), *parts]

    if kind is np.ndarray:
        return array
    if kind is np.str_:
        # str() of it would drop zeros at its end
        return lambda value, apart: ["numpy.str", apart.plain("".join(value))]
    if kind is np.bytes_:
        return lambda value, apart: ["numpy.bytes", bytes(value).hex()]
    return lambda value, apart: ["number", *number_apart(value)]


def _array_again(plain: list[Any], together: Together) -> Any:
    return array_together(plain[2:], together.buffers[plain[1]])


def _number_again(plain: list[Any], together: Together) -> Any:
    return number_together(plain[1:])


def _numpys_str(plain: list[Any], together: Together) -> Any:
    import numpy as np

    return np.str_(together.value(plain[1]))


def _numpys_bytes(plain: list[Any], together: Together) -> Any:
    import numpy as np

    return np.bytes_(bytes.fromhex(plain[1]))


NUMPYS: dict[str, Callable[[list[Any], Together], Any]] = {
    "array": _array_again,
    "number": _number_again,
    "numpy.str": _numpys_str,
    "numpy.bytes": _numpys_bytes,
}


_PATH = type(Path())
_LARGEST = 2**63
"""From here on, decimal digits of whole numbers take long, and Python refuses very many."""

Way = Callable[[Any, "Apart"], Any]


class Apart:
    """One value being taken apart: its buffers so far, and whether all of it comes back."""

    __slots__ = ("_ways", "buffers", "faithful")

    def __init__(self, ways: Mapping[type, Way]) -> None:
        self._ways = ways
        self.buffers: list[memoryview] = []
        self.faithful = True

    def plain(self, value: Any) -> Any:
        """Return a value as JSON knows it."""
        return self._ways[type(value)](value, self)

    def all(self, values: Iterable[Any], outer: str) -> list[Any]:
        """Return what something is made of, and say where something lies that cannot be kept."""
        try:
            return [self._ways[type(value)](value, self) for value in values]
        except Unstorable as error:
            error.inside += (outer,)
            raise

    def keep(self, buffer: memoryview) -> int:
        """Keep bytes beside the text and return their number."""
        self.buffers.append(buffer)
        return len(self.buffers) - 1


class Together:
    """One value being put together from its text and buffers."""

    __slots__ = ("_ways", "buffers")

    def __init__(
        self, ways: Mapping[str, Callable[[list[Any], Together], Any]], buffers: Sequence[Buffer]
    ) -> None:
        self._ways = ways
        self.buffers = buffers

    def value(self, plain: Any) -> Any:
        """Return the value that `Apart.plain` made this of."""
        return self._ways[plain[0]](plain, self) if isinstance(plain, list) else plain

    def all(self, plain: Iterable[Any]) -> list[Any]:
        """Return several values."""
        return [self.value(one) for one in plain]


def way_of(kind: type, storage: Storage | None) -> Way:
    """Return what takes values of that type apart.

    Raises
    ------
    Unstorable
        If nothing does.
    """
    if storage is not None:
        return partial(_stored, storage, storage_name(storage))
    if kind in BASIC:
        return BASIC[kind]
    if kind in (Across, Absent):
        return partial(_record, kind.__name__.lower(), field_names(kind), _own_contents)
    if is_numpys(kind):
        return numpys_way(kind)
    if issubclass(kind, Value):
        return partial(_value, class_name(kind), field_names(kind))
    raise Unstorable(kind.__qualname__)


def storage_name(storage: Storage) -> str:
    """Return the name by which a storage is found again."""
    return f"{storage.type.__module__}:{storage.type.__qualname__}"


def restorers(
    storages: Iterable[Storage], packages: Callable[[str], bool]
) -> Mapping[str, Callable[[list[Any], Together], Any]]:
    """Return what puts each kind of list together, by its first word."""
    by_name = {storage_name(one): one for one in reversed(tuple(storages))}
    return {
        **_RESTORED,
        **NUMPYS,
        "stored": partial(_restored, by_name),
        "value": partial(_restored_value, packages),
    }


def _itself(value: Any, apart: Apart) -> Any:
    return value


def _int(value: int, apart: Apart) -> Any:
    return value if -_LARGEST < value < _LARGEST else ["int", hex(value)]


def _float(value: float, apart: Apart) -> Any:
    # a NaN has 52 bits of its own, and no way into JSON
    return value if math.isfinite(value) else ["float", struct.pack("<d", value).hex()]


def _str(value: str, apart: Apart) -> Any:
    if value.isascii():
        return value
    try:
        value.encode()
    except UnicodeEncodeError:  # JSON would join two halves of a character into one
        return ["str", value.encode("utf-8", "surrogatepass").hex()]
    return value


def _bytes(value: bytes, apart: Apart) -> Any:
    return ["bytes", apart.keep(memoryview(value))]


def _path(value: Path, apart: Apart) -> Any:
    return ["path", _str(str(value), apart)]


def _tuple(value: tuple[Any, ...], apart: Apart) -> Any:
    return ["tuple", *apart.all(value, "tuple")]


def _list(value: list[Any], apart: Apart) -> Any:
    return ["list", *apart.all(value, "list")]


def _dict(value: dict[Any, Any], apart: Apart) -> Any:
    return ["dict", *apart.all((one for item in value.items() for one in item), "dict")]


def _own_contents(value: Any, names: tuple[str, ...]) -> list[Any]:
    return [getattr(value, name) for name in names]


def _record(
    word: str,
    names: tuple[str, ...],
    contents_of: Callable[[Any, tuple[str, ...]], list[Any]],
    value: Any,
    apart: Apart,
) -> Any:
    return [word, *apart.all(contents_of(value, names), type(value).__name__)]


def _value(name: str, names: tuple[str, ...], value: Value, apart: Apart) -> Any:
    plain = apart.all(contents(value, names), type(value).__name__)
    return ["value", name, list(names), *plain]


def _stored(storage: Storage, name: str, value: Any, apart: Apart) -> Any:
    try:
        parts = storage.take_apart(value)
    except Unstorable:
        raise
    except Exception as error:
        raise Unstorable(type(value).__name__, str(error) or type(error).__name__) from error
    apart.faithful &= storage.faithful
    return ["stored", name, *apart.all((parts,), type(value).__name__)]


def _dict_again(plain: list[Any], together: Together) -> Any:
    parts = together.all(plain[1:])
    return dict(zip(parts[::2], parts[1::2], strict=True))


def _restored(by_name: Mapping[str, Storage], plain: list[Any], together: Together) -> Any:
    storage = by_name.get(plain[1])
    if storage is None:
        raise Unreadable(f"no plugin says how to put a {plain[1]} together")
    return storage.put_together(together.value(plain[2]))


def _restored_value(packages: Callable[[str], bool], plain: list[Any], together: Together) -> Any:
    given = dict(zip(plain[2], together.all(plain[3:]), strict=True))
    return with_contents(class_named(plain[1], packages), given)


BASIC: dict[type, Way] = {
    type(None): _itself,
    bool: _itself,
    int: _int,
    float: _float,
    str: _str,
    bytes: _bytes,
    _PATH: _path,
    tuple: _tuple,
    list: _list,
    dict: _dict,
}

_RESTORED: dict[str, Callable[[list[Any], Together], Any]] = {
    "int": lambda plain, together: int(plain[1], 16),
    "float": lambda plain, together: struct.unpack("<d", bytes.fromhex(plain[1]))[0],
    "str": lambda plain, together: bytes.fromhex(plain[1]).decode("utf-8", "surrogatepass"),
    "bytes": lambda plain, together: bytes(together.buffers[plain[1]]),
    "path": lambda plain, together: Path(together.value(plain[1])),
    "tuple": lambda plain, together: tuple(together.all(plain[1:])),
    "list": lambda plain, together: together.all(plain[1:]),
    "dict": _dict_again,
    "across": lambda plain, together: Across(*together.all(plain[1:])),
    "absent": lambda plain, together: Absent(*together.all(plain[1:])),
}


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

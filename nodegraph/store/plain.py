"""How each kind of value is taken apart and put together: one pair of functions for each."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nodegraph.ports import Absent, Across
from nodegraph.store.numpys import NUMPYS, is_numpys, numpys_way
from nodegraph.store.records import class_name, class_named, contents, field_names, with_contents
from nodegraph.store.unstorable import Unreadable, Unstorable
from nodegraph.values import Value

if TYPE_CHECKING:
    from nodegraph.hooks import Storage
    from nodegraph.store.arrays import Buffer

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

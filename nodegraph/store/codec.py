"""Values as a text and buffers, and back, without pickle: on disk, and to other processes.

What comes back is what went in, to the bit, or `Unstorable` says what cannot be kept. Numbers,
strings, booleans and null are written as JSON; anything else is a list whose first item names its
kind.
"""

from __future__ import annotations

import hashlib
import json
import math
import struct
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, replace
from functools import cache, cached_property, partial
from itertools import chain
from operator import is_
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, get_type_hints

from nodegraph.node.ports import Absent, Across
from nodegraph.node.values import Value, locked
from nodegraph.plugin.hook_types import expect
from nodegraph.store.arrays import (
    decode_array,
    decode_number,
    encode_array,
    encode_number,
    is_numpy,
)
from nodegraph.store.classes import class_name, class_named, contents, field_names, with_contents
from nodegraph.store.errors import Unreadable, Unstorable

if TYPE_CHECKING:
    from nodegraph.plugin.kind import Kind
    from nodegraph.store.arrays import Buffer


def numpy_encoder(kind: type) -> Callable[[Any, Encoder], object]:
    """Return the function that encodes values of such a type."""
    import numpy as np

    def array(value: Any, encoder: Encoder) -> object:
        parts, buffer = encode_array(value)
        return ["array", encoder.keep(buffer), *parts]

    if kind is np.ndarray:
        return array
    if kind is np.str_:
        # str() of it would drop zeros at its end
        return lambda value, encoder: ["numpy.str", encoder.plain("".join(value))]
    if kind is np.bytes_:
        return lambda value, encoder: ["numpy.bytes", bytes(value).hex()]
    return lambda value, encoder: ["number", *encode_number(value)]


def _decode_numpy_str(decoder: Decoder, plain: object) -> object:
    import numpy as np

    return np.str_(decoder.text(plain))


def _decode_numpy_bytes(decoder: Decoder, content: str) -> object:
    import numpy as np

    return np.bytes_(bytes.fromhex(content))


_PATH = type(Path())
_LARGEST = 2**63
"""From here on, decimal digits of whole numbers take long, and Python refuses very many."""
_DEEPEST = 100
"""Levels of lists in lists: what is kept must be read again wherever in the program that is."""

Encode = Callable[[Any, "Encoder"], object]
Decode = Callable[..., object]
"""Called with a `Decoder` and the items of a list after the first."""


class Encoder:
    """Encodes one value.

    Attributes
    ----------
    buffers : list of memoryview
        So far.
    faithful : bool
        Whether all of it comes back.
    """

    __slots__ = ("_depth", "_encoders", "buffers", "faithful")

    def __init__(self, encoders: Mapping[type, Encode]) -> None:
        self._encoders = encoders
        self._depth = 0
        self.buffers: list[memoryview] = []
        self.faithful = True

    def plain(self, value: object) -> object:
        """Return a value as JSON knows it."""
        return self._encoders[type(value)](value, self)

    def all(self, values: Iterable[object], outer: str) -> list[object]:
        """Return the plain parts of a value; errors name the place of what cannot be kept."""
        self._depth += 1
        if self._depth > _DEEPEST:
            raise RecursionError
        try:
            plain = [self._encoders[type(value)](value, self) for value in values]
        except Unstorable as error:
            error.inside += (outer,)
            raise
        self._depth -= 1
        return plain

    def keep(self, buffer: memoryview) -> int:
        """Keep bytes beside the text and return their number."""
        self.buffers.append(buffer)
        return len(self.buffers) - 1


class Decoder:
    """Decodes one value from its text and buffers, neither of which is trusted.

    Parameters
    ----------
    decoders
        By the first item of a list.
    buffers
        Each belongs to one place in the text, in the same order.
    stand_ins
        Whether what stands in for a value may be in it.
    """

    def __init__(
        self, decoders: Mapping[str, Decode], buffers: Sequence[Buffer], *, stand_ins: bool
    ) -> None:
        self._decoders = decoders
        self._buffers = buffers
        self._next = 0
        self._depth = 0
        self._known: dict[object, Any] = {}
        self.stand_ins = stand_ins

    def whole(self, plain: object) -> object:
        """Return the value that `Encoder.plain` encoded as this with all buffers."""
        value = self.value(plain)
        if self._next != len(self._buffers):
            raise Unreadable(f"{len(self._buffers)} buffers, of which {self._next} have a place")
        return value

    def value(self, plain: object) -> object:
        """Return the value that `Encoder.plain` encoded as this."""
        return self._decoders[plain[0]](self, *plain[1:]) if isinstance(plain, list) else plain

    def all(self, plain: Iterable[object]) -> list[Any]:
        """Return several values."""
        self._depth += 1
        if self._depth > _DEEPEST:
            raise Unreadable("it is nested too deeply")
        values = [self.value(part) for part in plain]
        self._depth -= 1
        return values

    def text(self, plain: object) -> str:
        """Return a value that is a text."""
        text = self.value(plain)
        if not isinstance(text, str):
            raise Unreadable(f"a text is a {type(text).__name__}")
        return text

    def buffer(self, number: int) -> Buffer:
        """Return the next buffer, which has that number."""
        if number != self._next or number >= len(self._buffers):
            raise Unreadable(f"buffer {number} of {len(self._buffers)} in place of {self._next}")
        self._next += 1
        return self._buffers[number]

    def content(self, buffer: Buffer) -> bytes:
        """Return a copy of a buffer, the same one wherever that buffer has a further place."""
        if id(buffer) not in self._known:
            self._known[id(buffer)] = bytes(buffer)
        content: bytes = self._known[id(buffer)]
        return content


def encoder_for(kind: type, storage: Kind | None) -> Encode:
    """Return the function that encodes values of a type.

    Raises
    ------
    Unstorable
        If nothing does.
    """
    if storage is not None:
        return partial(_encode_stored, storage, storage_name(storage))
    if kind in BASIC_ENCODERS:
        return BASIC_ENCODERS[kind]
    if kind in (Across, Absent):
        return partial(_encode_record, kind.__name__.lower(), field_names(kind))
    if is_numpy(kind):
        return numpy_encoder(kind)
    if issubclass(kind, Value):
        return partial(_encode_value, class_name(kind), field_names(kind))
    raise Unstorable(kind.__qualname__)


def storage_name(storage: Kind) -> str:
    """Return the name by which a storage is found again."""
    return f"{storage.type.__module__}:{storage.type.__qualname__}"


def decoders_with(
    storages: Iterable[Kind], packages: Callable[[str], bool]
) -> Mapping[str, Decode]:
    """Return the functions that decode each kind of list, by its first item."""
    by_name = {storage_name(storage): storage for storage in reversed(tuple(storages))}
    return {
        **_DECODERS,
        "stored": partial(_decode_stored, by_name),
        "value": partial(_decode_value, packages),
    }


def _encode_as_is(value: object, encoder: Encoder) -> object:
    return value


def _encode_record(word: str, names: tuple[str, ...], value: object, encoder: Encoder) -> object:
    return [word, *encoder.all((getattr(value, name) for name in names), type(value).__name__)]


def _encode_value(name: str, names: tuple[str, ...], value: Value, encoder: Encoder) -> object:
    plain = encoder.all(contents(value, names), type(value).__name__)
    return ["value", name, list(names), *plain]


def _encode_stored(storage: Kind, name: str, value: object, encoder: Encoder) -> object:
    assert storage.take_apart is not None
    try:
        parts = storage.take_apart(value)
    except Unstorable:
        raise
    except Exception as error:
        raise Unstorable(type(value).__name__, str(error) or type(error).__name__) from error
    encoder.faithful &= storage.faithful
    return ["stored", name, *encoder.all((parts,), type(value).__name__)]


def _decode_dict(decoder: Decoder, *plain: object) -> dict[object, object]:
    parts = decoder.all(plain)
    again = dict(zip(parts[::2], parts[1::2], strict=True))
    if 2 * len(again) < len(parts):
        raise Unreadable("a dict has a key twice")
    return again


def _decode_record(kind: type, decoder: Decoder, *plain: object) -> Any:
    values = decoder.all(plain)
    for value, hint in zip(values, _hints(kind).values(), strict=True):
        expect(value, hint)
    return kind(*values)


def _decode_across(decoder: Decoder, *plain: object) -> Across[object]:
    gathered: Across[object] = _decode_record(Across, decoder, *plain)
    for axis in gathered.axes:
        expect(axis, str)
    for labels, _ in gathered.entries:
        expect(labels, dict)
    for absent in gathered.absent:
        expect(absent, Absent)
    return gathered


@cache
def _hints(kind: type) -> Mapping[str, object]:
    return get_type_hints(kind)


def _decode_stored(
    by_name: Mapping[str, Kind], decoder: Decoder, name: str, plain: object
) -> object:
    storage = by_name.get(name)
    if storage is None:
        raise Unreadable(f"no plugin says how to put a {name} together")
    if not (storage.faithful or decoder.stand_ins):
        raise Unreadable(f"something stands in for a {storage.type.__name__}")
    (parts,) = decoder.all((plain,))
    assert storage.put_together is not None
    return storage.put_together(parts)


def _decode_value(
    packages: Callable[[str], bool], decoder: Decoder, name: str, names: list[str], *plain: object
) -> Value:
    fields = dict(zip(names, decoder.all(plain), strict=True))
    return with_contents(class_named(name, packages), fields)


BASIC_ENCODERS: dict[type, Encode] = {
    type(None): _encode_as_is,
    bool: _encode_as_is,
    int: lambda value, _: value if -_LARGEST < value < _LARGEST else ["int", hex(value)],
    # JSON has no NaN and no infinity
    float: lambda value, _: (
        value if math.isfinite(value) else ["float", struct.pack("<d", value).hex()]
    ),
    str: _encode_as_is,
    bytes: lambda value, encoder: ["bytes", encoder.keep(memoryview(value))],
    _PATH: lambda value, _: ["path", str(value)],
    tuple: lambda value, encoder: ["tuple", *encoder.all(value, "tuple")],
    list: lambda value, encoder: ["list", *encoder.all(value, "list")],
    dict: lambda value, encoder: ["dict", *encoder.all(chain.from_iterable(value.items()), "dict")],
}

_DECODERS: dict[str, Decode] = {
    "int": lambda decoder, digits: int(digits, 16),
    "float": lambda decoder, content: struct.unpack("<d", bytes.fromhex(content))[0],
    "bytes": lambda decoder, number: decoder.content(decoder.buffer(number)),
    "path": lambda decoder, plain: Path(decoder.text(plain)),
    "tuple": lambda decoder, *plain: tuple(decoder.all(plain)),
    "list": lambda decoder, *plain: decoder.all(plain),
    "dict": _decode_dict,
    "across": _decode_across,
    "absent": partial(_decode_record, Absent),
    "array": lambda decoder, number, *parts: decode_array(decoder.buffer(number), *parts),
    "number": lambda decoder, name, content: decode_number(name, content),
    "numpy.str": _decode_numpy_str,
    "numpy.bytes": _decode_numpy_bytes,
}


T = TypeVar("T")

_encode = json.JSONEncoder(check_circular=False, allow_nan=False, separators=(",", ":")).encode


def _refuse(part: object) -> object:
    raise Unreadable(f"{str(part)[:20]} is not part of a value")


_decode = json.JSONDecoder(object_pairs_hook=_refuse, parse_constant=_refuse).decode


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
        return digest_of(self.head, self.sums)


def digest_of(head: str, sums: Iterable[str]) -> str:
    """Return the digest of a value from its text and the SHA-256 of each buffer."""
    return hashlib.sha256("\n".join((head, *sums)).encode("ascii")).hexdigest()


class Packer:
    """Encodes and decodes values.

    Parameters
    ----------
    kinds
        Further types, as plugins know them; the first that stores a type is used, before all that
        is known here.
    packages
        Returns for a top-level package whether a stored value may make the program import it. What
        is imported already needs no leave.
    """

    def __init__(
        self,
        kinds: Iterable[Kind] = (),
        packages: Callable[[str], bool] = lambda package: False,
    ) -> None:
        self._storages = tuple(kind for kind in kinds if kind.take_apart is not None)
        self._storage = _ByType(self._storage_of)
        self._encoders = _ByType(lambda kind: encoder_for(kind, self._storage[kind]))
        self._lenders = _ByType(self._lender_of)
        self._copiers = _ByType(self._copier_of)
        self._decoders = decoders_with(self._storages, packages)

    def pack(self, value: object) -> Packed:
        """Encode a value.

        Raises
        ------
        Unstorable
            If it, or anything inside it, cannot be kept.
        """
        encoder = Encoder(self._encoders)
        try:
            head = _encode(encoder.plain(value))
        except RecursionError:
            raise Unstorable(type(value).__name__, "it is nested too deeply") from None
        return Packed(head, tuple(encoder.buffers), encoder.faithful)

    def unpack(self, head: str, buffers: Sequence[Buffer] = (), *, stand_ins: bool = True) -> Any:
        """Decode a value; its arrays lie in the given buffers, and nobody can write there.

        Whatever the text and the buffers are, this takes no more memory than they do, times a
        small number.

        Parameters
        ----------
        head, buffers
            As `pack` returned them.
        stand_ins
            Whether what stands in for a value may be in it.

        Raises
        ------
        Unreadable
            If that is not possible.
        """
        decoder = Decoder(self._decoders, buffers, stand_ins=stand_ins)
        try:
            return decoder.whole(_decode(head))
        except (Unreadable, MemoryError):
            raise
        except (Exception, SystemExit) as error:
            raise Unreadable(f"{type(error).__name__}: {error}") from error

    def digest(self, value: object) -> str:
        """Return the SHA-256 of a value, or of what `pack` made of it."""
        return (value if isinstance(value, Packed) else self.pack(value)).digest

    def travels(self, kind: type) -> bool:
        """Return whether values declared to be of that type come back as themselves.

        Only the type is looked at: a list travels, and yet may hold what does not.
        """
        storage = self._storage[kind]
        if storage is not None:
            return storage.faithful
        return kind in BASIC_ENCODERS or kind is Across or issubclass(kind, Value) or is_numpy(kind)

    def lend(self, value: object) -> Any:
        """Return a value as one reader gets it.

        Raises
        ------
        Exception
            If it, or something inside it, cannot be copied.
        """
        lender = self._lenders[type(value)]
        return value if lender is None else lender(value)

    def copy(self, value: object) -> object:
        """Return a copy that shares no memory with a value, with the same order in memory.

        Values that cannot be packed, such as a figure, are lent.

        Raises
        ------
        Unreadable
            If it cannot be put together again.
        """
        copier = self._copiers[type(value)]
        return value if copier is None else copier(value)

    def _storage_of(self, kind: type) -> Kind | None:
        return next((storage for storage in self._storages if issubclass(kind, storage.type)), None)

    def _lender_of(self, kind: type) -> Callable[[Any], object] | None:
        storage = self._storage[kind]
        if storage is not None:
            return storage.lend
        if kind in (list, dict):
            return deepcopy
        if kind is tuple:
            return self._lend_each
        return _refuse_iterator if issubclass(kind, Iterator) else None

    def _copier_of(self, kind: type) -> Callable[[Any], object] | None:
        if issubclass(kind, (float, int, str, bytes, type(None), Path)):
            return None
        if self._storage[kind] is not None:
            return self._copy_packed
        if kind is Across:
            return self._copy_entries
        if is_numpy(kind):
            import numpy as np

            is_number = issubclass(kind, np.generic) and kind is not np.void
            return None if is_number else self._copy_array
        return self._copy_packed

    def _copy_entries(self, gathered: Across[object]) -> Across[object]:
        entries = tuple((labels, self.copy(value)) for labels, value in gathered)
        return replace(gathered, entries=entries)

    def _copy_array(self, array: Any) -> object:
        if array.dtype.hasobject:
            return self._copy_packed(array)
        return locked(array.copy(order="K"))

    def _copy_packed(self, value: object) -> object:
        try:
            packed = self.pack(value)
        except Unstorable:
            return self.lend(value)
        if not packed.faithful:
            return self.lend(value)
        return self.unpack(packed.head, [bytes(buffer) for buffer in packed.buffers])

    def _lend_each(self, values: tuple[object, ...]) -> tuple[object, ...]:
        lent = tuple(map(self.lend, values))
        return values if all(map(is_, lent, values)) else lent


def _refuse_iterator(value: Iterator[object]) -> object:
    kind = type(value).__name__
    raise TypeError(f"a {kind} can be read only once; return a list or a tuple")


class _ByType(dict[type, T]):
    """Functions for each type, found once."""

    def __init__(self, find: Callable[[type], T]) -> None:
        super().__init__()
        self._find = find

    def __missing__(self, kind: type) -> T:
        way = self[kind] = self._find(kind)
        return way

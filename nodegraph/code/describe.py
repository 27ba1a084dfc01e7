"""Values in memory as plain nested tuples, of which equal ones mean equal values."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import partial
from hashlib import sha256
from pathlib import PurePath
from types import MappingProxyType, MethodType, NoneType
from typing import Any

from nodegraph.code.parts import short_digest

_PLAIN = (NoneType, bool, int, float, complex, str, bytes, range, type(...))
_ORDERED = (list, tuple)
_UNORDERED = (set, frozenset)
_MAPPINGS = (dict, MappingProxyType)


class NoDigestError(Exception):
    """A value that cannot be described."""


class Describer:
    """Describes values.

    Parameters
    ----------
    code
        Describes what is made of code, such as functions and classes, or raises `NoDigestError`.
    """

    def __init__(self, code: Callable[[Any], object]) -> None:
        self._code = code
        self._open: list[int] = []

    def of(self, value: Any) -> object:
        """Return a description of a value.

        Raises
        ------
        NoDigestError
            If there is none for what the value is or holds.
        """
        kind = type(value)
        if kind in _PLAIN:
            return kind.__name__, repr(value)
        if id(value) in self._open:
            return "the one around it", self._open.index(id(value))
        self._open.append(id(value))
        try:
            return self._holder(value)
        finally:
            self._open.pop()

    def all(self, values: Iterable[Any]) -> tuple[object, ...]:
        """Return descriptions of values, in their order."""
        return tuple(map(self.of, values))

    def _holder(self, value: Any) -> object:
        kind = type(value)
        if kind in _ORDERED:
            return kind.__name__, self.all(value)
        if kind in _UNORDERED:
            return kind.__name__, tuple(sorted(map(short_digest, self.all(value))))
        if kind in _MAPPINGS:
            return kind.__name__, self._mapping(value)
        if _is_numpys(kind):
            return self._array(value)
        return self._instance(value)

    def _mapping(self, value: Mapping[Any, Any]) -> tuple[object, ...]:
        return tuple((self.of(key), self.of(one)) for key, one in value.items())

    def _array(self, value: Any) -> object:
        if value.dtype.hasobject:
            return "array", value.shape, self.of(value.tolist())
        content = sha256(value.tobytes()).hexdigest()
        return "array", type(value).__name__, repr(value.dtype.descr), value.shape, content

    def _instance(self, value: Any) -> object:
        if isinstance(value, partial):
            return "partial", self.all((value.func, value.args, value.keywords))
        if isinstance(value, MethodType):
            return "method", self.all((value.__func__, value.__self__))
        if isinstance(value, PurePath):
            return "path", str(value)
        if isinstance(value, Enum):
            return self.of(type(value)), value.name, self.of(value.value)
        if isinstance(value, tuple) and hasattr(value, "_fields"):
            return self.of(type(value)), self.all(tuple(value))
        if is_dataclass(value) and not isinstance(value, type):
            return self.of(type(value)), self.all(getattr(value, one.name) for one in fields(value))
        return self._code(value)


def _is_numpys(kind: type) -> bool:
    """Whether values of a type are arrays or numbers of numpy, which nobody need have imported."""
    numpy = sys.modules.get("numpy")
    return numpy is not None and (kind is numpy.ndarray or issubclass(kind, numpy.generic))

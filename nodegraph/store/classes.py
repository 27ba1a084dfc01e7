"""Classes of values by their names, and values by their fields."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from functools import cached_property
from importlib import import_module
from inspect import signature
from typing import Any

from nodegraph.node.values import Value
from nodegraph.store.arrays import is_numpy
from nodegraph.store.errors import UnknownClass, Unreadable, Unstorable

_UNSET = object()


def class_name(kind: type) -> str:
    """Return a name by which the class is found again: ``module:Class``.

    Raises
    ------
    Unstorable
        If it is not a dataclass, holds more than its fields, cannot check them alone, or is not
        found by its name.
    """
    if not is_dataclass(kind):
        raise Unstorable(kind.__name__, "a Value is kept if it is a dataclass")
    if kind.__new__ is not object.__new__:  # a mapping, an array, an exception besides
        raise Unstorable(kind.__name__, "it is more than its fields")
    if len(signature(getattr(kind, "__post_init__", _no_check)).parameters) > 1:
        raise Unstorable(kind.__name__, "its __post_init__ needs more than its fields")
    if _held_by(sys.modules.get(kind.__module__), kind.__qualname__) is not kind:
        raise Unstorable(kind.__name__, f"{kind.__module__} has no class {kind.__qualname__}")
    return f"{kind.__module__}:{kind.__qualname__}"


def class_named(name: str, packages: Callable[[str], bool]) -> type[Value]:
    """Return the class of that name.

    What is stored must not make this program run code that nobody chose: a module that is not
    imported yet is imported only if `packages` takes the package that it lies in.

    Raises
    ------
    UnknownClass
        If there is none, it may not be imported, or it is not a dataclass that derives from
        `Value`.
    """
    module, _, qualified = name.partition(":")
    if module not in sys.modules and packages(module.partition(".")[0]):
        import_module(module)
    kind = _held_by(sys.modules.get(module), qualified)
    if isinstance(kind, type) and issubclass(kind, Value) and is_dataclass(kind):
        return kind
    raise UnknownClass(f"{name!r} is not a class of values here")


def contents(value: object, names: tuple[str, ...]) -> list[object]:
    """Return the fields of a value.

    Raises
    ------
    Unstorable
        If a field has no value, or the value has more than its fields.
    """
    values = [getattr(value, name, _UNSET) for name in names]
    if any(value_ is _UNSET for value_ in values):
        raise Unstorable(type(value).__name__, "a field of it has no value")
    more = set(getattr(value, "__dict__", ())).difference(names)
    # what it has computed from its fields, it can compute again
    kind = type(value)
    extra = {name for name in more if not isinstance(getattr(kind, name, None), cached_property)}
    if extra:
        raise Unstorable(kind.__name__, f"{', '.join(sorted(extra))}: not among its fields")
    return values


def with_contents(kind: type[Value], fields: Mapping[str, object]) -> Value:
    """Return a value with these fields as they are: none is recomputed.

    They are checked by the class's own `__post_init__`, which is called with another value of the
    same fields.

    Raises
    ------
    Unreadable
        If the class has other fields now, or makes fields of other types of these.
    """
    if field_names(kind) != tuple(fields):
        raise Unreadable(f"{kind.__name__} has other fields than when it was kept")
    check: Callable[[Value], None] = getattr(kind, "__post_init__", _no_check)
    if check is not _no_check:
        trial = _with_fields(kind, fields)
        check(trial)
        for name, value in fields.items():
            _check_type(f"{kind.__name__}.{name}", value, getattr(trial, name))
    return _with_fields(kind, fields)


def field_names(kind: type) -> tuple[str, ...]:
    """Return the names of a dataclass' fields."""
    return tuple(field.name for field in fields(kind))


def _no_check(value: Value) -> None:
    pass


def _with_fields(kind: type[Value], fields: Mapping[str, object]) -> Value:
    value = object.__new__(kind)
    for name, field in fields.items():
        object.__setattr__(value, name, field)
    return value


def _check_type(where: str, value: Any, expected: Any) -> None:
    """Refuse a field of another type than its class makes of it."""
    kind = type(value)
    if kind is not type(expected):
        raise Unreadable(f"{where} is {kind.__name__}, not {type(expected).__name__}")
    if is_numpy(kind) and value.dtype != expected.dtype:
        raise Unreadable(f"{where} is of {value.dtype}, not of {expected.dtype}")


def _held_by(module: object, qualified: str) -> object:
    """Return what a module holds under a dotted name, without asking it to import anything."""
    target = module
    for part in qualified.split("."):
        target = getattr(target, "__dict__", {}).get(part)
    return target

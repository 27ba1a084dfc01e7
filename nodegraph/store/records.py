"""Values of plugins' own classes: which class, and its fields one by one."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from functools import cached_property
from importlib import import_module
from typing import Any

from nodegraph.store.unstorable import Unreadable, Unstorable
from nodegraph.values import Value

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

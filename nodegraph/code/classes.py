"""What a class that no file holds was made of."""

from __future__ import annotations

import dataclasses
from collections import namedtuple
from types import FunctionType, GetSetDescriptorType, MemberDescriptorType
from typing import Any

_BOOKKEEPING = {
    "__doc__", "__module__", "__annotations__", "__weakref__", "__dict__", "__match_args__",
    "__firstlineno__", "__static_attributes__", "__annotate__", "__annotate_func__",
    "__annotations_cache__", "_abc_impl",
}  # fmt: skip
_MADE_BY_DATACLASS = {
    "__init__", "__repr__", "__eq__", "__lt__", "__le__", "__gt__", "__ge__", "__hash__",
    "__setattr__", "__delattr__", "__getstate__", "__setstate__", "__replace__",
}  # fmt: skip
_MADE_BY_NAMEDTUPLE = {
    "__new__", "_make", "_replace", "__replace__", "__repr__", "_asdict", "__getnewargs__",
    "__orig_bases__",
}  # fmt: skip
_SLOTS = (GetSetDescriptorType, MemberDescriptorType, type(namedtuple("_Pair", "left").left))  # type: ignore[attr-defined]
_NOWHERE = {"<string>", dataclasses.__file__}


def bare_members(kind: type) -> dict[str, Any]:
    """Return a class's own members as values and functions, with its annotations as texts.

    What `dataclasses.dataclass` and `typing.NamedTuple` make follows from the annotations, the
    fields and the other members.
    """
    members = {
        name: _bare(member)
        for name, member in sorted(vars(kind).items())
        if name not in _BOOKKEEPING and not name.startswith("__dataclass")
        if not isinstance(member, _SLOTS) and not _is_made(kind, name, member)
    }
    annotations = {name: str(one) for name, one in getattr(kind, "__annotations__", {}).items()}
    return members | {"annotations": annotations, "fields": _fields(kind)}


def _fields(kind: Any) -> list[Any]:
    """Return the fields of a dataclass: with slots, its defaults are nowhere else."""
    if not dataclasses.is_dataclass(kind):
        return []
    parameters = repr(getattr(kind, "__dataclass_params__", ""))
    return [parameters, *map(_field, dataclasses.fields(kind))]


def _field(one: dataclasses.Field[Any]) -> tuple[Any, ...]:
    default = () if one.default is dataclasses.MISSING else (one.default,)
    factory = () if one.default_factory is dataclasses.MISSING else (one.default_factory,)
    return one.name, one.init, one.repr, one.hash, one.compare, one.kw_only, default, factory


def _bare(member: Any) -> Any:
    if isinstance(member, (staticmethod, classmethod)):
        return type(member).__name__, member.__func__
    if isinstance(member, property):
        return member.fget, member.fset, member.fdel
    return member


def _is_made(kind: type, name: str, member: Any) -> bool:
    if hasattr(kind, "_fields") and issubclass(kind, tuple):
        return name in _MADE_BY_NAMEDTUPLE
    made = isinstance(member, FunctionType) and member.__code__.co_filename in _NOWHERE
    return made and name in _MADE_BY_DATACLASS and dataclasses.is_dataclass(kind)

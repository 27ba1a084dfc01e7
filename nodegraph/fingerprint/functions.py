"""Functions as they are in memory: where their source lies, and what they capture."""

from __future__ import annotations

import ast
import dataclasses
import inspect
import os
import sys
import textwrap
from collections import defaultdict, namedtuple
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import partial
from hashlib import sha256
from pathlib import Path, PurePath
from types import (
    BuiltinMethodType,
    FunctionType,
    GetSetDescriptorType,
    MappingProxyType,
    MemberDescriptorType,
    MethodType,
    ModuleType,
    NoneType,
)
from typing import Any

from nodegraph.fingerprint.modules import UNKNOWN, Places
from nodegraph.fingerprint.names import NOT_FOLLOWED, STATEMENTS, Definition, Links, Module, Reach
from nodegraph.fingerprint.source import PARSER, Marks, Part, part_of, short_digest

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

    def of(self, value: object) -> object:
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

    def all(self, values: Iterable[object]) -> tuple[object, ...]:
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

    def _mapping(self, value: Mapping[object, object]) -> tuple[object, ...]:
        return tuple((self.of(key), self.of(item)) for key, item in value.items())

    def _array(self, value: Any) -> object:
        if value.dtype.hasobject:
            return "array", value.shape, self.of(value.tolist())
        content = sha256(value.tobytes()).hexdigest()
        return "array", type(value).__name__, repr(value.dtype.descr), value.shape, content

    def _instance(self, value: object) -> object:
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
            return self.of(type(value)), self.all(
                getattr(value, field.name) for field in fields(value)
            )
        return self._code(value)


def _is_numpys(kind: type) -> bool:
    """Whether values of a type are arrays or numbers of numpy, which nobody need have imported."""
    numpy = sys.modules.get("numpy")
    return numpy is not None and (kind is numpy.ndarray or issubclass(kind, numpy.generic))


_BOOKKEEPING = {
    "__doc__", "__module__", "__annotations__", "__weakref__", "__dict__", "__match_args__",
    "__firstlineno__", "__static_attributes__", "__annotate__", "__annotate_func__",
    "__annotations_cache__", "_abc_impl",
}  # fmt: skip
_OF_DATACLASS = {
    "__init__", "__repr__", "__eq__", "__lt__", "__le__", "__gt__", "__ge__", "__hash__",
    "__setattr__", "__delattr__", "__getstate__", "__setstate__", "__replace__",
}  # fmt: skip
_OF_NAMEDTUPLE = {
    "__new__", "_make", "_replace", "__replace__", "__repr__", "_asdict", "__getnewargs__",
    "__orig_bases__",
}  # fmt: skip
_SLOTS = (GetSetDescriptorType, MemberDescriptorType, type(namedtuple("_Pair", "left").left))  # type: ignore[attr-defined]
_NOWHERE = {"<string>", dataclasses.__file__}


def bare_members(kind: type) -> dict[str, object]:
    """Return a class's own members as values and functions, with its annotations as texts.

    What `dataclasses.dataclass` and `typing.NamedTuple` make follows from the annotations, the
    fields and the other members.
    """
    members = {
        name: _bare(member)
        for name, member in sorted(vars(kind).items())
        if name not in _BOOKKEEPING and not name.startswith("__dataclass")
        if not isinstance(member, _SLOTS) and not _is_generated(kind, name, member)
    }
    annotations = {
        name: str(annotation) for name, annotation in getattr(kind, "__annotations__", {}).items()
    }
    return members | {"annotations": annotations, "fields": _fields(kind)}


def _fields(kind: object) -> list[object]:
    """Return the fields of a dataclass: with slots, its defaults are nowhere else."""
    if not dataclasses.is_dataclass(kind):
        return []
    parameters = repr(getattr(kind, "__dataclass_params__", ""))
    return [parameters, *map(_field, dataclasses.fields(kind))]


def _field(field: dataclasses.Field[object]) -> tuple[object, ...]:
    default = () if field.default is dataclasses.MISSING else (field.default,)
    factory = () if field.default_factory is dataclasses.MISSING else (field.default_factory,)
    return (
        field.name,
        field.init,
        field.repr,
        field.hash,
        field.compare,
        field.kw_only,
        default,
        factory,
    )


def _bare(member: object) -> object:
    if isinstance(member, (staticmethod, classmethod)):
        return type(member).__name__, member.__func__
    if isinstance(member, property):
        return member.fget, member.fset, member.fdel
    return member


def _is_generated(kind: type, name: str, member: object) -> bool:
    if hasattr(kind, "_fields") and issubclass(kind, tuple):
        return name in _OF_NAMEDTUPLE
    function = inspect.unwrap(member) if callable(member) else member  # reprlib wraps __repr__
    generated = isinstance(function, FunctionType) and function.__code__.co_filename in _NOWHERE
    return generated and name in _OF_DATACLASS and dataclasses.is_dataclass(kind)


def captured(function: FunctionType) -> Iterator[tuple[str, object]]:
    """Yield by name what a function holds besides its code: cells, defaults, what it wraps."""
    code = function.__code__
    for name, cell in zip(code.co_freevars, function.__closure__ or (), strict=True):
        try:
            yield name, cell.cell_contents
        except ValueError:
            continue  # never bound: nothing can depend on it
    defaults = function.__defaults__ or ()
    arguments = code.co_varnames[: code.co_argcount]
    yield from zip(arguments[len(arguments) - len(defaults) :], defaults, strict=True)
    yield from (function.__kwdefaults__ or {}).items()
    if "__wrapped__" in vars(function):
        yield "__wrapped__", vars(function)["__wrapped__"]


def definition_of(module: Module, function: FunctionType) -> Definition | None:
    """Return the name of a function in its module, and its number if several have that name."""
    code, summary = function.__code__, module.summary
    if summary.trouble:
        return Definition(module, STATEMENTS)
    name = code.co_qualname.partition(".")[0]
    named = summary.names.get(name, ())
    parts = enumerate(summary.parts)
    here = [at for at, part in parts if part.first <= code.co_firstlineno <= part.last]
    twins = [at for at in here if at in named]
    if len(named) > 1 and twins:
        return Definition(module, name, twins[0])
    if named:
        return Definition(module, name)
    return Definition(module, _bound_by(module, here[0]) or name, here[0]) if here else None


def _bound_by(module: Module, part: int) -> str:
    return next((name for name, parts in module.summary.names.items() if part in parts), "")


def is_written_out(definition: Definition, function: FunctionType) -> bool:
    """Whether the source says all that a function was made with: it was not made by another."""
    parts = (
        [definition.part]
        if definition.part >= 0
        else definition.module.summary.names.get(definition.name, ())
    )
    defined = any(definition.module.summary.parts[part].defines for part in parts)
    return defined and "<" not in function.__code__.co_qualname


_SCRIPT = "__main__"


class Live:
    """Looks at one function, and at all that it was made with.

    Parameters
    ----------
    links, places

    Attributes
    ----------
    units : mapping of label to digests
        What is not in any file.
    troubles : list of str
        Why something has no digest.
    """

    def __init__(self, links: Links, places: Places) -> None:
        self._links = links
        self._places = places
        self._describer = Describer(self._code)
        self._definitions: set[Definition] = set()
        self._versioned: set[str] = set()
        self._waiting: list[tuple[str, object]] = []
        self._seen: set[int] = set()
        self.units: defaultdict[str, set[str]] = defaultdict(set)
        self.troubles: list[str] = []

    def look_at(self, value: object, label: str = "") -> Reach:
        """Return the code in files that a function, or a value that holds functions, depends on."""
        self._waiting.append((label or _label(value), value))
        while self._waiting:
            label, value = self._waiting.pop()
            if id(value) not in self._seen:
                self._seen.add(id(value))
                self._look(label, value)
        return Reach(frozenset(self._definitions), frozenset(self._versioned))

    def _look(self, label: str, value: object) -> None:
        if not isinstance(value, FunctionType):
            self._note(label, "", value)
            return
        for name, held in self._function(value):
            self._note(_label(value), f"[{name}]", held)

    def _note(self, label: str, inside: str, value: object) -> None:
        try:
            self.units[label + inside].add(short_digest(self._describer.of(value)))
        except NoDigestError as error:
            self.troubles.append(f"{label}{inside} {error}")
        except RecursionError:
            self.troubles.append(f"{label}{inside} is nested too deeply to be read")

    def _code(self, value: object) -> object:
        """Describe what is made of code, and note what it leads to."""
        if isinstance(value, ModuleType):
            self._add(self._links.reach(None, [f"{value.__name__}:"]))
            return "module", value.__name__
        if isinstance(value, FunctionType):
            held = list(self._function(value))
            return (
                "function",
                _label(value),
                [(name, self._describer.of(value)) for name, value in held],
            )
        if self._is_named(value):
            return "named", _home(value), _name(value)
        if isinstance(value, type):
            return "class", value.__qualname__, self._members(value)
        if isinstance(value, BuiltinMethodType):
            return "builtin", value.__name__, self._describer.of(value.__self__)
        if hasattr(value, "__wrapped__"):
            return "wrapper", self._describer.all((type(value), value.__wrapped__))
        raise NoDigestError(f"holds a {type(value).__qualname__}, of which no digest can be made")

    def _members(self, kind: type) -> object:
        module = self._module(kind.__module__)
        name = kind.__qualname__.partition(".")[0]
        if module is not None and name in module.summary.names:
            self._definitions.add(Definition(module, name))
        return self._describer.all(kind.__bases__), self._describer.of(bare_members(kind))

    def _function(self, function: FunctionType) -> Iterator[tuple[str, object]]:
        """Note a function's code; return by name what it captures besides."""
        if _is_renamed(function) and self._is_named(function):
            self._by_version(function.__module__, function)
            return iter(())
        file = function.__code__.co_filename
        if not os.path.isfile(file):
            if _is_in_module(function) and self._by_version(_module_name(function), function):
                return _closure_of_local(function)
            self._fileless(function)
            return captured(function)
        module = self._home(function, os.path.abspath(file))
        if module is None:
            return _closure_of_local(function)
        definition = definition_of(module, function)
        if definition is None:
            self.troubles.append(
                f"{_label(function)} is not in its file, which was edited after it was imported"
            )
            return iter(())
        self._definitions.add(definition)
        return iter(()) if is_written_out(definition, function) else captured(function)

    def _home(self, function: FunctionType, file: str) -> Module | None:
        """Return the module that a function is in, or None where its version counts."""
        name = _module_name(function)
        place = self._places.place(name)
        if place is not None and os.path.isfile(place.file) and os.path.samefile(place.file, file):
            if self._by_version(name, function):
                return None
            file = place.file
        return self._links.module_in(file, name)

    def _fileless(self, function: FunctionType) -> None:
        cell = read_cell(function, lambda name: _is_mark(_look_up(function.__globals__, name)))
        if cell is None:
            # its bytecode would change with the version of Python, and miss what it calls
            self.troubles.append(f"{_label(function)} has no source")
            return
        self.units[f"{_label(function)} (cell)"].add(cell.digest)
        self._globals(function, cell.references)

    def _globals(self, function: FunctionType, references: Iterable[str]) -> None:
        for reference in references:
            name, _, attributes = reference.partition(".")
            value = function.__globals__.get(name)
            if ":" in reference:
                self._add(self._links.reach(None, [reference]))
            elif isinstance(value, ModuleType):
                self._add(self._links.reach(None, [f"{value.__name__}:{attributes}"]))
            elif name in function.__globals__ and not _is_mark(value):
                self._waiting.append((f"{_module_name(function)}:{name}", value))

    def _is_named(self, value: object) -> bool:
        """Whether a value is what its module has under its name; note what that leads to."""
        name, qualified = _home(value), _name(value)
        if not isinstance(name, str) or not qualified:
            return False
        if _look_up(getattr(sys.modules.get(name), "__dict__", {}), qualified) is not value:
            return False
        module = self._module(name)
        if module is None:
            return self._by_version(name)
        top = qualified.partition(".")[0]
        if top not in {*module.summary.names, *module.summary.imports}:
            return False
        self._add(self._links.reach(module, [qualified]))
        return True

    def _module(self, name: str) -> Module | None:
        if name != _SCRIPT:
            return self._links.module(name)
        file = getattr(sys.modules[name], "__file__", None)
        return self._links.module_in(os.path.abspath(file), Path(file).stem) if file else None

    def _by_version(self, name: str, function: FunctionType | None = None) -> bool:
        """Whether what a module holds counts by name and version; if so, note these."""
        origin = self._places.origin(name)
        if name == _SCRIPT or origin.followed or UNKNOWN in origin.versions.values():
            return False
        self._versioned |= self._links.versioned([name])
        if function is not None:
            label = f"{function.__module__}:{function.__qualname__}"
            self.units[label].add(short_digest(label))
        return True

    def _add(self, reach: Reach) -> None:
        self._definitions |= reach.definitions
        self._versioned |= reach.versioned


def _closure_of_local(function: FunctionType) -> Iterator[tuple[str, object]]:
    return captured(function) if "<locals>" in function.__code__.co_qualname else iter(())


def _is_in_module(function: FunctionType) -> bool:
    module = sys.modules.get(_module_name(function))
    return module is not None and vars(module) is function.__globals__


def _is_renamed(function: FunctionType) -> bool:
    return function.__qualname__ != function.__code__.co_qualname


def _is_mark(value: object) -> bool:
    return (getattr(value, "__module__", ""), _name(value)) in NOT_FOLLOWED


def _home(value: object) -> object:
    # ufuncs of numpy before 2.2 do not say in which module they are
    return getattr(value, "__module__", None) or type(value).__module__


def _name(value: object) -> str:
    name = getattr(value, "__qualname__", None) or getattr(value, "__name__", None)
    return name if isinstance(name, str) else ""


def _label(value: object) -> str:
    if isinstance(value, FunctionType):
        return f"{_module_name(value)}:{value.__code__.co_qualname}"
    return f"{type(value).__module__}:{type(value).__qualname__}"


def _module_name(function: FunctionType) -> str:
    name = str(function.__globals__.get("__name__", _SCRIPT))
    file = function.__code__.co_filename
    if name != _SCRIPT or not os.path.isfile(file):
        return name
    spec = function.__globals__.get("__spec__")
    return spec.name if spec else Path(file).stem


def _look_up(names: Any, qualified: str) -> object:
    name, *attributes = qualified.split(".")
    value = names.get(name)
    for attribute in attributes:
        value = getattr(value, attribute, None)
    return value


def read_cell(function: FunctionType, marks: Marks) -> Part | None:
    """Return a function that no file holds, if its source was kept, as notebooks do."""
    try:
        # of the code: a function would be unwrapped, and another one's source returned
        source = inspect.getsource(function.__code__)
        with PARSER:
            tree = ast.parse(textwrap.dedent(source))
        return part_of(tree.body[0], marks)
    except (OSError, TypeError, SyntaxError, ValueError, IndexError):
        return None

"""Functions as they are in memory: where their source lies, and what they were made with."""

from __future__ import annotations

import os
import sys
from collections import defaultdict
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import BuiltinMethodType, FunctionType, ModuleType
from typing import Any

from nodegraph.code.describe import Describer, NoDigestError
from nodegraph.code.functions import is_written_out, made_with, spot_of
from nodegraph.code.links import Links
from nodegraph.code.parts import short_digest
from nodegraph.code.places import UNKNOWN, Places
from nodegraph.code.spots import NOT_FOLLOWED, Module, Reach, Spot

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
        self._spots: set[Spot] = set()
        self._versioned: set[str] = set()
        self._waiting: list[tuple[str, Any]] = []
        self._seen: set[int] = set()
        self.units: defaultdict[str, set[str]] = defaultdict(set)
        self.troubles: list[str] = []

    def look_at(self, function: Any) -> Reach:
        """Return what a function leads to in files."""
        self._waiting.append((_label(function), function))
        while self._waiting:
            label, value = self._waiting.pop()
            if id(value) not in self._seen:
                self._seen.add(id(value))
                self._look(label, value)
        return Reach(frozenset(self._spots), frozenset(self._versioned))

    def _look(self, label: str, value: Any) -> None:
        if not isinstance(value, FunctionType):
            self._note(label, "", value)
            return
        for name, held in self._function(value):
            self._note(_label(value), f"[{name}]", held)

    def _note(self, label: str, inside: str, value: Any) -> None:
        try:
            self.units[label + inside].add(short_digest(self._describer.of(value)))
        except NoDigestError as error:
            self.troubles.append(f"{label}{inside} {error}")
        except RecursionError:
            self.troubles.append(f"{label}{inside} is nested too deeply to be read")

    def _code(self, value: Any) -> object:
        """Describe what is made of code, and note what it leads to."""
        if isinstance(value, ModuleType):
            self._add(self._links.reach(None, [f"{value.__name__}:"]))
            return "module", value.__name__
        if isinstance(value, FunctionType):
            held = list(self._function(value))
            return (
                "function",
                _label(value),
                [(name, self._describer.of(one)) for name, one in held],
            )
        if self._is_named(value):
            return "named", value.__module__, _name(value)
        if isinstance(value, type):
            return "class", value.__qualname__, self._members(value)
        if isinstance(value, BuiltinMethodType):
            return "builtin", value.__name__, self._describer.of(value.__self__)
        if hasattr(value, "__wrapped__"):
            return "wrapper", self._describer.all((type(value), value.__wrapped__))
        raise NoDigestError(f"holds a {type(value).__qualname__}, of which no digest can be made")

    def _members(self, kind: type) -> object:
        from nodegraph.code.classes import bare_members

        module = self._module(kind.__module__)
        name = kind.__qualname__.partition(".")[0]
        if module is not None and name in module.summary.names:
            self._spots.add(Spot(module, name))
        return self._describer.all(kind.__bases__), self._describer.of(bare_members(kind))

    def _function(self, function: FunctionType) -> Iterator[tuple[str, Any]]:
        """Note a function's code; return by name what it was made with besides."""
        if _is_renamed(function) and self._is_named(function):
            self._by_version(function.__module__, function)
            return iter(())
        file = function.__code__.co_filename
        if not os.path.isfile(file):
            if _is_in_module(function) and self._by_version(_module_name(function), function):
                return _made_by_library(function)
            self._fileless(function, file)
            return made_with(function)
        module = self._home(function, os.path.abspath(file))
        if module is None:
            return _made_by_library(function)
        spot = spot_of(module, function)
        if spot is None:
            self.troubles.append(
                f"{_label(function)} is not in its file, which was edited after it was imported"
            )
            return iter(())
        self._spots.add(spot)
        return iter(()) if is_written_out(spot, function) else made_with(function)

    def _home(self, function: FunctionType, file: str) -> Module | None:
        """Return the module that a function is in, or None where its version counts."""
        name = _module_name(function)
        place = self._places.place(name)
        if place is not None and os.path.isfile(place.file) and os.path.samefile(place.file, file):
            if self._by_version(name, function):
                return None
            file = place.file
        return self._links.module_in(file, name)

    def _fileless(self, function: FunctionType, file: str) -> None:
        from nodegraph.code.cells import read_cell

        cell = read_cell(function, lambda name: _is_mark(_look_up(function.__globals__, name)))
        if cell.found == "compiled" and not file.startswith("<"):
            self.troubles.append(f"{_label(function)} has no source: {file} is not there")
        self.units[f"{_label(function)} ({cell.found})"].add(cell.digest)
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

    def _is_named(self, value: Any) -> bool:
        """Whether a value is what its module has under its name; note what that leads to."""
        name, qualified = getattr(value, "__module__", None), _name(value)
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
        self._spots |= reach.spots
        self._versioned |= reach.versioned


def _made_by_library(function: FunctionType) -> Iterator[tuple[str, Any]]:
    return made_with(function) if "<locals>" in function.__code__.co_qualname else iter(())


def _is_in_module(function: FunctionType) -> bool:
    module = sys.modules.get(_module_name(function))
    return module is not None and vars(module) is function.__globals__


def _is_renamed(function: FunctionType) -> bool:
    return function.__qualname__ != function.__code__.co_qualname


def _is_mark(value: Any) -> bool:
    return (getattr(value, "__module__", ""), _name(value)) in NOT_FOLLOWED


def _name(value: Any) -> str:
    name = getattr(value, "__qualname__", None) or getattr(value, "__name__", None)
    return name if isinstance(name, str) else ""


def _label(value: Any) -> str:
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


def _look_up(names: Any, qualified: str) -> Any:
    name, *attributes = qualified.split(".")
    found = names.get(name)
    for attribute in attributes:
        found = getattr(found, attribute, None)
    return found

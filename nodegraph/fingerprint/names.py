"""The code that each name of a module depends on; every name is resolved once."""

from __future__ import annotations

import builtins
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from nodegraph.fingerprint.modules import Places
from nodegraph.fingerprint.source import (
    WHOLE_MODULE,
    Part,
    Sources,
    Summary,
    is_source,
    short_digest,
)

STATEMENTS = "<statements>"
NOT_FOLLOWED = {
    ("nodegraph.node.decorator", "node"),
    ("nodegraph.plugin.hooks", "hookimpl"),
    ("nodegraph.kernels", "_keep"),
    ("nodegraph.live.forms", "fold"),
}
"""Functions that leave another as it is, or only call what they are given.

All of the machine hangs on them but for the third.
"""

FORMATS = ("nodegraph.plugin.formats", "formats")
"""A function that stands for the formats of the plugins in use, and not for its own code."""


class Module:
    """A module whose code counts."""

    __slots__ = ("file", "name", "package", "summary")

    def __init__(self, name: str, file: str, summary: Summary, *, package: bool) -> None:
        self.name = name
        self.file = file
        self.summary = summary
        self.package = package


Step = tuple[Module | str, str]
"""A name with attributes, to be looked up in a module; an empty name stands for all of them."""


class Definition(NamedTuple):
    """A name of a module, or one of several statements that bind it."""

    module: Module
    name: str
    part: int = -1


class Reach(NamedTuple):
    """The dependencies of a piece of code: names of modules, and modules whose version counts."""

    definitions: frozenset[Definition]
    versioned: frozenset[str]


class Unit(NamedTuple):
    """The parts of a definition, and its dependencies."""

    label: str
    digest: str
    reach: Reach
    trouble: str = ""


class Meaning(NamedTuple):
    """The meaning of a name: definitions of its module, imported names, modules with a version."""

    own: frozenset[Definition]
    imported: tuple[tuple[str, str], ...]
    versioned: frozenset[str]


def parts_of(definition: Definition) -> list[Part]:
    """Return the statements that a definition is made of."""
    summary = definition.module.summary
    if definition.part >= 0:
        return [summary.parts[definition.part]]
    numbers = (
        summary.statements
        if definition.name == STATEMENTS
        else summary.names.get(definition.name, ())
    )
    return [summary.parts[number] for number in numbers]


def label_of(definition: Definition) -> str:
    """Return ``module:name``, in which there is no path."""
    compiled = definition.name == STATEMENTS and not is_source(definition.module.file)
    return f"{definition.module.name}:{'<compiled>' if compiled else definition.name}"


def runs(summary: Summary) -> bool:
    """Whether importing a module does more than to bind names, or that is not known."""
    return bool(summary.statements or summary.effects or summary.trouble)


def absolute(here: Module | None, target: str) -> str:
    """Return a module's full name; empty for a relative one outside of any package."""
    name = target.lstrip(".")
    dots = len(target) - len(name)
    if not dots:
        return name
    if here is None:
        return ""
    above = here.name.split(".")
    count = len(above) - dots + here.package
    return ".".join([*above[:count], *([name] if name else [])]) if count > 0 else ""


_LATE = "__getattr__"


class Search:
    """One search, without recursion: modules may refer to each other."""

    def __init__(self, links: Links, places: Places, here: Module | None) -> None:
        self._links = links
        self._places = places
        self._here = here
        self._definitions: set[Definition] = set()
        self._versioned: set[str] = set()
        self._seen: set[Step] = set()
        self._stack: list[Step] = []

    def run(self, references: Iterable[str]) -> Reach:
        """Return the dependencies of references."""
        if self._here is not None:
            self._definitions |= self._links.entered(self._here)
        for reference in references:
            module, colon, name = reference.partition(":")
            if colon:
                self._import(self._here, module, name)
            elif self._here is not None:
                self._look_up(self._here, *_split(reference))
        for step in set(self._stack):
            reach = self._links.step(step)
            self._definitions |= reach.definitions
            self._versioned |= reach.versioned
        return Reach(frozenset(self._definitions), frozenset(self._versioned))

    def run_on(self, step: Step) -> Reach:
        """Return the dependencies of a name of a module."""
        self._stack.append(step)
        while self._stack:
            step = self._stack.pop()
            if step not in self._seen:
                self._seen.add(step)
                self._follow(*step)
        return Reach(frozenset(self._definitions), frozenset(self._versioned))

    def _follow(self, where: Module | str, name: str) -> None:
        if isinstance(where, Module):
            self._look_up(where, *_split(name))
            return
        module = self._links.module(where)
        if module is None:
            self._versioned |= self._links.versioned([where])
            return
        self._definitions |= self._links.entered(module)
        self._stack.extend((module, each) for each in ([name] if name else _all_names(module)))
        if not name:
            for star in module.summary.stars:
                self._import(module, star, "")

    def _look_up(self, module: Module, name: str, attributes: str) -> None:
        meaning = self._links.meaning(module, name)
        if meaning is None:
            self._look_further(module, name, attributes)
            return
        self._definitions |= meaning.own
        self._versioned |= meaning.versioned
        self._stack += [(place, _joined(taken, attributes)) for place, taken in meaning.imported]

    def _look_further(self, module: Module, name: str, attributes: str) -> None:
        full = _joined(name, attributes)
        for star in module.summary.stars:
            self._import(module, star, full)
        if name in WHOLE_MODULE:
            self._stack.extend((module, each) for each in _all_names(module))
        elif not hasattr(builtins, name):
            if module.package and self._places.place(f"{module.name}.{name}"):
                self._stack.append((f"{module.name}.{name}", attributes))
            elif _LATE in module.summary.names:
                self._definitions.add(Definition(module, _LATE))

    def _import(self, here: Module | None, target: str, name: str) -> None:
        full = absolute(here, target)
        if full:
            self._stack.append((full, name))


def _all_names(module: Module) -> Iterator[str]:
    yield from module.summary.names
    yield from module.summary.imports


def _joined(name: str, attributes: str) -> str:
    return f"{name}.{attributes}" if name and attributes else name or attributes


def _split(chain: str) -> tuple[str, str]:
    name, _, attributes = chain.partition(".")
    return name, attributes


class Links:
    """Follows names from module to module; what was followed once is kept.

    Parameters
    ----------
    places
        Finds modules.
    sources
        Reads them.
    """

    def __init__(self, places: Places, sources: Sources) -> None:
        self._places = places
        self._sources = sources
        self._by_name: dict[str, Module | None] = {}
        self._by_file: dict[tuple[str, str], Module] = {}
        self._entered: dict[Module, frozenset[Definition]] = {}
        self._units: dict[Definition, Unit] = {}
        self._steps: dict[Step, Reach] = {}
        self._meanings: dict[Module, dict[str, Meaning | None]] = {}

    def module(self, name: str) -> Module | None:
        """Return a module whose code counts, or None where its version does, or there is none."""
        if name not in self._by_name:
            self._by_name[name] = self._find(name)
        return self._by_name[name]

    def module_in(self, file: str, name: str) -> Module:
        """Return the module that a file is."""
        at = (file, name)
        if at not in self._by_file:
            package = Path(file).stem == "__init__"
            self._by_file[at] = Module(name, file, self._sources.summary(file), package=package)
        return self._by_file[at]

    def entered(self, module: Module) -> frozenset[Definition]:
        """Return the code that an import of a module runs: its statements, and its packages'."""
        if module not in self._entered:
            above = self.module(module.name.rpartition(".")[0]) if "." in module.name else None
            own = {Definition(module, STATEMENTS)} if runs(module.summary) else set()
            self._entered[module] = (self.entered(above) if above else frozenset()) | own
        return self._entered[module]

    def meaning(self, module: Module, name: str) -> Meaning | None:
        """Return the meaning of a name in a module, or None if the module does not bind it."""
        known = self._meanings.setdefault(module, {})
        if name not in known:
            known[name] = self._meant(module, name)
        return known[name]

    def versioned(self, names: Iterable[str]) -> frozenset[str]:
        """Return the top-level modules of those whose version counts."""
        return frozenset(
            name.partition(".")[0] for name in names if self._places.origin(name).versions
        )

    def unit(self, definition: Definition) -> Unit:
        """Return the parts of a definition, and its dependencies."""
        if definition not in self._units:
            self._units[definition] = self._unit(definition)
        return self._units[definition]

    def reach(self, module: Module | None, references: Iterable[str]) -> Reach:
        """Return the dependencies of references; those without a module's name are of this one."""
        return Search(self, self._places, module).run(references)

    def step(self, step: Step) -> Reach:
        """Return the dependencies of a name that one module uses and another defines."""
        if step not in self._steps:
            self._steps[step] = Search(self, self._places, None).run_on(step)
        return self._steps[step]

    def _meant(self, module: Module, name: str) -> Meaning | None:
        summary = module.summary
        if (module.name, name) in NOT_FOLLOWED:
            return Meaning(frozenset(), (), frozenset())
        if name not in summary.names and name not in summary.imports:
            return None
        targets = [target.partition(":") for target in summary.imports.get(name, ())]
        full = [(absolute(module, inside), taken) for inside, _, taken in targets]
        return Meaning(
            frozenset({Definition(module, name)} if name in summary.names else ()),
            tuple(
                target for target in full if target[0] and self._places.origin(target[0]).followed
            ),
            self.versioned(inside for inside, _ in full if inside),
        )

    def _find(self, name: str) -> Module | None:
        if not self._places.origin(name).followed:
            return None
        place = self._places.place(name)
        if place is None:
            return None
        return (
            self.module_in(place.file, name)
            if place.file
            else Module(name, "", Summary(), package=True)
        )

    def _unit(self, definition: Definition) -> Unit:
        module, summary = definition.module, definition.module.summary
        parts = parts_of(definition)
        references = [reference for part in parts for reference in part.references]
        if (module.name, definition.name) == FORMATS:
            references = []
        if definition.name == STATEMENTS:
            references += summary.effects
        return Unit(
            label_of(definition),
            short_digest(*(part.digest for part in parts)),
            self.reach(module, references),
            f"{module.name}: {summary.trouble}" if summary.trouble else "",
        )

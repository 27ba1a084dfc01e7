"""From a name to where it comes from, through imports, re-exports and packages."""

from __future__ import annotations

import builtins
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from nodegraph.code.parts import WHOLE_MODULE
from nodegraph.code.places import Places
from nodegraph.code.spots import Module, Reach, Spot, Step, absolute

if TYPE_CHECKING:
    from nodegraph.code.links import Links

_LATE = "__getattr__"


class Search:
    """One search, without recursion: modules may refer to each other."""

    def __init__(self, links: Links, places: Places, here: Module | None) -> None:
        self._links = links
        self._places = places
        self._here = here
        self._spots: set[Spot] = set()
        self._versioned: set[str] = set()
        self._seen: set[Step] = set()
        self._stack: list[Step] = []

    def run(self, references: Iterable[str]) -> Reach:
        """Return what references lead to."""
        if self._here is not None:
            self._spots |= self._links.entered(self._here)
        for reference in references:
            module, colon, name = reference.partition(":")
            if colon:
                self._import(self._here, module, name)
            elif self._here is not None:
                self._look_up(self._here, *_split(reference))
        for step in set(self._stack):
            reach = self._links.step(step)
            self._spots |= reach.spots
            self._versioned |= reach.versioned
        return Reach(frozenset(self._spots), frozenset(self._versioned))

    def run_on(self, step: Step) -> Reach:
        """Return what a name of a module leads to."""
        self._stack.append(step)
        while self._stack:
            step = self._stack.pop()
            if step not in self._seen:
                self._seen.add(step)
                self._follow(*step)
        return Reach(frozenset(self._spots), frozenset(self._versioned))

    def _follow(self, where: Module | str, name: str) -> None:
        if isinstance(where, Module):
            self._look_up(where, *_split(name))
            return
        module = self._links.module(where)
        if module is None:
            self._versioned |= self._links.versioned([where])
            return
        self._spots |= self._links.entered(module)
        self._stack.extend((module, one) for one in ([name] if name else _all_names(module)))
        if not name:
            for star in module.summary.stars:
                self._import(module, star, "")

    def _look_up(self, module: Module, name: str, attributes: str) -> None:
        meaning = self._links.meaning(module, name)
        if meaning is None:
            self._look_further(module, name, attributes)
            return
        self._spots |= meaning.own
        self._versioned |= meaning.versioned
        self._stack += [(one, _joined(taken, attributes)) for one, taken in meaning.imported]

    def _look_further(self, module: Module, name: str, attributes: str) -> None:
        full = _joined(name, attributes)
        for star in module.summary.stars:
            self._import(module, star, full)
        if name in WHOLE_MODULE:
            self._stack.extend((module, one) for one in _all_names(module))
        elif not hasattr(builtins, name):
            if module.package and self._places.place(f"{module.name}.{name}"):
                self._stack.append((f"{module.name}.{name}", attributes))
            elif _LATE in module.summary.names:
                self._spots.add(Spot(module, _LATE))

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

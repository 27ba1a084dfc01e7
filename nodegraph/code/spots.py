"""Names of modules, and what they are made of and lead to."""

from __future__ import annotations

from typing import NamedTuple

from nodegraph.code.parts import Part, Summary
from nodegraph.code.sources import is_source

STATEMENTS = "<statements>"
NOT_FOLLOWED = {("nodegraph.node", "node"), ("nodegraph.hooks", "hookimpl")}
"""Decorators that leave a function as it is; all of the machine hangs on them."""


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


class Spot(NamedTuple):
    """A name of a module, or one of several statements that bind it."""

    module: Module
    name: str
    part: int = -1


class Reach(NamedTuple):
    """What a piece of code leads to: names of modules, and modules whose version counts."""

    spots: frozenset[Spot]
    versioned: frozenset[str]


class Unit(NamedTuple):
    """What a spot is made of, and what it leads to."""

    label: str
    digest: str
    reach: Reach
    trouble: str = ""


class Meaning(NamedTuple):
    """What a name of a module stands for: its own, what it imports, modules with a version."""

    own: frozenset[Spot]
    imported: tuple[tuple[str, str], ...]
    versioned: frozenset[str]


def parts_of(spot: Spot) -> list[Part]:
    """Return the statements that a spot is made of."""
    summary = spot.module.summary
    if spot.part >= 0:
        return [summary.parts[spot.part]]
    numbers = summary.statements if spot.name == STATEMENTS else summary.names.get(spot.name, ())
    return [summary.parts[number] for number in numbers]


def label_of(spot: Spot) -> str:
    """Return ``module:name``, in which there is no path."""
    compiled = spot.name == STATEMENTS and not is_source(spot.module.file)
    return f"{spot.module.name}:{'<compiled>' if compiled else spot.name}"


def runs(summary: Summary) -> bool:
    """Whether importing a module does more than to bind names, or cannot be told."""
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
    kept = len(above) - dots + here.package
    return ".".join([*above[:kept], *([name] if name else [])]) if kept > 0 else ""

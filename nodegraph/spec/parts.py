"""What a graph file says, each part with its place; nothing is looked up yet."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from nodegraph.errors import Place, Problem
from nodegraph.ports import Label


@dataclass(frozen=True)
class Variable:
    """``$name`` or ``$name.field``: the value of an input or an axis."""

    name: str
    field: str
    place: Place

    def __str__(self) -> str:
        return f"${self.name}.{self.field}" if self.field else f"${self.name}"


@dataclass(frozen=True)
class Reference:
    """``node``, ``node.port`` or ``{from: node.port, at: {axis: label}}``; or an input, ``$name``.

    Attributes
    ----------
    node : str
    port : str
        Empty for the node's only or first output.
    at : mapping of axis to label
    place : Place
    """

    node: str
    port: str
    place: Place
    at: Mapping[str, Label] = field(default_factory=dict)

    def __str__(self) -> str:
        return f"{self.node}.{self.port}" if self.port else self.node


@dataclass(frozen=True)
class Gathering:
    """``{label: reference, ...}`` for a port that gathers."""

    sources: Mapping[str, Reference]
    place: Place


Wiring = Mapping[str, Reference | Gathering]
"""Port -> what feeds it; the empty name is the first port."""


@dataclass(frozen=True)
class Written:
    """A setting as written: plain data in which `Variable` objects may stand."""

    value: Any
    place: Place

    def variables(self) -> Iterator[Variable]:
        """Yield the inputs and axes that the value names."""
        pending = [self.value]
        while pending:
            one = pending.pop()
            if isinstance(one, Variable):
                yield one
            elif isinstance(one, dict):
                pending.extend(one.values())
            elif isinstance(one, list):
                pending.extend(one)


@dataclass(frozen=True)
class MethodSpec:
    """One ``use`` with its own wiring and settings.

    Attributes
    ----------
    label : str
        The alternative's label; empty for a node without alternatives, and for a family.
    use : str
        A node's name, ``family.*``, or ``pass``.
    """

    label: str
    use: str
    place: Place
    wiring: Wiring = field(default_factory=dict)
    settings: Mapping[str, Written] = field(default_factory=dict)


@dataclass(frozen=True)
class NodeSpec:
    """One entry of ``nodes``.

    Attributes
    ----------
    methods : tuple of MethodSpec
        One, without a label, for a plain ``use``; else the alternatives.
    has_alternatives : bool
    over : tuple of (axis, place), or None
    """

    name: str
    place: Place
    methods: tuple[MethodSpec, ...]
    has_alternatives: bool
    wiring: Wiring
    settings: Mapping[str, Written]
    over: tuple[tuple[str, Place], ...] | None


@dataclass(frozen=True)
class AxisSpec:
    """One axis: its labels in order, and the value behind each."""

    name: str
    place: Place
    labels: tuple[Label, ...]
    values: tuple[Any, ...]


@dataclass(frozen=True)
class InputSpec:
    """One input with its default value."""

    name: str
    place: Place
    value: Any


@dataclass(frozen=True)
class SkipSpec:
    """Combinations to leave out: those that match every axis of one item."""

    place: Place
    labels: Mapping[str, tuple[Label, ...]]


@dataclass(frozen=True)
class GraphSpec:
    """A whole graph file.

    What could not be read is left out and stands in `problems`: the checks that follow go on
    with the rest, so that all mistakes are told at once.
    """

    file: str
    folder: Path
    text: str
    title: str
    notes: str
    inputs: Mapping[str, InputSpec]
    axes: Mapping[str, AxisSpec]
    nodes: Mapping[str, NodeSpec]
    skip: tuple[SkipSpec, ...]
    known: tuple[Reference, ...]
    requires: tuple[tuple[str, Place], ...]
    outputs: Mapping[str, Reference]
    report: tuple[Reference, ...]
    problems: tuple[Problem, ...] = ()

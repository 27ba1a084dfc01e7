"""The content of a graph file, each part with its place; nothing is looked up yet."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from nodegraph.errors import Place, Problem
from nodegraph.node.ports import Label
from nodegraph.plugin.hook_types import Placeholder


@dataclass(frozen=True)
class Variable:
    """``$name`` or ``$name.field``: the value of an input or an axis."""

    name: str
    field: str
    place: Place

    def __str__(self) -> str:
        return f"${self.name}.{self.field}" if self.field else f"${self.name}"


FIRST = "$first"
"""A label in ``at`` that stands for the first label of the axis, whatever a command makes of it."""


@dataclass(frozen=True)
class Reference:
    """``node``, ``node.port`` or ``{from: node.port, at: {axis: label}}``; or an input, ``$name``.

    Attributes
    ----------
    node : str
    port : str
        Empty for the node's only or first output.
    at : mapping of axis to label
        `FIRST` stands for the axis's first label until the graph is built.
    place : Place
    passed : bool
        Whether it feeds a port of a graph used as a node, where it was checked already.
    """

    node: str
    port: str
    place: Place
    at: Mapping[str, Label] = field(default_factory=dict)
    passed: bool = False

    def __str__(self) -> str:
        return f"{self.node}.{self.port}" if self.port else self.node


@dataclass(frozen=True)
class ReportEntry(Reference):
    """A value that the report shows, with its heading, its caption and notes beside it.

    Attributes
    ----------
    title, caption : str
        Empty for those of the value itself.
    notes : str
        Markdown; empty for none.
    answer : tuple of str or Placeholder
        The author's words in place of the value's own; none for these.
    answer_place : Place or None
    """

    title: str = ""
    caption: str = ""
    notes: str = ""
    answer: tuple[str | Placeholder, ...] = ()
    answer_place: Place | None = None


@dataclass(frozen=True)
class Gathering:
    """``{label: reference, ...}`` for a port that gathers."""

    sources: Mapping[str, Reference]
    place: Place


Wiring = Mapping[str, Reference | Gathering]
"""Port -> what feeds it; the empty name is the first port."""


def rewired(
    feed: Reference | Gathering, change: Callable[[Reference], Reference]
) -> Reference | Gathering:
    """Return what feeds a port with each reference in it changed."""
    if isinstance(feed, Reference):
        return change(feed)
    return replace(feed, sources={label: change(each) for label, each in feed.sources.items()})


def leaves(value: object) -> Iterator[object]:
    """Yield the parts of plain data that are neither mappings nor lists, the last first."""
    pending = [value]
    while pending:
        part = pending.pop()
        if isinstance(part, Mapping):
            pending.extend(part.values())
        elif isinstance(part, (list, tuple)):
            pending.extend(part)
        else:
            yield part


def with_leaves(value: object, change: Callable[[object], object]) -> Any:
    """Return plain data with each part that is neither a mapping nor a list changed."""
    if isinstance(value, Mapping):
        return {key: with_leaves(part, change) for key, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [with_leaves(part, change) for part in value]
    return change(value)


def with_names(value: object, names: Mapping[str, str]) -> Any:
    """Return plain data with each text replaced that has another name."""

    def renamed(part: object) -> object:
        return names.get(part, part) if isinstance(part, str) else part

    return with_leaves(value, renamed)


@dataclass(frozen=True)
class Written:
    """A setting as written: plain data in which `Variable` objects may stand.

    Attributes
    ----------
    folder : Path or None
        Where relative paths in it start; None for the graph's folder.
    """

    value: Any
    place: Place
    folder: Path | None = None

    def variables(self) -> Sequence[Variable]:
        """Return the inputs and axes that the value names."""
        if not isinstance(self.value, (Variable, dict, list)):
            return ()  # as for most values
        return [part for part in leaves(self.value) if isinstance(part, Variable)]


@dataclass(frozen=True)
class MethodSpec:
    """One ``use`` with its own wiring and settings.

    Attributes
    ----------
    label : str
        The alternative's label; empty for a node without alternatives, and for a family.
    use : str
        A node's name, ``family.*``, ``pass``, or the path of a graph file.
    """

    label: str
    use: str
    place: Place
    wiring: Wiring = field(default_factory=dict)
    settings: Mapping[str, Written] = field(default_factory=dict)

    @property
    def is_graph(self) -> bool:
        """Whether it uses another graph file instead of a node."""
        return is_graph_file(self.use)


@dataclass(frozen=True)
class NodeSpec:
    """One entry of ``nodes``.

    Attributes
    ----------
    methods : tuple of MethodSpec
        One, without a label, for a plain ``use``; else the alternatives.
    has_alternatives : bool
    over : tuple of (axis, place), or None
    prefix : str
        The prefix of the names of nodes and axes that come from a graph used as a node.
    """

    name: str
    place: Place
    methods: tuple[MethodSpec, ...]
    has_alternatives: bool
    wiring: Wiring
    settings: Mapping[str, Written]
    over: tuple[tuple[str, Place], ...] | None
    prefix: str = ""


@dataclass(frozen=True)
class AxisSpec:
    """One axis: its labels in order, and the value of each.

    Attributes
    ----------
    folder : Path or None
        Where relative paths among the values start; None for the graph's folder.
    """

    name: str
    place: Place
    labels: tuple[Label, ...]
    values: tuple[object, ...]
    folder: Path | None = None


@dataclass(frozen=True)
class InputSpec:
    """One input with its default value."""

    name: str
    place: Place
    value: object


@dataclass(frozen=True)
class SkipSpec:
    """Combinations to leave out: those that match every axis of one item."""

    place: Place
    labels: Mapping[str, tuple[Label, ...]]


@dataclass(frozen=True)
class GraphSpec:
    """A whole graph file.

    Parts that could not be read are left out and noted in `problems`: later checks continue with
    the rest, so that all errors are reported at once.

    Attributes
    ----------
    uses : mapping of text to Path
        The graph files that its nodes use, as written, and their paths, if they could be read.
    graphs : mapping of Path to GraphSpec
        All graph files that it uses, directly or not. Only the outermost spec has them.
    written : GraphSpec or None
        For a spec with the nodes of used graphs in it, the spec as it was read.
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
    report: tuple[ReportEntry, ...]
    problems: tuple[Problem, ...] = ()
    uses: Mapping[str, Path] = field(default_factory=dict)
    graphs: Mapping[Path, GraphSpec] = field(default_factory=dict)
    written: GraphSpec | None = None

    @property
    def included(self) -> Mapping[str, str]:
        """The text of every graph file that it uses, by its path from this one's folder."""
        folder = self.folder.resolve()
        return {
            Path(os.path.relpath(path, folder)).as_posix(): spec.text
            for path, spec in self.graphs.items()
        }


def is_graph_file(use: str) -> bool:
    """Return whether a ``use`` names a graph file rather than a node."""
    return use.endswith((".yaml", ".yml"))

"""A plan: calls of methods, what feeds each, and which computes which combination."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from nodegraph.display import name_at
from nodegraph.graph import Graph, Method
from nodegraph.ports import Absent, Label

Combination = tuple[Label, ...]


@dataclass(frozen=True, slots=True)
class Output:
    """One output of a step: the step's index, and the position among its outputs."""

    step: int
    position: int


@dataclass(frozen=True, slots=True)
class Gathered:
    """What a gathering port takes: outputs with their labels, and combinations left out.

    Attributes
    ----------
    axes : tuple of str
    entries : tuple of (labels, Output)
    absent : tuple of (labels, reason)
    known : tuple of labels per axis
        Every label that the graph has there, whether or not it is among the entries.
    """

    axes: tuple[str, ...]
    entries: tuple[tuple[Combination, Output], ...]
    absent: tuple[tuple[Combination, str], ...]
    known: tuple[tuple[Label, ...], ...]


StepInput = Output | Gathered


@dataclass(frozen=True, slots=True)
class Step:
    """One call of one method.

    Attributes
    ----------
    index : int
        Its place in the order of the plan: what it needs comes before it.
    node : str
    method : Method
    labels : mapping of axis to label
        The first combination that needs the step; others may share it.
    settings : mapping
        What the function is called with.
    shown : mapping
        The same as a reader wrote it.
    inputs : mapping of port to Output or Gathered
    needed : tuple of int
        The steps that feed it, each once.
    """

    index: int
    node: str
    method: Method
    labels: Mapping[str, Label]
    settings: Mapping[str, Any]
    shown: Mapping[str, Any]
    inputs: Mapping[str, StepInput]
    needed: tuple[int, ...]

    @property
    def name(self) -> str:
        """The node and its combination: ``fill(length=5, fill=muscle)``."""
        return name_at(self.node, self.labels)

    def reads(self) -> Iterator[Output]:
        """Yield the outputs that feed it."""
        for fed in self.inputs.values():
            if isinstance(fed, Gathered):
                yield from (output for _, output in fed.entries)
            else:
                yield fed


@dataclass(frozen=True)
class Plan:
    """All steps of a graph, and which step computes which combination.

    Attributes
    ----------
    graph : Graph
    steps : tuple of Step
        Each after what feeds it, and as soon after it as can be, so that values are released early.
    cells : mapping of node to (mapping of combination to step index)
    skipped : mapping of node to (mapping of combination to reason)
    """

    graph: Graph
    steps: tuple[Step, ...]
    cells: Mapping[str, Mapping[Combination, int]]
    skipped: Mapping[str, Mapping[Combination, str]]


def absent_of(gathered: Gathered) -> tuple[Absent, ...]:
    """Return the combinations that the plan itself has left out of a gathering."""
    return tuple(
        Absent(dict(zip(gathered.axes, at, strict=True)), "skipped", reason)
        for at, reason in gathered.absent
    )

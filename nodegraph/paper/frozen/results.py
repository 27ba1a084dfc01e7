"""The results of a run, each as a few words that a text file can hold."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from nodegraph.display import name_at
from nodegraph.execute import Run
from nodegraph.hooks import Comparison
from nodegraph.paper.frozen.kept import Kept, joined
from nodegraph.paper.frozen.parts import FEWEST, MOST, Parts, parts_of
from nodegraph.paper.frozen.sketch import Sketch, sketch
from nodegraph.ports import Port
from nodegraph.store import Packed, Unstorable
from nodegraph.values import Files

ONLY = "only"
"""Names the combination of a node that has no axis, or none but its alternatives."""

Axes = tuple[tuple[str, tuple[str, ...]], ...]
"""What the first axes of an array are: a word each, and names."""

_NUMBERS = 16_000
"""That a lock has at most of parts of values, as far as `FEWEST` parts allow: about 85 KB."""

_FOLDERS = re.compile(r"(?<![\w.:/\\])(?:[A-Za-z]:)?[/\\](?:[^\s:'\"/\\]+[/\\])+")


@dataclass(frozen=True)
class Cell:
    """One combination of one node.

    Attributes
    ----------
    group : str
        The node, or node and alternative: ``fill=muscle``.
    at : str
        The labels of its other axes, or `ONLY`.
    node : str
    labels : mapping of axis to label
    index : int
        Of the step that computes it.
    """

    group: str
    at: str
    node: str
    labels: Mapping[str, Any]
    index: int

    @property
    def name(self) -> str:
        """Node and labels: ``fill(fill=muscle, length=5)``."""
        return name_at(self.node, self.labels)


def cells_of(run: Run) -> Iterator[Cell]:
    """Yield every combination of a run's plan, node by node in the order of the graph."""
    for name, node in run.plan.graph.nodes.items():
        for combination, index in run.plan.cells.get(name, {}).items():
            labels = dict(zip(node.axes, combination, strict=True))
            others = [str(one) for axis, one in labels.items() if axis != name]
            group = f"{name}={labels[name]}" if name in labels else name
            yield Cell(group, ", ".join(others) or ONLY, name, labels, index)


class Results:
    """What is known of the results of a run.

    Parameters
    ----------
    run
        Values that it does not have in memory are read from its store, and computed again only
        where they are not in it.
    """

    def __init__(self, run: Run) -> None:
        self._run = run
        self._sketches: dict[int, Sketch | None] = {}
        self._unstored: dict[int, tuple[Any, ...]] = {}

    @property
    def comparisons(self) -> tuple[Comparison, ...]:
        """How values are told apart."""
        return self._run.plan.graph.registry.comparisons

    def ended(self, index: int) -> str:
        """Return how a step ended, if it has no value."""
        outcome = self._run.outcomes[index]
        if outcome.state in ("done", "unneeded"):
            return ""
        # what a failure says may be of this machine only; that it failed is what counts
        said = _FOLDERS.sub("", outcome.reason) if outcome.state == "refused" else ""
        return f"{outcome.state}: {' '.join(said.split())}" if said else outcome.state

    def digest(self, index: int) -> str:
        """Return a digest of all values of a step but drawings and files; empty if unknown."""
        return self._digest(index, opaque=False)

    def opaque_digest(self, index: int) -> str:
        """Return a digest of a step's drawings and files: they are compared by it alone."""
        return self._digest(index, opaque=True)

    def sketch(self, index: int) -> Sketch | None:
        """Return the sketch of a step's values; None where there is none that could be stored."""
        if index not in self._sketches:
            packed = self._packed(index)
            ports = self._ports(index)
            graded = {
                port.name: one
                for port, one in zip(ports, packed, strict=True)
                if one is not None and not self._is_opaque(port)
            }
            self._sketches[index] = sketch(graded) if graded else None
        return self._sketches[index]

    def parts(self, index: int, most: int) -> dict[str, tuple[Parts, Axes]]:
        """Return the parts of those of a step's arrays of which a plugin knows what they are.

        Parameters
        ----------
        index
            Of the step.
        most
            Parts of an axis at most.
        """
        found: dict[str, tuple[Parts, Axes]] = {}
        if not any(map(self._kind, self._ports(index))):
            return found
        for port, value in zip(self._ports(index), self._shown(index), strict=True):
            kind = self._kind(port)
            for name, axes in kind.parts(value).items() if kind and kind.parts else ():
                place = f"{port.name}.{name}"
                parts = parts_of(place, getattr(value, name), len(axes), most)
                if parts is not None:
                    found[place] = parts, axes
        return found

    def beside(self, index: int, digest: str, kept: Kept) -> dict[str, tuple[Any, Any]]:
        """Return by outputs what a lock's digest stood for, if that is kept, and the values.

        Parameters
        ----------
        index
            Of the step.
        digest
            Of its values in the lock.
        kept
        """
        node, opaque = self._run.plan.steps[index].method.node, self._opaque(index)
        was = kept.values(node.name, digest, opaque)
        if not was:
            return {}
        pairs = zip(self._ports(index), was, self._shown(index), opaque, strict=True)
        return {port.name: (one, now) for port, one, now, is_opaque in pairs if not is_opaque}

    def most_parts(self, cells: Iterable[Cell]) -> int:
        """Return into how many parts an axis is taken apart, for a lock to stay small."""
        count = sum(1 for cell in cells for port in self._ports(cell.index) if self._kind(port))
        return max(FEWEST, min(MOST, _NUMBERS // 2 // max(1, count)))

    def gives_files(self, index: int) -> bool:
        """Whether a step gives files: their bytes are results, and no pictures of some."""
        return any(issubclass(port.type, Files) for port in self._ports(index))

    def _digest(self, index: int, *, opaque: bool) -> str:
        found = zip(self._opaque(index), self._digests(index), strict=True)
        return joined(one for is_opaque, one in found if one and is_opaque == opaque)

    def _digests(self, index: int) -> tuple[str, ...]:
        stored = self._run.outcomes[index].digests or self._stored(index)
        if stored:
            return stored
        packed = self._packed(index)  # which may have had them computed, and stored
        return self._stored(index) or tuple(one.digest if one else "" for one in packed)

    def _stored(self, index: int) -> tuple[str, ...]:
        recall = self._run.recall
        key = recall.keys.of[index] if recall is not None else ""
        entry = recall.store.find(key) if recall is not None and key else None
        return entry.digests if entry is not None else ()

    def _shown(self, index: int) -> tuple[Any, ...]:
        """Return the values of a step, the same ones each time though it may give others."""
        if index in self._unstored:
            return self._unstored[index]
        values = self._run.shown_of(index)
        if not self._stored(index):
            self._unstored[index] = values
        return values

    def _packed(self, index: int) -> tuple[Packed | None, ...]:
        return tuple(map(self._taken_apart, self._shown(index)))

    def _taken_apart(self, value: Any) -> Packed | None:
        try:
            return self._run.packer.pack(value)
        except Unstorable:
            return None

    def _kind(self, port: Port) -> Comparison | None:
        return next(
            (one for one in self.comparisons if one.parts and issubclass(port.type, one.type)), None
        )

    def _ports(self, index: int) -> tuple[Port, ...]:
        return self._run.plan.steps[index].method.node.outputs

    def _opaque(self, index: int) -> list[bool]:
        return [self._is_opaque(port) for port in self._ports(index)]

    def _is_opaque(self, port: Port) -> bool:
        storages = self._run.plan.graph.registry.storages
        drawn = next((one for one in storages if issubclass(port.type, one.type)), None)
        return issubclass(port.type, Files) or (drawn is not None and not drawn.faithful)

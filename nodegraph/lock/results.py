"""The results of a run: their digests, sketches and usual sizes."""

from __future__ import annotations

import hashlib
import re
import sys
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from statistics import median

from nodegraph.execute import Run
from nodegraph.formatting import name_at
from nodegraph.lock.locked_result import LockedResult
from nodegraph.lock.sketch import FLOOR, Sketch, sketch
from nodegraph.node.ports import Port
from nodegraph.node.values import Files
from nodegraph.plugin.hook_types import Comparison
from nodegraph.state import State
from nodegraph.store import DamagedEntry, Packed, Store, Unstorable, Upkeep

_DIGITS = 10
_EXACT_DIGITS = 8

ONLY = "only"
"""Stands for the labels of a node without other axes than its alternatives."""

_FOLDERS = re.compile(r"(?<![\w.:/\\])(?:[A-Za-z]:)?[/\\](?:[^\s:'\"/\\]+[/\\])+")


@dataclass(frozen=True)
class Cell:
    """A combination of a node.

    Attributes
    ----------
    group : str
        The node, or node and alternative: ``fill=muscle``.
    at : str
        The labels of its other axes, or `ONLY`.
    node : str
    labels : mapping of axis to label
    index : int
        Index of the step that computes it.
    """

    group: str
    at: str
    node: str
    labels: Mapping[str, object]
    index: int

    @property
    def name(self) -> str:
        """Node and labels: ``fill(fill=muscle, length=5)``."""
        return name_at(self.node, self.labels)


def cells_of(run: Run) -> Iterator[Cell]:
    """Yield every combination of a run, node by node in the order of the graph."""
    for name, node in run.plan.graph.nodes.items():
        for combination, index in run.plan.cells.get(name, {}).items():
            labels = dict(zip(node.axes, combination, strict=True))
            other_labels = [str(label) for axis, label in labels.items() if axis != name]
            group = f"{name}={labels[name]}" if name in labels else name
            yield Cell(group, ", ".join(other_labels) or ONLY, name, labels, index)


class StoredValues:
    """The values of a store by the digests in a lock; the store is listed at the first use."""

    def __init__(self, store: Store) -> None:
        self._store = store

    def values(self, node: str, digest: str, opaque: Sequence[bool]) -> tuple[object, ...]:
        """Return the values with a digest; none if they are not stored.

        Parameters
        ----------
        node
            Name of the node that returned them: ``fill.muscle``.
        digest
        opaque
            Which outputs are not part of the digest.
        """
        for key, digests in self._by_node.get(node, ()):
            if len(digests) == len(opaque) and digest:
                outputs = zip(digests, opaque, strict=True)
                if _joined(text for text, is_opaque in outputs if not is_opaque) == digest:
                    return self._load(key)
        return ()

    def _load(self, key: str) -> tuple[object, ...]:
        entry = self._store.find(key)
        try:
            return self._store.load(entry) if entry is not None else ()
        except DamagedEntry:
            return ()

    @cached_property
    def _by_node(self) -> Mapping[str, list[tuple[str, tuple[str, ...]]]]:
        by_node: dict[str, list[tuple[str, tuple[str, ...]]]] = defaultdict(list)
        for stored in Upkeep(self._store.folder).entries():
            by_node[stored.entry.node].append((stored.entry.key, stored.entry.digests))
        return by_node


class Results:
    """The results of a run.

    Parameters
    ----------
    run
        Values that are not in memory are loaded from its store, or else computed again.
    """

    def __init__(self, run: Run) -> None:
        self._run = run
        self._sketches: dict[int, Sketch | None] = {}
        self._unstored: dict[int, tuple[object, ...]] = {}

    @property
    def comparisons(self) -> tuple[Comparison, ...]:
        """The descriptions of differences that plugins give."""
        return self._run.plan.graph.registry.hooks.comparisons

    def ending(self, index: int) -> str:
        """Return state and reason of a step without a value; empty if it has one."""
        outcome = self._run.outcomes[index]
        if outcome.state.has_value:
            return ""
        # the message of a failure may depend on the machine
        reason = _FOLDERS.sub("", outcome.reason) if outcome.state is State.REFUSED else ""
        return f"{outcome.state}: {' '.join(reason.split())}" if reason else outcome.state

    def digest(self, index: int) -> str:
        """Return a digest of a step's values except drawings and files; empty if unknown."""
        return self._digest(index, opaque=False)

    def opaque_digest(self, index: int) -> str:
        """Return a digest of a step's drawings and files, which are compared by nothing else."""
        return self._digest(index, opaque=True)

    def sketch(self, index: int) -> Sketch | None:
        """Return the sketch of a step's values; None if none of them can be stored."""
        if index not in self._sketches:
            outputs = {
                port.name: packed
                for port, packed in zip(self._ports(index), self._packed(index), strict=True)
                if packed is not None and not self._is_opaque(port)
            }
            self._sketches[index] = sketch(outputs) if outputs else None
        return self._sketches[index]

    def exact(self, index: int) -> str:
        """Return a short digest of what must be equal in a step's values."""
        summary = self.sketch(index)
        return summary.exact[:_EXACT_DIGITS] if summary else ""

    def value_pairs(
        self, index: int, digest: str, stored: StoredValues
    ) -> dict[str, tuple[object, object]]:
        """Return the locked and the present value of each output, if the former are stored.

        Parameters
        ----------
        index
            Of the step.
        digest
            That of its values in the lock.
        stored
        """
        node, opaque = self._run.plan.steps[index].method.node, self._opaque(index)
        was = stored.values(node.name, digest, opaque)
        if not was:
            return {}
        outputs = zip(self._ports(index), was, self._values(index), opaque, strict=True)
        return {port.name: (old, new) for port, old, new, is_opaque in outputs if not is_opaque}

    def has_files(self, index: int) -> bool:
        """Return whether a step returns files: unlike drawings, their bytes are results."""
        return any(issubclass(port.type, Files) for port in self._ports(index))

    def _digest(self, index: int, *, opaque: bool) -> str:
        outputs = zip(self._opaque(index), self._digests(index), strict=True)
        return _joined(text for is_opaque, text in outputs if text and is_opaque == opaque)

    def _digests(self, index: int) -> tuple[str, ...]:
        stored = self._run.outcomes[index].digests or self._stored(index)
        if stored:
            return stored
        packed = self._packed(index)  # may compute and store the values
        return self._stored(index) or tuple(value.digest if value else "" for value in packed)

    def _stored(self, index: int) -> tuple[str, ...]:
        key, cache = self._run.outcomes[index].key, self._run.cache
        entry = cache.entry(self._run.plan.steps[index], key) if cache is not None else None
        return entry.digests if entry is not None else ()

    def _values(self, index: int) -> tuple[object, ...]:
        """Return the values of a step, the same each time even if the step is random."""
        if index in self._unstored:
            return self._unstored[index]
        values = self._run.shown_of(index)
        if not self._stored(index):
            self._unstored[index] = values
        return values

    def _packed(self, index: int) -> tuple[Packed | None, ...]:
        return tuple(map(self._pack, self._values(index)))

    def _pack(self, value: object) -> Packed | None:
        try:
            return self._run.packer.pack(value)
        except Unstorable:
            return None

    def _ports(self, index: int) -> tuple[Port, ...]:
        return self._run.plan.steps[index].method.node.outputs

    def _opaque(self, index: int) -> list[bool]:
        return [self._is_opaque(port) for port in self._ports(index)]

    def _is_opaque(self, port: Port) -> bool:
        storages = self._run.plan.graph.registry.hooks.storages
        storage = next((kind for kind in storages if issubclass(port.type, kind.type)), None)
        return issubclass(port.type, Files) or (storage is not None and not storage.faithful)


def scales(cells: Iterable[Cell], results: Results, run: Run) -> dict[str, dict[str, float]]:
    """Return the usual size of the floats at each place of the values of each group.

    It is the median over the combinations, but no less than a thousandth of the size of the inputs,
    because the difference of two large numbers has their rounding errors.

    Parameters
    ----------
    cells
        In the order of the graph.
    results
    run
    """
    grouped: dict[str, list[int]] = {}
    for cell in cells:
        if not results.ending(cell.index):
            grouped.setdefault(cell.group, []).append(cell.index)
    network = run.plan.network
    sizes: dict[int, float] = {}
    by_group: dict[str, dict[str, float]] = {}
    for group, steps in grouped.items():
        inputs = (sizes.get(source, 0.0) for step in steps for source in network.pred[step])
        largest = max(inputs, default=0.0)
        usual = _medians(results.sketch(step) for step in steps)
        by_group[group] = {
            place: min(float(f"{max(size, FLOOR * largest) or 1.0:.4g}"), sys.float_info.max)
            for place, size in usual.items()
        }
        sizes |= dict.fromkeys(steps, max([largest, *usual.values()]))
    return by_group


def recorded(cell: Cell, results: Results, scale: Mapping[str, float]) -> LockedResult:
    """Return the locked result of a combination.

    Parameters
    ----------
    cell
    results
    scale
        Usual size of the floats at each place of its values.
    """
    if ending := results.ending(cell.index):
        return LockedResult(ending)
    summary = results.sketch(cell.index)
    return LockedResult(
        digest=results.digest(cell.index),
        exact=results.exact(cell.index),
        projections=summary.against(scale).projections if summary and summary.leaves else None,
        opaque=results.opaque_digest(cell.index),
    )


def _medians(sketches: Iterable[Sketch | None]) -> dict[str, float]:
    # of halves, because the mean of two sizes may overflow
    halves: dict[str, list[float]] = {}
    for summary in sketches:
        for place, leaf in summary.leaves.items() if summary is not None else ():
            halves.setdefault(place, []).extend([leaf.size / 2.0] if leaf.size else [])
    return {place: 2.0 * median(values or [0.0]) for place, values in halves.items()}


def _joined(digests: Iterable[str]) -> str:
    """Return a short digest of several; empty if there are none."""
    text = "\n".join(digests)
    return hashlib.sha256(text.encode()).hexdigest()[:_DIGITS] if text else ""

"""The results of a run, each as a few words that a text file can hold."""

from __future__ import annotations

import hashlib
import re
import sys
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from statistics import median
from typing import TYPE_CHECKING, Any

from nodegraph.execute import Run
from nodegraph.formatting import name_at
from nodegraph.lock.sketch import (
    FEWEST,
    FLOOR,
    MOST,
    Parts,
    Sketch,
    as_text,
    from_text,
    parts_of,
    sketch,
)
from nodegraph.node.ports import Port
from nodegraph.node.values import Files
from nodegraph.plugin.hook_types import Comparison, Conclusion
from nodegraph.state import State
from nodegraph.store import DamagedEntry, Packed, Store, Unstorable, Upkeep

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


_DIGITS = 10


class Kept:
    """Finds values in a store by the digests that a lock holds.

    Parameters
    ----------
    store
        Looked through once, when something is asked for.
    """

    def __init__(self, store: Store) -> None:
        self._store = store

    def values(self, node: str, digest: str, opaque: Sequence[bool]) -> tuple[Any, ...]:
        """Return the values of a digest; none if they are not stored.

        Parameters
        ----------
        node
            Name of the node that gave them: ``fill.muscle``.
        digest
            As `joined` makes it.
        opaque
            Which outputs do not count in it.
        """
        for key, digests in self._by_node.get(node, ()):
            if len(digests) == len(opaque) and digest:
                counted = zip(digests, opaque, strict=True)
                if joined(one for one, left_out in counted if not left_out) == digest:
                    return self._load(key)
        return ()

    def _load(self, key: str) -> tuple[Any, ...]:
        entry = self._store.find(key)
        try:
            return self._store.load(entry) if entry is not None else ()
        except DamagedEntry:
            return ()

    @cached_property
    def _by_node(self) -> Mapping[str, list[tuple[str, tuple[str, ...]]]]:
        found: dict[str, list[tuple[str, tuple[str, ...]]]] = defaultdict(list)
        for one in Upkeep(self._store.folder).entries():
            found[one.entry.node].append((one.entry.key, one.entry.digests))
        return found


def joined(digests: Iterable[str]) -> str:
    """Return one short digest of several; empty of none."""
    text = "\n".join(digests)
    return hashlib.sha256(text.encode()).hexdigest()[:_DIGITS] if text else ""


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
        return self._run.plan.graph.registry.hooks.comparisons

    def ended(self, index: int) -> str:
        """Return how a step ended, if it has no value."""
        outcome = self._run.outcomes[index]
        if outcome.state.has_value:
            return ""
        # what a failure says may be of this machine only; that it failed is what counts
        said = _FOLDERS.sub("", outcome.reason) if outcome.state is State.REFUSED else ""
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
        key, cache = self._run.outcomes[index].key, self._run.cache
        entry = cache.entry(self._run.plan.steps[index], key) if cache is not None else None
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
        storages = self._run.plan.graph.registry.hooks.storages
        drawn = next((one for one in storages if issubclass(port.type, one.type)), None)
        return issubclass(port.type, Files) or (drawn is not None and not drawn.faithful)


@dataclass(frozen=True)
class Said:
    """What one reported value says.

    Attributes
    ----------
    name : str
        The node, its output where it has several, its labels where there are some.
    sentences : tuple of str
    numbers : str
        As CSV.
    """

    name: str
    sentences: tuple[str, ...]
    numbers: str


def said_by(run: Run) -> Iterator[Said]:
    """Yield what each reported value says; those of which no plugin knows it are left out."""
    graph = run.plan.graph
    for node, port in graph.reported:
        outputs = graph.nodes[node].outputs
        for output in [port] if port else outputs:
            for labels, value in run[f"{node}.{output}"].shown():
                kind = _kind(value, graph.registry.hooks.conclusions)
                if kind is not None:
                    name = f"{node}.{output}" if len(outputs) > 1 else node
                    full = name_at(name, labels)
                    yield Said(full, tuple(map(str, kind.conclude(value))), kind.numbers(value))


def _kind(value: Any, conclusions: tuple[Conclusion, ...]) -> Conclusion | None:
    return next((one for one in conclusions if isinstance(value, one.type)), None)


def scales(cells: Iterable[Cell], results: Results, run: Run) -> dict[str, dict[str, float]]:
    """Return the usual size of the floats at each place of the values of each group.

    It is the median over the combinations; but no less than a thousandth of what the values are
    made of, because the difference of two large numbers has the rounding of those.

    Parameters
    ----------
    cells
        In the order of the graph.
    results
    run
    """
    grouped: dict[str, list[int]] = {}
    for cell in cells:
        if not results.ended(cell.index):
            grouped.setdefault(cell.group, []).append(cell.index)
    above: dict[int, float] = {}
    found: dict[str, dict[str, float]] = {}
    for group, steps in grouped.items():
        fed = (above.get(one, 0.0) for step in steps for one in run.plan.steps[step].needed)
        largest = max(fed, default=0.0)
        usual = _usual(results.sketch(one) for one in steps)
        found[group] = {
            place: min(float(f"{max(size, FLOOR * largest) or 1.0:.4g}"), sys.float_info.max)
            for place, size in usual.items()
        }
        above |= dict.fromkeys(steps, max([largest, *usual.values()]))
    return found


def _usual(sketches: Iterable[Sketch | None]) -> dict[str, float]:
    sizes: dict[str, list[float]] = {}
    for one in sketches:
        for place, leaf in one.leaves.items() if one is not None else ():
            sizes.setdefault(place, []).append(leaf.size)
    # the halves have a mean that does not overflow, and of all but the smallest the same digits
    halves = {place: [one / 2.0 for one in all_ if one] for place, all_ in sizes.items()}
    return {place: 2.0 * median(found or [0.0]) for place, found in halves.items()}


_WITHOUT = "-"
_EXACT = 8
_ENDED = (State.REFUSED, State.FAILED, State.SKIPPED)


@dataclass(frozen=True)
class Recorded:
    """What a lock holds of one result.

    Attributes
    ----------
    ended : str
        How it ended where it has no value.
    digest, exact, opaque : str
        Of the values without drawings and files, of what must be equal in them, and of drawings
        and files; empty where there is none.
    projections : array or None
        See `nodegraph.lock.sketch`; None without floats.
    """

    ended: str = ""
    digest: str = ""
    exact: str = ""
    projections: NDArray[np.float64] | None = None
    opaque: str = ""

    @property
    def text(self) -> str:
        """The result in one line."""
        sums = "" if self.projections is None else as_text(self.projections)
        words = [one or _WITHOUT for one in (self.digest, self.exact, sums, self.opaque)]
        while words and words[-1] == _WITHOUT:
            words.pop()
        return self.ended or " ".join(words) or _WITHOUT

    @classmethod
    def read(cls, text: str) -> Recorded:
        """Return what a line says.

        Raises
        ------
        ValueError
            If it says nothing.
        """
        if text.partition(":")[0] in _ENDED:
            return cls(ended=text)
        words = ["" if one == _WITHOUT else one for one in text.split(" ")]
        digest, exact, sums, opaque = [*words, "", "", ""][:4]
        return cls("", digest, exact, from_text(sums) if sums else None, opaque)


def recorded(cell: Cell, results: Results, scale: Mapping[str, float]) -> Recorded:
    """Return what a lock holds of one combination.

    Parameters
    ----------
    cell
    results
    scale
        Usual size of the floats at each place of its values.
    """
    ended = results.ended(cell.index)
    if ended:
        return Recorded(ended)
    found = results.sketch(cell.index)
    return Recorded(
        digest=results.digest(cell.index),
        exact=exact_of(results, cell.index),
        projections=found.against(scale).projections if found and found.leaves else None,
        opaque=results.opaque_digest(cell.index),
    )


def exact_of(results: Results, index: int) -> str:
    """Return a short digest of what must be equal in a step's values."""
    found = results.sketch(index)
    return found.exact[:_EXACT] if found else ""

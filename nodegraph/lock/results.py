"""The results of a run: their digests, sketches and usual sizes."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from contextlib import suppress
from statistics import median

from nodegraph.execute.results import Run
from nodegraph.lock.sketch import FLOOR, Sketch, sketch
from nodegraph.node.ports import Port
from nodegraph.node.values import Files
from nodegraph.runs.record import RecordedStep
from nodegraph.store import Entry, Packed, Unreadable, Unstorable


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

    def digests(self, index: int) -> tuple[str, ...]:
        """Return a digest per output of a step; empty for one that cannot be stored."""
        stored = self._run.outcomes[index].digests or self._stored(index)
        if stored:
            return stored
        packed = self._packed(index)  # may compute and store the values
        return self._stored(index) or tuple(value.digest if value else "" for value in packed)

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

    def opaque(self, index: int) -> list[bool]:
        """Return which outputs of a step are drawings and files, of which only digests count."""
        return [self._is_opaque(port) for port in self._ports(index)]

    def has_files(self, index: int) -> bool:
        """Return whether a step returns files: unlike drawings, their bytes are results."""
        return any(issubclass(port.type, Files) for port in self._ports(index))

    def usual_sizes(self, steps: Iterable[RecordedStep]) -> dict[str, dict[str, float]]:
        """Return the usual size of the floats at each place of the values of each group.

        It is the median over the steps, but no less than a thousandth of the size of the inputs,
        because the difference of two large numbers has their rounding errors.

        Parameters
        ----------
        steps
            The steps to look at; those that have a result count.
        """
        groups: dict[str, list[int]] = {}
        for step in steps:
            if step.has_result:
                groups.setdefault(step.cells[0].group, []).append(step.step)
        nodes = list(self._run.plan.graph.nodes)  # each after those that feed it
        order = sorted(groups, key=lambda group: nodes.index(group.partition("=")[0]))
        sizes: dict[int, float] = {}
        by_group: dict[str, dict[str, float]] = {}
        for group in order:
            indices = groups[group]
            sources = (source for index in indices for source in self._run.plan.network.pred[index])
            largest = max((sizes.get(source, 0.0) for source in sources), default=0.0)
            usual = _medians(self.sketch(index) for index in indices)
            by_group[group] = {
                place: min(float(f"{max(size, FLOOR * largest) or 1.0:.4g}"), sys.float_info.max)
                for place, size in usual.items()
            }
            sizes |= dict.fromkeys(indices, max([largest, *usual.values()]))
        return by_group

    def _stored(self, index: int) -> tuple[str, ...]:
        entry = self._entry(index)
        return entry.digests if entry is not None else ()

    def _entry(self, index: int) -> Entry | None:
        key, cache = self._run.outcomes[index].key, self._run.cache
        return cache.entry(self._run.plan.steps[index], key) if cache is not None else None

    def _values(self, index: int) -> tuple[object, ...]:
        """Return the values of a step, the same each time even if the step is random."""
        if index in self._unstored:
            return self._unstored[index]
        values = self._run.shown_of(index)
        if not self._stored(index):
            self._unstored[index] = values
        return values

    def _packed(self, index: int) -> tuple[Packed | None, ...]:
        entry, cache = self._entry(index), self._run.cache
        if entry is not None and cache is not None and all(entry.faithful):
            with suppress(Unreadable):  # to load it says so, and it is computed again
                return cache.store.packed(entry)
        return tuple(map(self._pack, self._values(index)))

    def _pack(self, value: object) -> Packed | None:
        try:
            return self._run.packer.pack(value)
        except Unstorable:
            return None

    def _ports(self, index: int) -> tuple[Port, ...]:
        return self._run.plan.steps[index].method.node.outputs

    def _is_opaque(self, port: Port) -> bool:
        kind = self._run.plan.graph.registry.hooks.kind(port.type, "take_apart")
        return issubclass(port.type, Files) or (kind is not None and not kind.faithful)


def _medians(sketches: Iterable[Sketch | None]) -> dict[str, float]:
    # of halves, because the mean of two sizes may overflow
    halves: dict[str, list[float]] = {}
    for summary in sketches:
        for place, leaf in summary.leaves.items() if summary is not None else ():
            halves.setdefault(place, []).extend([leaf.size / 2.0] if leaf.size else [])
    return {place: 2.0 * median(values or [0.0]) for place, values in halves.items()}

"""Values in memory: loaded when a step reads them, lent to it, dropped after their last reader."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from nodegraph.execute.outcome import Outcome
from nodegraph.execute.resume import StoredSteps
from nodegraph.node.ports import Absent, Across
from nodegraph.plan import Output, Step
from nodegraph.state import State
from nodegraph.store import Packer


class ValuePool:
    """The values of a plan's steps that are in memory.

    Parameters
    ----------
    packer
        How values are lent to readers.
    cache
        Where values are loaded from.
    keep
        Steps whose values stay after their last reader.

    Attributes
    ----------
    keep : frozenset of step index
    values : dict of step index to values
        Values of the steps to keep, and of those that are still to be read.
    """

    def __init__(self, packer: Packer, cache: StoredSteps | None, keep: frozenset[int]) -> None:
        self.keep = keep
        self.values: dict[int, tuple[object, ...]] = {}
        self._packer = packer
        self._cache = cache
        self._unread: dict[int, int] = {}  # how many steps have yet to read each
        self._partial: set[int] = set()  # in memory, but some values are stand-ins

    def expect(self, reader: Step) -> None:
        """Note that a step will read the values that it needs."""
        for needed in reader.needed:
            self._unread[needed] = self._unread.get(needed, 0) + 1

    def add(self, index: int, values: tuple[object, ...]) -> None:
        """Hold the values of a step if a step is to read them, or if they are kept."""
        if self._unread.get(index) or index in self.keep:
            self.values[index] = values

    def load(self, reader: Step, outcomes: Mapping[int, Outcome]) -> list[int]:
        """Load what a step reads and is stored; return the steps whose values are lost."""
        cache = self._cache
        if cache is None:
            return []
        return [
            needed for needed in reader.needed if not self._holds(reader, needed, outcomes, cache)
        ]

    def take(self, reader: Step, outcomes: Mapping[int, Outcome]) -> dict[str, object]:
        """Return the inputs of a step, and drop what no other step is to read: it has a copy."""
        inputs = {
            port: self._lend(source)
            if isinstance(source, Output)
            else self._gather(source, outcomes)
            for port, source in reader.inputs.items()
        }
        self.release(reader)
        return inputs

    def release(self, reader: Step) -> None:
        """Drop what no step is to read any more, now that this one does not."""
        for needed in reader.needed:
            if unread := self._unread.get(needed):
                self._unread[needed] = unread - 1
                if unread == 1 and (needed not in self.keep or needed in self._partial):
                    self.drop(needed)

    def drop(self, index: int) -> None:
        """Forget the values of a step."""
        self.values.pop(index, None)
        self._partial.discard(index)

    def _holds(
        self, reader: Step, needed: int, outcomes: Mapping[int, Outcome], cache: StoredSteps
    ) -> bool:
        """Whether what a reader takes from a step is in memory; load it if it is stored."""
        in_memory = needed in self.values
        if in_memory and needed not in self._partial:
            return True
        outcome = outcomes.get(needed)
        if outcome is None:
            return False
        if outcome.state is not State.DONE:
            return True
        positions = {output.position for output in reader.reads() if output.step == needed}
        if not cache.gives(needed, positions):
            return False
        if in_memory:
            return True
        values = cache.load(needed)
        if values is None:
            return False
        self.values[needed] = values
        if not cache.gives(needed, range(len(values))):
            self._partial.add(needed)
        return True

    def _gather(self, source: Across[Any], outcomes: Mapping[int, Outcome]) -> Across[object]:
        # mappings of its own: a reader that changes them changes nothing for others
        entries = []
        unused: list[tuple[str, ...]] = []
        absent = [replace(each, labels=dict(each.labels)) for each in source.absent]
        for index, (at, output) in enumerate(source):
            labels, outcome = dict(at), outcomes[output.step]
            if outcome.state is State.DONE:
                entries.append((labels, self._lend(output)))
                unused += source.unused[index : index + 1]
            else:
                absent.append(Absent(labels, outcome.root.value, outcome.reason))
        return replace(
            source,
            entries=tuple(entries),
            absent=tuple(absent),
            known=dict(source.known),
            unused=tuple(unused),
        )

    def _lend(self, output: Output) -> object:
        return self._packer.lend(self.values[output.step][output.position])

"""A run, finished or opened from its folder: how its steps ended, and their values."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

from nodegraph.errors import NodegraphError, nearest
from nodegraph.execute.call import collecting_warnings
from nodegraph.execute.executor import HowToRun
from nodegraph.execute.numeric_threads import one_thread_each
from nodegraph.execute.outcome import Outcome
from nodegraph.execute.resume import StoredSteps
from nodegraph.execute.schedule import Schedule
from nodegraph.execute.settings import RunSettings
from nodegraph.execute.threads import serial
from nodegraph.execute.value_table import value_table
from nodegraph.formatting import number_of
from nodegraph.node.ports import Label
from nodegraph.plan import Plan, Step
from nodegraph.state import State
from nodegraph.store import DamagedEntry, Entry, Packer, Upkeep

if TYPE_CHECKING:
    import pandas as pd


class NotStored(NodegraphError):
    """Values of a run are not stored, and are computed only by `Run.compute`.

    Attributes
    ----------
    steps : tuple of int
        The steps that have to be computed, by their index in the plan.
    """

    def __init__(self, steps: Iterable[Step]) -> None:
        listed = tuple(steps)
        self.steps = tuple(step.index for step in listed)
        super().__init__(f"not stored: {', '.join(step.name for step in listed)}")


class Advance(NamedTuple):
    """Progress of a computation: steps that have ended, steps left, and the last that ended."""

    ended: int
    left: int
    step: str = ""


@dataclass(frozen=True, repr=False)
class Run:
    """A run, finished in this process or opened from its folder.

    Attributes
    ----------
    plan : Plan
    outcomes : mapping of step index to Outcome
    in_memory : mapping of step index to values
        Other values are loaded, or computed again, when they are needed.
    seconds : float
    cache : StoredSteps or None
        Where results are stored.
    packer : Packer
        How values are lent to readers.
    settings : RunSettings
        The settings with which it was started.
    is_opened : bool
        Whether it was opened from its folder: it computes values again only by `compute`, as code
        and files may have changed since.
    """

    plan: Plan
    outcomes: Mapping[int, Outcome]
    in_memory: Mapping[int, tuple[object, ...]]
    seconds: float
    cache: StoredSteps | None
    packer: Packer
    settings: RunSettings
    is_opened: bool = False
    _computed: dict[int, tuple[object, ...]] = field(default_factory=dict, init=False)

    def __repr__(self) -> str:
        counts = ", ".join(f"{count} {state}" for state, count in self.counts().items() if count)
        return f"<Run of {self.plan.graph.title!r}: {counts}>"

    def __iter__(self) -> Iterator[str]:
        return iter(self.plan.cells)

    def __contains__(self, name: object) -> bool:
        return name in self.plan.cells

    def __getitem__(self, name: str) -> Values:
        """Return the values of a node, or of one output: ``run["gaps.truth"]``."""
        graph, node, port = self.plan.graph, name, ""
        left_out = graph.reasons_left_out()
        if name not in self.plan.cells and name not in left_out and "." in name:
            # names of nodes inside used graphs contain points, too
            node, _, port = name.rpartition(".")
        if node in left_out:
            raise NodegraphError(f"{node!r} is left out: {left_out[node]}")
        if node not in self.plan.cells:
            raise NodegraphError(f"the run has no node {node!r}; {nearest(node, self.plan.cells)}")
        outputs = graph.nodes[node].outputs
        if port and port not in outputs:
            raise NodegraphError(f"{node!r} has no output {port!r}; {nearest(port, outputs)}")
        return Values(self, node, port)

    @property
    def ok(self) -> bool:
        """Whether no step failed."""
        return not any(outcome.state is State.FAILED for outcome in self.outcomes.values())

    def reported(self) -> Iterator[tuple[str, str, dict[str, Label], object]]:
        """Yield node, output, labels and value of every result that the report lists."""
        graph = self.plan.graph
        for node, port in graph.reported:
            for output in [port] if port else graph.nodes[node].outputs:
                for labels, value in self[f"{node}.{output}"].shown():
                    if graph.report_entry(node, port, labels) is not None:
                        yield node, output, labels, value

    def counts(self) -> dict[str, int]:
        """Return the number of steps by how they ended: computed, stored, and so on."""
        counts = Counter(outcome.status for outcome in self.outcomes.values())
        return {state.value: counts[state] for state in State}

    def settled(self, *states: State) -> Iterator[tuple[Step, Outcome]]:
        """Yield the steps in these states with their outcomes, in the order of the plan."""
        for step in self.plan.steps:
            outcome = self.outcomes.get(step.index)
            if outcome is not None and (not states or outcome.state in states):
                yield step, outcome

    def not_stored(self) -> list[str]:
        """Return why results are not stored: ``2 results are not stored: why``."""
        reasons = self.cache.not_stored if self.cache is not None else {}
        return [
            f"{number_of(count, 'result')} {'is' if count == 1 else 'are'} not stored: {reason}"
            for reason, count in reasons.items()
        ]

    def tidy(self) -> None:
        """Keep the bound on the size of the store.

        It may take seconds, so that a command shows the answer first. Ctrl-C ends it early; a later
        run continues.
        """
        store = self.cache.store if self.cache is not None else None
        with suppress(KeyboardInterrupt):
            if store is not None and store.saved and (removed := Upkeep(store.folder).tidy()):
                store.say(removed)

    def values_of(self, index: int) -> tuple[Any, ...]:
        """Return a step's values: from memory, from the store, or computed again.

        Raises
        ------
        NodegraphError
            If the step has none, with the reason.
        """
        step, outcome = self.plan.steps[index], self.outcomes[index]
        if not outcome.state.has_value:
            raise NodegraphError(f"{step.name} was {outcome.state}: {outcome.reason}")
        values = self._at_hand(index)
        if values is None:
            if self.is_opened:
                raise NotStored([step])
            for _ in self.compute([index]):
                pass
            # a value that cannot be stored is computed each time, so that it takes no memory
            values = self._computed.pop(index, None) or self._stored(index)
        if values is None:
            raise NodegraphError(f"{step.name} cannot be computed again: its result is lost")
        return tuple(map(self.packer.lend, values))

    def has_at_hand(self, index: int) -> bool:
        """Whether a step has values in memory or stored, so that nothing is computed for them."""
        if not self.outcomes[index].state.has_value:
            return False
        entry = self._entry(index)
        in_memory = index in self.in_memory or index in self._computed
        return in_memory or (entry is not None and all(entry.faithful))

    def shown_of(self, index: int) -> tuple[object, ...]:
        """Return a step's values, or the stand-ins that are stored of them to be shown.

        A figure differs each time it is drawn: a report shows the drawing that later runs find.
        """
        stand_ins = self._stored(index, stand_ins=True)
        return self.values_of(index) if stand_ins is None else stand_ins

    def compute(self, indices: Iterable[int]) -> Iterator[Advance]:
        """Compute steps again, with those that they need and that are not stored.

        Nothing is computed beyond the step at which the iterator is left. Their values stay in
        memory until the next call.

        Raises
        ------
        NodegraphError
            If one of the steps fails, or gives another result because a file or code has changed.
        """
        wanted = list(indices)
        known = self.cache.stored() if self.cache is not None else {}
        known |= {at: end for at, end in self.outcomes.items() if not end.state.has_value}
        schedule = Schedule(
            self.plan,
            cache=self.cache,
            known={index: outcome for index, outcome in known.items() if index not in wanted},
            packer=self.packer,
            keep=wanted,
            wanted=wanted,
        )
        ended = 0
        yield Advance(ended, len(schedule.left))
        with collecting_warnings(), one_thread_each():
            for index, outcome in serial(schedule, HowToRun()):
                schedule.finish(index, outcome)
                ended += 1
                yield Advance(ended, len(schedule.left), self.plan.steps[index].name)
        self._computed.clear()
        for index in wanted:
            outcome, name = schedule.outcomes[index], self.plan.steps[index].name
            if not outcome.state.has_value:
                raise NodegraphError(f"{name} cannot be computed again: {outcome.reason}")
            if outcome.key != self.outcomes[index].key:
                raise NodegraphError(
                    f"{name} cannot be computed again: a file or code that it needs has changed"
                )
            if index in schedule.values:
                self._computed[index] = schedule.values[index]

    @cached_property
    def now(self) -> Run:
        """The run of the same graph with code and files as they are now."""
        assert self.cache is not None
        outcomes = {
            index: replace(outcome, key=self.cache.expected_key(index))
            for index, outcome in self.outcomes.items()
        }
        return replace(self, outcomes=outcomes, in_memory={})

    def _at_hand(self, index: int) -> tuple[object, ...] | None:
        in_memory = self.in_memory.get(index) or self._computed.get(index)
        return in_memory or self._stored(index)

    def _stored(self, index: int, *, stand_ins: bool = False) -> tuple[object, ...] | None:
        entry = self._entry(index)
        if self.cache is None or entry is None or all(entry.faithful) == stand_ins:
            return None
        try:
            return self.cache.values(self.plan.steps[index], entry)
        except DamagedEntry:
            return None

    def _entry(self, index: int) -> Entry | None:
        if self.cache is None:
            return None
        return self.cache.entry(self.plan.steps[index], self.outcomes[index].key)


@dataclass(frozen=True, repr=False)
class Values:
    """The values of one output of a node, by labels.

    Attributes
    ----------
    run : Run
    node : str
    port : str
        Empty for the first output of each method.
    """

    run: Run
    node: str
    port: str

    def __repr__(self) -> str:
        name = f"{self.node}.{self.port}" if self.port else self.node
        along = f" along {', '.join(self.axes)}" if self.axes else ""
        return f"<Values of {name!r}: {len(self)}{along}>"

    def __len__(self) -> int:
        return len(self.run.plan.cells[self.node])

    def __iter__(self) -> Iterator[tuple[dict[str, Label], Any]]:
        return ((labels, self._value(index)) for labels, index in self._steps())

    @property
    def axes(self) -> tuple[str, ...]:
        """The node's axes."""
        return self.run.plan.graph.nodes[self.node].axes

    @property
    def value(self) -> Any:
        """The only value of a node that has one combination left.

        Raises
        ------
        NodegraphError
            If there are several combinations.
        """
        return self.at()

    def at(self, **labels: Label) -> Any:
        """Return the value at these labels; axes with one label may be left out.

        Raises
        ------
        NodegraphError
            If the labels do not name one combination that has a value.
        """
        for axis in labels:
            if axis not in self.axes:
                raise NodegraphError(
                    f"{self.node!r} has no axis {axis!r}; {nearest(axis, self.axes)}"
                )
            self._label(axis, labels)  # a wrong label before axes that are left out
        combination = tuple(self._label(axis, labels) for axis in self.axes)
        plan = self.run.plan
        if combination not in plan.cells[self.node]:
            reason = plan.skipped[self.node].get(combination, "there is no such combination")
            raise NodegraphError(f"{self.node} at {combination}: {reason}")
        return self._value(plan.cells[self.node][combination])

    def frame(self) -> pd.DataFrame:
        """Return the values as one table, with a column for each axis.

        Tables are concatenated; any other values are one column. A combination without a value is
        one row in which the value is missing; only if there is such a row, the columns ``state``
        and ``reason`` say for every row how its step ended.
        """
        plan, outcomes = self.run.plan, self.run.outcomes
        values = {tuple(labels.values()): value for labels, value in self}
        absent = {at: outcomes[index] for at, index in plan.cells[self.node].items()}
        absent |= {
            at: Outcome(State.SKIPPED, reason=reason)
            for at, reason in plan.skipped[self.node].items()
        }
        absent = {at: outcome for at, outcome in absent.items() if at not in values}
        axes = {axis: plan.graph.axes[axis].labels for axis in self.axes}
        # a node with alternatives is an axis itself
        output = plan.graph.nodes[self.node].first.node.outputs[0].name
        names = (self.port or self.node, output, f"{self.node}_{output}")
        column = next((name for name in names if name not in axes), names[-1])
        return value_table(self.node, column, axes, values, absent)

    def shown(self) -> Iterator[tuple[dict[str, Label], object]]:
        """Yield labels and values, or stand-ins that are stored of values to be shown."""
        return ((labels, self.shown_at(labels)) for labels in self.labels())

    def labels(self) -> Iterator[dict[str, Label]]:
        """Yield the labels of each combination that has a value."""
        return (labels for labels, _ in self._steps())

    def shown_at(self, labels: Mapping[str, Label]) -> object:
        """Return the value at the labels of all axes, or the stand-in that is stored of it."""
        index = self.run.plan.cells[self.node][tuple(labels[axis] for axis in self.axes)]
        return self.run.shown_of(index)[self._position(index)]

    def _steps(self) -> Iterator[tuple[dict[str, Label], int]]:
        for combination, index in self.run.plan.cells[self.node].items():
            if self.run.outcomes[index].state.has_value:
                yield dict(zip(self.axes, combination, strict=True)), index

    def _value(self, index: int) -> object:
        return self.run.values_of(index)[self._position(index)]

    def _position(self, index: int) -> int:
        """Return the position of the output, which may be another one in each method."""
        names = [port.name for port in self.run.plan.steps[index].method.node.outputs]
        return names.index(self.port) if self.port else 0

    def _label(self, axis: str, labels: Mapping[str, Label]) -> Label:
        known = self.run.plan.graph.axes[axis].labels
        if axis not in labels:
            if len(known) == 1:
                return known[0]
            raise NodegraphError(
                f"{self.node!r} has several values along {axis!r}; {nearest('', known)}"
            )
        if labels[axis] not in known:
            raise NodegraphError(
                f"{axis!r} has no label {labels[axis]!r}; {nearest(labels[axis], known)}"
            )
        return labels[axis]

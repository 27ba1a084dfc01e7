"""What a run came to: outcomes by step, values by node and labels."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from nodegraph.errors import NodegraphError, nearest
from nodegraph.execute.call import Outcome, warnings_heard
from nodegraph.execute.executors import HowToRun
from nodegraph.execute.executors.serial import serial
from nodegraph.execute.schedule import Schedule
from nodegraph.plan import Combination, Plan, Step
from nodegraph.ports import Label


@dataclass(frozen=True)
class Run:
    """A finished run.

    Attributes
    ----------
    plan : Plan
    outcomes : mapping of step index to Outcome
    kept : mapping of step index to values
        Values that are still in memory; others are computed again when they are asked for.
    seconds : float
    """

    plan: Plan
    outcomes: Mapping[int, Outcome]
    kept: Mapping[int, tuple[Any, ...]]
    seconds: float

    def __getitem__(self, name: str) -> Values:
        """Return the values of a node, or of one output: ``run["gaps.truth"]``."""
        node, _, port = name.partition(".")
        for left_out in self.plan.graph.left_out:
            if left_out.node == node:
                raise NodegraphError(f"{node!r} is left out: {left_out.reason}")
        if node not in self.plan.cells:
            raise NodegraphError(f"the run has no node {node!r}; {nearest(node, self.plan.cells)}")
        outputs = self.plan.graph.nodes[node].outputs
        if port and port not in outputs:
            raise NodegraphError(f"{node!r} has no output {port!r}; {nearest(port, outputs)}")
        return Values(self, node, port)

    @property
    def ok(self) -> bool:
        """Whether no step failed."""
        return not any(one.state == "failed" for one in self.outcomes.values())

    def counts(self) -> dict[str, int]:
        """Return how many steps were done, refused, failed and skipped."""
        found = Counter(one.state for one in self.outcomes.values())
        return {state: found[state] for state in ("done", "refused", "failed", "skipped")}

    def settled(self, *states: str) -> Iterator[tuple[Step, Outcome]]:
        """Yield the steps in these states with their outcomes, in the order of the plan."""
        for step in self.plan.steps:
            outcome = self.outcomes.get(step.index)
            if outcome is not None and (not states or outcome.state in states):
                yield step, outcome

    def values_of(self, index: int) -> tuple[Any, ...]:
        """Return a step's values, from memory or computed again.

        Raises
        ------
        NodegraphError
            If the step has none, with the reason.
        """
        step, outcome = self.plan.steps[index], self.outcomes[index]
        if outcome.state != "done":
            raise NodegraphError(f"{step.name} was {outcome.state}: {outcome.reason}")
        if index in self.kept:
            return self.kept[index]
        again = Schedule(self.plan, keep=[index], wanted=[index])
        with warnings_heard():
            for done, found in serial(again, HowToRun()):
                again.finish(done, found)
        if index not in again.values:
            reason = again.outcomes[index].reason
            raise NodegraphError(f"{step.name} cannot be computed again: {reason}")
        return again.values[index]


@dataclass(frozen=True)
class Values:
    """The values of one output of a node, by labels; an empty port is each method's first."""

    run: Run
    node: str
    port: str

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
        found = tuple(self._label(axis, labels) for axis in self.axes)
        cells = self.run.plan.cells[self.node]
        if found not in cells:
            raise NodegraphError(f"{self.node} at {found}: {self._skipped(found)}")
        return self._of(cells[found])

    def __iter__(self) -> Iterator[tuple[dict[str, Label], Any]]:
        for combination, index in self.run.plan.cells[self.node].items():
            if self.run.outcomes[index].state == "done":
                labels = dict(zip(self.axes, combination, strict=True))
                yield labels, self._of(index)

    def __len__(self) -> int:
        return len(self.run.plan.cells[self.node])

    def _of(self, index: int) -> Any:
        """Return the output of one step: by its name, because methods may order theirs."""
        names = [one.name for one in self.run.plan.steps[index].method.node.outputs]
        position = names.index(self.port) if self.port else 0
        return self.run.values_of(index)[position]

    def _label(self, axis: str, labels: Mapping[str, Label]) -> Label:
        there = self.run.plan.graph.axes[axis].labels
        if axis not in labels:
            if len(there) == 1:
                return there[0]
            raise NodegraphError(
                f"{self.node!r} has several values along {axis!r}; {nearest('', there)}"
            )
        if labels[axis] not in there:
            raise NodegraphError(
                f"{axis!r} has no label {labels[axis]!r}; {nearest(labels[axis], there)}"
            )
        return labels[axis]

    def _skipped(self, combination: Combination) -> str:
        return self.run.plan.skipped[self.node].get(combination, "there is no such combination")

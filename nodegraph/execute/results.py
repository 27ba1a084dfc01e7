"""What a run came to: outcomes by step, and where its values are."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from nodegraph.display import in_notebook
from nodegraph.errors import NodegraphError, nearest
from nodegraph.execute.call import Outcome, warnings_heard
from nodegraph.execute.executors import HowToRun
from nodegraph.execute.executors.serial import serial
from nodegraph.execute.one_thread import one_thread_each
from nodegraph.execute.recall import Recall
from nodegraph.execute.schedule import Schedule
from nodegraph.execute.values import Values
from nodegraph.plan import Plan, Step
from nodegraph.store import Packer

_STATES = ("done", "stored", "refused", "failed", "skipped", "unneeded")


@dataclass(frozen=True, repr=False)
class Run:
    """A finished run.

    Attributes
    ----------
    plan : Plan
    outcomes : mapping of step index to Outcome
    kept : mapping of step index to values
        Values that are in memory; others are loaded, or computed again, when they are asked for.
    seconds : float
    recall : Recall or None
        Where results are stored.
    packer : Packer
        How values are lent to readers.
    """

    plan: Plan
    outcomes: Mapping[int, Outcome]
    kept: Mapping[int, tuple[Any, ...]]
    seconds: float
    recall: Recall | None
    packer: Packer

    def __repr__(self) -> str:
        counts = ", ".join(f"{count} {state}" for state, count in self.counts().items() if count)
        return f"<Run of {self.plan.graph.title!r}: {counts}>"

    def __iter__(self) -> Iterator[str]:
        return iter(self.plan.cells)

    def __contains__(self, name: object) -> bool:
        return name in self.plan.cells

    def __getitem__(self, name: str) -> Values:
        """Return the values of a node, or of one output: ``run["gaps.truth"]``."""
        node, port = self._named(name)
        for left_out in self.plan.graph.left_out:
            if left_out.node == node:
                raise NodegraphError(f"{node!r} is left out: {left_out.reason}")
        if node not in self.plan.cells:
            raise NodegraphError(f"the run has no node {node!r}; {nearest(node, self.plan.cells)}")
        outputs = self.plan.graph.nodes[node].outputs
        if port and port not in outputs:
            raise NodegraphError(f"{node!r} has no output {port!r}; {nearest(port, outputs)}")
        return Values(self, node, port)

    def _named(self, name: str) -> tuple[str, str]:
        """Return the node, and the output, that a name means; nodes of used graphs have points."""
        left_out = (one.node for one in self.plan.graph.left_out)
        if name in self.plan.cells or name in left_out or "." not in name:
            return name, ""
        node, _, port = name.rpartition(".")
        return node, port

    @property
    def ok(self) -> bool:
        """Whether no step failed."""
        return not any(one.state == "failed" for one in self.outcomes.values())

    def counts(self) -> dict[str, int]:
        """Return how many steps were computed, were stored, and so on."""
        found = Counter(
            "stored" if one.stored and one.state == "done" else one.state
            for one in self.outcomes.values()
        )
        return {state: found[state] for state in _STATES}

    def _repr_html_(self) -> str:
        """Return how a notebook shows the run."""
        return in_notebook("run_html", self)

    def settled(self, *states: str) -> Iterator[tuple[Step, Outcome]]:
        """Yield the steps in these states with their outcomes, in the order of the plan."""
        for step in self.plan.steps:
            outcome = self.outcomes.get(step.index)
            if outcome is not None and (not states or outcome.state in states):
                yield step, outcome

    def values_of(self, index: int) -> tuple[Any, ...]:
        """Return a step's values: from memory, from the store, or computed again.

        Raises
        ------
        NodegraphError
            If the step has none, with the reason.
        """
        step, outcome = self.plan.steps[index], self.outcomes[index]
        if outcome.state not in ("done", "unneeded"):
            raise NodegraphError(f"{step.name} was {outcome.state}: {outcome.reason}")
        values = self.kept.get(index) or self._loaded(step) or self._computed(step)
        return tuple(map(self.packer.lend, values))

    def shown_of(self, index: int) -> tuple[Any, ...]:
        """Return a step's values, or what is stored of them to be shown."""
        loaded = self._loaded(self.plan.steps[index], to_be_shown=True)
        return self.values_of(index) if loaded is None else loaded

    def _loaded(self, step: Step, *, to_be_shown: bool = False) -> tuple[Any, ...] | None:
        if self.recall is None or step.index not in self.recall:
            return None
        outputs = range(len(step.method.node.outputs))
        if self.recall.gives(step.index, outputs) == to_be_shown:
            return None
        return self.recall.load(step.index)

    def _computed(self, step: Step) -> tuple[Any, ...]:
        again = Schedule(
            self.plan,
            recall=self.recall,
            known=self._known_but(step.index),
            packer=self.packer,
            keep=[step.index],
            wanted=[step.index],
        )
        with self._files_as_they_were(step), warnings_heard(), one_thread_each():
            for done, found in serial(again, HowToRun()):
                again.finish(done, found)
        values = again.values.get(step.index) or self._loaded(step)
        if values is None:
            reason = again.outcomes[step.index].reason
            raise NodegraphError(f"{step.name} cannot be computed again: {reason}")
        return values

    def _known_but(self, index: int) -> dict[int, Outcome]:
        """Return how all but one step ended that need not be computed again."""
        ended = ("refused", "failed", "skipped")
        known = self.recall.known() if self.recall is not None else {}
        known |= {at: one for at, one in self.outcomes.items() if one.state in ended}
        known.pop(index, None)
        return known

    @contextmanager
    def _files_as_they_were(self, step: Step) -> Iterator[None]:
        """Refuse to compute a step again of files that changed since the run."""
        if self.recall is None:
            yield
            return
        keys = self.recall.keys.of
        before = list(keys)
        yield
        if keys[step.index] != before[step.index]:
            keys[:] = before
            raise NodegraphError(
                f"{step.name} cannot be computed again: a file that it is made of has changed"
            )

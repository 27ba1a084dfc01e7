"""What a run came to: outcomes by step, and where its values are."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from nodegraph.errors import NodegraphError, nearest
from nodegraph.execute.call import Outcome, warnings_heard
from nodegraph.execute.executors import HowToRun
from nodegraph.execute.executors.serial import serial
from nodegraph.execute.numeric_threads import one_thread_each
from nodegraph.execute.schedule import Schedule
from nodegraph.execute.step_cache import Recall
from nodegraph.formatting import in_notebook
from nodegraph.graph import Graph
from nodegraph.node.ports import Label
from nodegraph.plan import Combination, Plan, Step
from nodegraph.store import Packer

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, repr=False)
class Values:
    """The values of one output of a node, by labels; an empty port is each method's first."""

    run: Run
    node: str
    port: str

    def __repr__(self) -> str:
        name = f"{self.node}.{self.port}" if self.port else self.node
        along = f" along {', '.join(self.axes)}" if self.axes else ""
        return f"<Values of {name!r}: {len(self)}{along}>"

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
        return ((labels, self._of(index)) for labels, index in self._there())

    def frame(self) -> pd.DataFrame:
        """Return the values as one table, with a column for each axis."""
        return frame_of(self)

    def shown(self) -> Iterator[tuple[dict[str, Label], Any]]:
        """Yield labels and values, or what is stored of values to be shown."""
        for labels, index in self._there():
            yield labels, self.run.shown_of(index)[self._position(index)]

    def __len__(self) -> int:
        return len(self.run.plan.cells[self.node])

    def _there(self) -> Iterator[tuple[dict[str, Label], int]]:
        for combination, index in self.run.plan.cells[self.node].items():
            if self.run.outcomes[index].state in ("done", "unneeded"):
                yield dict(zip(self.axes, combination, strict=True)), index

    def _of(self, index: int) -> Any:
        return self.run.values_of(index)[self._position(index)]

    def _position(self, index: int) -> int:
        """Return which output of a step is meant: by its name, because methods may order theirs."""
        names = [one.name for one in self.run.plan.steps[index].method.node.outputs]
        return names.index(self.port) if self.port else 0

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


_PLAIN = (bool, int, float, str)


def frame_of(values: Values) -> pd.DataFrame:
    """Return the values of a node, with a leading column for each of its axes.

    Tables are put below each other: their rows get the labels of their combination, a column
    that is named like an axis gives way to it, and the `attrs` of the first table are kept.
    Anything else stands in one column, named after the output or the node. A combination
    without a value is one row in which the value is missing; only if there is such a row, the
    columns ``state`` and ``reason`` tell for every row what became of it.

    Parameters
    ----------
    values : Values
        As ``run["error"]`` or ``run["gaps.hidden"]``.
    """
    import pandas as pd

    found = {tuple(labels.values()): value for labels, value in values}
    absent = _absent(values, found)
    order = [one for one in _combinations(values) if one in found or one in absent]
    if found and all(isinstance(one, pd.DataFrame) for one in found.values()):
        parts = [_rows(found.get(one), values.axes) for one in order]
        body = pd.concat(parts, ignore_index=True)
        body.attrs = dict(next(iter(found.values())).attrs)
        counts = [len(one) for one in parts]
    else:
        column = [found.get(one) for one in order]
        body = pd.DataFrame({_name(values): _series(column)})
        counts = [1] * len(order)
    _insert_axes(body, values.axes, order, counts)
    if absent:
        states = [absent.get(one, ("done", "")) for one in order]
        for place, name in enumerate(("state", "reason")):
            told = [state[place] for state in states]
            # a table may have such a column of its own
            free = f"{values.node}_{name}" if name in body.columns else name
            body[free] = _repeated(told, counts)
    return body


def _combinations(values: Values) -> Iterable[Combination]:
    """Return all combinations of the node's axes, in the order of their labels."""
    axes = values.run.plan.graph.axes
    return itertools.product(*(axes[axis].labels for axis in values.axes))


def _absent(values: Values, found: Mapping[Combination, Any]) -> dict[Combination, tuple[str, str]]:
    """Return the state and the reason of each combination without a value."""
    plan, outcomes = values.run.plan, values.run.outcomes
    steps = {at: outcomes[index] for at, index in plan.cells[values.node].items()}
    left_out = {at: ("skipped", reason) for at, reason in plan.skipped[values.node].items()}
    return left_out | {
        at: (outcome.state, outcome.reason) for at, outcome in steps.items() if at not in found
    }


def _rows(table: pd.DataFrame | None, axes: Sequence[str]) -> pd.DataFrame:
    """Return the rows of one combination: those of its table, or an empty one in its place."""
    import pandas as pd

    if table is None:
        return pd.DataFrame(index=range(1))
    if not isinstance(table.index, pd.RangeIndex) or table.index.name is not None:
        table = table.reset_index()
    return table.drop(columns=[axis for axis in axes if axis in table.columns])


def _series(column: Sequence[Any]) -> pd.Series[Any]:
    import pandas as pd

    plain = all(one is None or isinstance(one, _PLAIN) for one in column)
    return pd.Series(column, dtype=None if plain and column else object)


def _insert_axes(
    body: pd.DataFrame, axes: Sequence[str], order: Sequence[Combination], counts: Sequence[int]
) -> None:
    for place, axis in enumerate(axes):
        body.insert(place, axis, _repeated([one[place] for one in order], counts))


def _repeated(items: Sequence[Any], counts: Sequence[int]) -> list[Any]:
    pairs = zip(items, counts, strict=True)
    return [one for item, count in pairs for one in itertools.repeat(item, count)]


def _name(values: Values) -> str:
    """Return what the column of values is called: a node with alternatives is an axis itself."""
    output = values.run.plan.graph.nodes[values.node].first.node.outputs[0].name
    names = (values.port or values.node, output, f"{values.node}_{output}")
    return next((name for name in names if name not in values.axes), names[-1])


def left_out(graph: Graph) -> dict[str, str]:
    """Return why nodes are left out, by node."""
    reasons: dict[str, dict[str, None]] = {}
    for one in graph.left_out:
        reasons.setdefault(one.node, {})[one.reason] = None
    return {node: "; ".join(found) for node, found in reasons.items()}


def left_out_together(graph: Graph) -> dict[str, tuple[str, ...]]:
    """Return which nodes are left out, by the reason that they have in common."""
    together: dict[str, tuple[str, ...]] = {}
    for node, reason in left_out(graph).items():
        together[reason] = (*together.get(reason, ()), node)
    return together


def left_out_lines(graph: Graph) -> list[str]:
    """Return what a terminal says of it: ``left out: faces, playback: why``."""
    return [
        f"left out: {', '.join(nodes)}: {reason}"
        for reason, nodes in left_out_together(graph).items()
    ]


def not_kept_lines(run: Run) -> list[str]:
    """Return what a terminal says of it: ``2 results are not stored: why``."""
    if run.recall is None:
        return []
    return [
        f"{count} results are not stored: {reason}" for reason, count in run.recall.not_kept.items()
    ]

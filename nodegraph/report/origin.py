"""The origin of a value in a report: the steps behind it, their times and their inputs."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache

import networkx as nx

from nodegraph.execute.results import Run
from nodegraph.graphfile.keys import PASS
from nodegraph.node.ports import Across, Label
from nodegraph.plan import Output, Step
from nodegraph.plugin.hook_types import Detail, Placeholder, Rendered
from nodegraph.state import State

_MOST_VALUES = 32
"""Values kept in memory: the truth of a take, and what each method made of it."""


def render_in_run(value: object, title: str, origin: RunOrigin) -> Rendered | None:
    """Return how a value of a run appears; None if no plugin shows values of its type."""
    kind = origin.run.plan.graph.registry.hooks.kind(type(value), "render")
    if kind is not None and kind.render_in_run is not None:
        return kind.render_in_run(value, title, origin)
    if kind is not None and kind.render is not None:
        return kind.render(value, origin.caption or title)
    return Rendered("", str(value)) if isinstance(value, (str, int, float)) else None


@dataclass(frozen=True)
class RunOrigin:
    """The `nodegraph.Provenance` of a value of a run."""

    run: Run
    node: str
    labels: Mapping[str, Label]
    caption: str = ""
    answer: tuple[str | Placeholder, ...] = ()

    def detail(self, value: object) -> Detail | None:
        """Return the view of single blocks whose scores read such a value; None without one."""
        kind = self.run.plan.graph.registry.hooks.kind(type(value), "detail")
        return kind.detail() if kind is not None and kind.detail is not None else None

    def seconds(self, axis: str) -> dict[Label, list[float]]:
        """Return the times of results by label of an axis; empty if no node has the name."""
        plan, outcomes = self.run.plan, self.run.outcomes
        steps = [step for step in plan.steps if step.node == axis and axis in step.labels]
        before = {step.index: nx.ancestors(plan.network, step.index) for step in steps}
        rivals: dict[frozenset[tuple[str, Label]], list[Step]] = defaultdict(list)
        for step in steps:
            rivals[frozenset({**step.labels, axis: ""}.items())].append(step)
        times: dict[Label, list[float]] = defaultdict(list)
        for several in rivals.values():
            of_all = set.intersection(*(before[step.index] for step in several))
            for step in several:
                own = (step.index, *(before[step.index] - of_all))
                counted = [outcomes[index] for index in own]
                if all(outcome.state is State.DONE for outcome in counted):
                    times[step.labels[axis]].append(sum(outcome.seconds for outcome in counted))
        return dict(times)

    def summaries(self, axis: str) -> dict[Label, str]:
        """Return the first lines of the documentation of methods that labels of an axis name."""
        node = self.run.plan.graph.nodes.get(axis)
        if node is None or not node.has_alternatives:
            return {}
        return {
            label: method.node.summary
            for label, method in node.methods.items()
            if method.node.name != PASS
            and str(label).startswith(method.node.name.rpartition(".")[2])
        }

    def open_axes(self, labels: Mapping[str, Label]) -> dict[str, tuple[Label, ...]]:
        """Return the gathered axes that labels leave open, each with its labels."""
        gathered = self._gathered.axes if self._gathered is not None else ()
        axes = self.run.plan.graph.axes
        return {axis: tuple(axes[axis].labels) for axis in gathered if axis not in labels}

    def inputs(self, labels: Mapping[str, Label]) -> dict[str, object] | None:
        """Return the inputs of the step behind a gathered value, by port."""
        step = self.step(labels)
        if step is None:
            return None
        outputs = {port: each for port, each in step.inputs.items() if isinstance(each, Output)}
        if not all(self.run.has_at_hand(output.step) for output in outputs.values()):
            return None
        return {port: self._value(output) for port, output in outputs.items()}

    def command(self, labels: Mapping[str, Label]) -> str:
        """Return the command that computes the step behind a gathered value."""
        step = self.step(labels)
        return "" if step is None else self.run.settings.repeat(step)

    def step(self, labels: Mapping[str, Label]) -> Step | None:
        """Return the step behind a gathered value; labels of other axes are ignored."""
        gathered = self._gathered
        if gathered is None or not all(axis in labels for axis in gathered.axes):
            return None
        output = self._outputs.get(tuple(labels[axis] for axis in gathered.axes))
        return None if output is None else self.run.plan.steps[output.step]

    @cached_property
    def _gathered(self) -> Across[Output] | None:
        plan = self.run.plan
        axes = plan.graph.nodes[self.node].axes
        index = plan.cells[self.node][tuple(self.labels[axis] for axis in axes)]
        feeds = plan.steps[index].inputs.values()
        return next((feed for feed in feeds if isinstance(feed, Across)), None)

    @cached_property
    def _outputs(self) -> dict[tuple[Label, ...], Output]:
        gathered = self._gathered or ()
        return {tuple(labels.values()): output for labels, output in gathered}

    @cached_property
    def _value(self) -> Callable[[Output], object]:
        run = self.run  # a reference to the origin would keep its values in memory
        return lru_cache(_MOST_VALUES)(lambda output: run.values_of(output.step)[output.position])

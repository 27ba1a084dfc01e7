"""The record of a run: what ran, with which settings, and how it ended."""

from __future__ import annotations

import platform
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property
from typing import Annotated, Any

from pydantic import Field

from nodegraph.cache_key import UNKNOWN, Reached
from nodegraph.execute.events import plain
from nodegraph.execute.executor import HowToRun
from nodegraph.execute.outcome import Outcome
from nodegraph.execute.results import Run
from nodegraph.execute.resume import StoredSteps
from nodegraph.execute.settings import Bool, Float, Int, Label, RunSettings, settings_of
from nodegraph.formatting import name_at
from nodegraph.graph import Graph, GraphNode, LeftOut
from nodegraph.graph.methods import installed_version
from nodegraph.plan import Output, Plan, Step, StepInput, skip_reason
from nodegraph.state import State

FORMAT = 2
Labels = dict[str, Label]
CellKey = tuple[str, tuple[tuple[str, str], ...]]

_DIGITS = 10
"""Digits of the digests of code that a record holds."""

_version_of_library = cache(installed_version)
_LIBRARIES = ("nodegraph", "numpy", "scipy", "pandas", "numba", "scikit-learn", "matplotlib")


@dataclass(frozen=True, slots=True)
class PluginFile:
    """A plugin file, with the SHA-256 of its content when it was imported."""

    path: Annotated[str, Field(min_length=1)]
    sha256: str


@dataclass(frozen=True, slots=True)
class RecordedMethod:
    """A method of a node."""

    use: str
    plugin: str
    outputs: Annotated[list[str], Field(min_length=1)]
    distribution: str = ""

    @property
    def full_name(self) -> str:
        """The name with the plugin, if it comes from one."""
        return f"{self.plugin}:{self.use}" if self.plugin else self.use


@dataclass(frozen=True, slots=True)
class RecordedNode:
    """A node of the graph, with its methods by label."""

    axes: list[str]
    gathered: list[str]
    methods: dict[str, RecordedMethod]


@dataclass(frozen=True, slots=True)
class RecordedCode:
    """The code that a method reaches.

    Attributes
    ----------
    units : list of str
        Names of modules and functions, whose digests are in the record's `units`.
    distributions : list of str
        Names of distributions, whose versions are in the record's `versions`.
    """

    units: list[str] = field(default_factory=list)
    distributions: list[str] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Notice:
    """A warning of the graph, which holds whatever its steps give."""

    place: str
    message: str
    instead: str = ""


@dataclass(frozen=True, slots=True)
class Cell:
    """A combination of a node."""

    node: str
    labels: Labels

    @property
    def name(self) -> str:
        """Node and labels: ``fill(fill=muscle, length=5)``."""
        return name_at(self.node, self.labels)

    @property
    def group(self) -> str:
        """The node, or node and alternative: ``fill=muscle``."""
        return f"{self.node}={self.labels[self.node]}" if self.node in self.labels else self.node

    @property
    def key(self) -> CellKey:
        """What is the same in all runs that have the combination."""
        labels = sorted((axis, str(label)) for axis, label in self.labels.items())
        return self.node, tuple(labels)


@dataclass(frozen=True, slots=True)
class Skipped:
    """Combinations that were not planned, and why.

    Attributes
    ----------
    labels : dict of axis to labels
        The labels that the reason names; a combination that was not planned and has them is meant.
    counts : dict of node to int
        How many combinations of each node.
    """

    reason: str
    counts: dict[str, Int]
    labels: dict[str, list[Label]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class NotShown:
    """A result that the report should show, and why it does not."""

    node: str
    labels: Labels
    reason: str
    output: str = ""
    trace: str = ""


@dataclass(frozen=True, slots=True)
class NotWritten:
    """A file that the folder lacks, and why."""

    file: str
    reason: str
    trace: str = ""


@dataclass(frozen=True, slots=True)
class RecordedSource:
    """An output that feeds a port; with labels where the port gathers."""

    step: Int
    output: str
    labels: Labels = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class RecordedStep:
    """A step, and how it ended.

    Attributes
    ----------
    step : int
        Its index in the plan.
    stored : bool
        Whether the result was in the store already.
    place : str
        Where in the code of the node it failed.
    digests : list of str
        A digest per output; its first ten digits in a lock.
    sketch : str
        In a lock, a summary of the values by which other values are measured.
    repeat : str
        The command that repeats a failed step.
    key : str
        Under which its result is stored.
    files : dict of str to str
        Digests of the files that settings name.
    also : list of Cell
        Other combinations that the step computes.
    """

    step: Int
    node: str
    use: str
    labels: Labels
    settings: dict[str, Any]
    inputs: dict[str, RecordedSource | list[RecordedSource]]
    state: State
    seconds: Float
    stored: Bool = False
    reason: str = ""
    place: str = ""
    trace: str = ""
    warnings: list[str] = field(default_factory=list)
    digests: list[str] = field(default_factory=list)
    repeat: str = ""
    key: Annotated[str, Field(pattern="^([0-9a-f]{64})?$")] = ""
    files: dict[str, str] = field(default_factory=dict)
    also: list[Cell] = field(default_factory=list)
    sketch: Annotated[str, Field(pattern="^([0-9a-f]{8}(-[A-Za-z0-9+/]{32})?)?$")] = ""

    @property
    def has_result(self) -> bool:
        """Whether the step has a result."""
        return self.state.has_value

    @property
    def cells(self) -> tuple[Cell, ...]:
        """The combinations that the step computes."""
        return (Cell(self.node, self.labels), *self.also)

    @property
    def status(self) -> State:
        """The state as events and counts list it: ``stored`` if it is done without a call."""
        return State.STORED if self.stored and self.state is State.DONE else self.state

    @property
    def ending(self) -> str:
        """How the step ended, with its reason if it has no result."""
        return f"{self.state}: {self.reason}" if self.reason else self.state

    def sources(self) -> Iterator[tuple[str, tuple[RecordedSource, ...]]]:
        """Yield each port with what feeds it."""
        for port, fed in self.inputs.items():
            yield port, tuple(fed) if isinstance(fed, list) else (fed,)


@dataclass(frozen=True)
class Record:
    """Everything about a run but its values, as ``run.json`` and a lock hold it.

    Attributes
    ----------
    command : str
        Runs the same again.
    folder : str
        The working directory, from which relative paths in the settings start.
    included : dict of str to str
        The texts of the graph files that the graph uses.
    removed : dict of axis to list
        Labels of the graph that the command left out.
    code : dict of str to RecordedCode
        By plugin and name of the method; empty if nothing was stored.
    units : dict of str to str
        Digests of the modules and functions that methods reach.
    versions : dict of str to str
        Versions of Python, the platform, plugins, and the distributions that methods reach.
    """

    format: Int
    command: str
    settings: RunSettings
    folder: Annotated[str, Field(min_length=1)]
    plugins: list[PluginFile]
    title: str
    included: dict[str, str]
    inputs: dict[str, Any]
    axes: dict[str, list[Label]]
    nodes: dict[str, RecordedNode]
    code: dict[str, RecordedCode]
    units: dict[str, str]
    known: list[str]
    left_out: list[LeftOut]
    counts: dict[str, Int]
    seconds: Float
    skipped: list[Skipped]
    versions: dict[str, str]
    not_shown: list[NotShown] = field(default_factory=list)
    not_written: list[NotWritten] = field(default_factory=list)
    notices: list[Notice] = field(default_factory=list)
    removed: dict[str, list[Label]] = field(default_factory=dict)
    steps: list[RecordedStep] = field(default_factory=list)

    @cached_property
    def by_index(self) -> Mapping[int, RecordedStep]:
        """The steps by their index in the plan."""
        return {step.step: step for step in self.steps}

    def files(self) -> dict[str, str]:
        """Return the digests of the files that settings name."""
        return {
            str(step.settings.get(setting)): digest
            for step in self.steps
            for setting, digest in step.files.items()
        }

    def method(self, step: RecordedStep) -> RecordedMethod:
        """Return the method of a step."""
        methods = self.nodes[step.node].methods.values()
        return next(method for method in methods if method.use == step.use)


def record(run: Run) -> Record:
    """Return the record of a run."""
    graph = run.plan.graph
    reached = _reached(run)
    rules = {
        skip_reason(item): {axis: list(labels) for axis, labels in item.labels.items()}
        for item in graph.spec.skip
    }
    return Record(
        format=FORMAT,
        command=run.settings.command,
        settings=run.settings,
        folder=str(graph.choices.folder.absolute()),
        plugins=[
            PluginFile(str(plugin.module.__file__), plugin.digest)
            for plugin in graph.registry.loaded
            if plugin.digest
        ],
        title=graph.title,
        included=dict(graph.spec.included),
        inputs=plain(graph.inputs),
        axes={name: list(axis.labels) for name, axis in graph.axes.items()},
        removed={
            name: sorted(axis.removed, key=str) for name, axis in graph.axes.items() if axis.removed
        },
        nodes={name: _node(node) for name, node in graph.nodes.items()},
        code={
            name: RecordedCode(list(code.units), list(code.versions))
            for name, code in reached.items()
        },
        units={
            name: digest[:_DIGITS]
            for code in reached.values()
            for name, digest in code.units.items()
        },
        known=[str(reference) for reference in graph.spec.known],
        left_out=list(graph.left_out),
        counts=run.counts(),
        seconds=round(run.seconds, 6),
        skipped=[
            Skipped(reason, dict(counts), rules.get(reason, {}))
            for reason, counts in run.plan.skipped_together().items()
        ],
        versions=_all_versions(graph, reached),
        notices=[
            Notice(str(notice.place), notice.message, notice.instead) for notice in graph.notices
        ],
        steps=_steps(run),
    )


def expected(plan: Plan, cache: StoredSteps) -> Record:
    """Return the record that a run would have if every step that is not stored succeeded.

    Those steps have no digests.
    """
    outcomes = {
        step.index: cache.known.get(step.index)
        or Outcome(State.DONE, key=cache.expected_key(step.index))
        for step in plan.steps
    }
    settings = settings_of(plan.graph, HowToRun(), [], cache.store)
    return record(Run(plan, outcomes, {}, 0.0, cache, cache.store.packer, settings))


def versions(graph: Graph) -> dict[str, str]:
    """Return the versions of Python, of the libraries and of the plugins that a graph uses."""
    distributions = {
        method.distribution for node in graph.nodes.values() for method in node.methods.values()
    }
    libraries = {name: _version_of_library(name) for name in _LIBRARIES}
    return {
        "python": sys.version.split()[0],
        "platform": f"{platform.system()} {platform.machine()}",
        **{name: number for name, number in libraries.items() if number},
        **dict(text.rsplit(" ", 1) for text in sorted(distributions) if text),
    }


def _node(node: GraphNode) -> RecordedNode:
    methods = {
        label or node.first.node.name: RecordedMethod(
            method.node.name,
            method.plugin,
            [port.name for port in method.node.outputs],
            method.distribution,
        )
        for label, method in node.methods.items()
    }
    return RecordedNode(list(node.axes), list(node.gathered), methods)


def _reached(run: Run) -> dict[str, Reached]:
    """Return the code that each method reaches; nothing if nothing was stored."""
    if run.cache is None:
        return {}
    return {
        f"{step.method.plugin}:{step.method.node.name}": run.cache.digest_of(step).code
        for step in run.plan.steps
    }


def _all_versions(graph: Graph, reached: Mapping[str, Reached]) -> dict[str, str]:
    numbers = {name: number for code in reached.values() for name, number in code.versions.items()}
    numbers |= versions(graph)
    names = sorted((name for name in numbers if numbers[name] != UNKNOWN), key=str.lower)
    return {name: numbers[name] for name in names}


def _steps(run: Run) -> list[RecordedStep]:
    also: dict[int, list[Cell]] = {}
    for name, cells in run.plan.cells.items():
        axes = run.plan.graph.nodes[name].axes
        for combination, index in cells.items():
            labels = dict(zip(axes, combination, strict=True))
            step = run.plan.steps[index]
            if (step.node, step.labels) != (name, labels):
                also.setdefault(index, []).append(Cell(name, plain(labels)))
    return [_step(run, step, outcome, also.get(step.index, [])) for step, outcome in run.settled()]


def _step(run: Run, step: Step, outcome: Outcome, also: list[Cell]) -> RecordedStep:
    return RecordedStep(
        step=step.index,
        node=step.node,
        use=step.method.node.name,
        labels=plain(step.labels),
        settings={name: plain(value) for name, value in step.shown.items()},
        inputs={port: _sources(run, fed) for port, fed in step.inputs.items()},
        state=outcome.state,
        seconds=round(outcome.seconds, 6),
        stored=outcome.stored,
        reason=outcome.reason,
        place=outcome.place,
        trace=outcome.trace,
        warnings=list(outcome.warnings),
        digests=list(outcome.digests),
        repeat=run.settings.repeat(step) if outcome.state is State.FAILED else "",
        key=outcome.key,
        files=dict(run.cache.digest_of(step).files) if run.cache else {},
        also=also,
    )


def _sources(run: Run, fed: StepInput) -> RecordedSource | list[RecordedSource]:
    if isinstance(fed, Output):
        return _source(run, fed, {})
    return [_source(run, output, labels) for labels, output in fed]


def _source(run: Run, output: Output, labels: Mapping[str, object]) -> RecordedSource:
    ports = run.plan.steps[output.step].method.node.outputs
    return RecordedSource(output.step, ports[output.position].name, plain(labels))

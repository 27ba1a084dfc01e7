"""The record of a run, ``run.json``: what ran, with which settings, and how it ended."""

from __future__ import annotations

import json
import platform
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from nodegraph.errors import NodegraphError
from nodegraph.execute.call import Outcome
from nodegraph.execute.events import plain
from nodegraph.execute.results import Run
from nodegraph.graph import Graph, GraphNode
from nodegraph.plan import Output, Step, StepInput, skip_reason
from nodegraph.runs.settings import Bool, Float, Int, Label, RunSettings
from nodegraph.state import State
from nodegraph.validation import first_error

if TYPE_CHECKING:
    from pydantic import TypeAdapter

FORMAT = 1
Labels = dict[str, Label]

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
    units : dict of str to str
        Digests of functions, classes and constants by name.
    versions : dict of str to str
        Versions of distributions.
    """

    units: dict[str, str] = field(default_factory=dict)
    versions: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class LeftOut:
    """A node without a combination, and why."""

    node: str
    reason: str


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


@dataclass(frozen=True, slots=True)
class Skipped:
    """Combinations that were not planned, and why.

    Attributes
    ----------
    labels : dict of axis to labels
        Those that the reason names; a combination that was not planned and has them is meant.
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
class Source:
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
        A digest per output.
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
    inputs: dict[str, Source | list[Source]]
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

    @property
    def has_result(self) -> bool:
        """Whether the step has a result."""
        return self.state.has_value

    @property
    def cells(self) -> tuple[Cell, ...]:
        """Every combination that the step computes."""
        return (Cell(self.node, self.labels), *self.also)

    def sources(self) -> Iterator[tuple[str, tuple[Source, ...]]]:
        """Yield each port with what feeds it."""
        for port, fed in self.inputs.items():
            yield port, tuple(fed) if isinstance(fed, list) else (fed,)


@dataclass(frozen=True, slots=True)
class Record:
    """Everything about a run but its values.

    Attributes
    ----------
    command : str
        Runs the same again.
    folder : str
        The working directory, from which relative paths in the settings start.
    included : dict of str to str
        The texts of the graph files that the graph uses.
    code : dict of str to RecordedCode
        By plugin and name of the method; empty if nothing was stored.
    not_kept : dict of str to int
        Why results were not stored, and how many.
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
    known: list[str]
    left_out: list[LeftOut]
    counts: dict[str, Int]
    seconds: Float
    not_kept: dict[str, Int]
    steps: list[RecordedStep]
    skipped: list[Skipped]
    versions: dict[str, str]
    not_shown: list[NotShown] = field(default_factory=list)
    not_written: list[NotWritten] = field(default_factory=list)
    notices: list[Notice] = field(default_factory=list)

    def method(self, step: RecordedStep) -> RecordedMethod:
        """Return the method of a step."""
        methods = self.nodes[step.node].methods.values()
        return next(method for method in methods if method.use == step.use)

    def as_json(self) -> str:
        """Return the content of ``run.json``."""
        # pydantic cannot write names of files that are not valid text; the escapes of JSON can
        return json.dumps(_adapter().dump_python(self, exclude_defaults=True), indent=1) + "\n"


def record(run: Run, settings: RunSettings) -> Record:
    """Return the record of a run."""
    graph = run.plan.graph
    rules = {
        skip_reason(item): {axis: list(labels) for axis, labels in item.labels.items()}
        for item in graph.spec.skip
    }
    return Record(
        format=FORMAT,
        command=settings.command,
        settings=settings,
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
        nodes={name: _node(node) for name, node in graph.nodes.items()},
        code=_code(run),
        known=[str(reference) for reference in graph.spec.known],
        left_out=[LeftOut(node, reason) for node, reason in graph.reasons_left_out().items()],
        counts=run.counts(),
        seconds=round(run.seconds, 6),
        not_kept=dict(run.cache.not_stored) if run.cache else {},
        steps=_steps(run, settings),
        skipped=[
            Skipped(reason, dict(counts), rules.get(reason, {}))
            for reason, counts in run.plan.skipped_together().items()
        ],
        versions=versions(graph),
        notices=[
            Notice(str(notice.place), notice.message, notice.instead) for notice in graph.notices
        ],
    )


def versions(graph: Graph) -> dict[str, str]:
    """Return the versions of Python, of the libraries and of the plugins that a graph uses."""
    distributions = {
        method.distribution for node in graph.nodes.values() for method in node.methods.values()
    }
    libraries = {name: _version(name) for name in _LIBRARIES}
    return {
        "python": sys.version.split()[0],
        "platform": f"{platform.system()} {platform.machine()}",
        **{name: number for name, number in libraries.items() if number},
        **dict(text.rsplit(" ", 1) for text in sorted(distributions) if text),
    }


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return ""


def _node(node: GraphNode) -> RecordedNode:
    methods = {
        label or node.first.node.name: RecordedMethod(
            method.node.name, method.plugin, [port.name for port in method.node.outputs]
        )
        for label, method in node.methods.items()
    }
    return RecordedNode(list(node.axes), list(node.gathered), methods)


def _code(run: Run) -> dict[str, RecordedCode]:
    if run.cache is None:
        return {}
    reached = {
        f"{step.method.plugin}:{step.method.node.name}": run.cache.digest_of(step).code
        for step in run.plan.steps
    }
    return {
        name: RecordedCode(dict(code.units), dict(code.versions)) for name, code in reached.items()
    }


def _steps(run: Run, settings: RunSettings) -> list[RecordedStep]:
    also: dict[int, list[Cell]] = {}
    for name, cells in run.plan.cells.items():
        axes = run.plan.graph.nodes[name].axes
        for combination, index in cells.items():
            labels = dict(zip(axes, combination, strict=True))
            step = run.plan.steps[index]
            if (step.node, step.labels) != (name, labels):
                also.setdefault(index, []).append(Cell(name, plain(labels)))
    return [
        _step(run, step, outcome, settings, also.get(step.index, []))
        for step, outcome in run.settled()
    ]


def _step(
    run: Run, step: Step, outcome: Outcome, settings: RunSettings, also: list[Cell]
) -> RecordedStep:
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
        repeat=settings.repeat(step) if outcome.state is State.FAILED else "",
        key=outcome.key,
        files=dict(run.cache.digest_of(step).files) if run.cache else {},
        also=also,
    )


def _sources(run: Run, fed: StepInput) -> Source | list[Source]:
    if isinstance(fed, Output):
        return _source(run, fed, {})
    return [
        _source(run, output, dict(zip(fed.axes, labels, strict=True)))
        for labels, output in fed.entries
    ]


def _source(run: Run, output: Output, labels: Mapping[str, Any]) -> Source:
    ports = run.plan.steps[output.step].method.node.outputs
    return Source(output.step, ports[output.position].name, plain(labels))


@cache
def _adapter() -> TypeAdapter[Record]:
    from pydantic import TypeAdapter

    return TypeAdapter(Record)


def read_record(path: Path) -> Record:
    """Return the record in a file.

    Raises
    ------
    NodegraphError
        If there is none, or none that this version can read.
    """
    from pydantic import ValidationError

    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except (FileNotFoundError, NotADirectoryError):
        raise NodegraphError(
            f"{path}: there is no finished run; run the graph, or name the folder of a run"
        ) from None
    except (OSError, ValueError, RecursionError) as error:
        raise NodegraphError(f"{path} cannot be read ({error}); run the graph again") from error
    written = data.get("format") if isinstance(data, dict) else FORMAT
    if written != FORMAT:
        raise NodegraphError(
            f"{path} is of format {written}, and only {FORMAT} can be read; run the graph again"
        )
    try:
        record = _adapter().validate_python(data)
    except ValidationError as error:
        fault = first_error(error, data)
    else:
        fault = next(_faults(record), "")
        if not fault:
            return record
    raise NodegraphError(f"{path} cannot be read ({fault}); run the graph again")


def _faults(record: Record) -> Iterator[str]:
    """Yield every reference of a record to something that it does not have."""
    for name, node in record.nodes.items():
        yield from (
            f"nodes.{name}: no axis {axis!r}" for axis in node.axes if axis not in record.axes
        )
    uses = {
        name: {method.use for method in node.methods.values()}
        for name, node in record.nodes.items()
    }
    steps = {step.step for step in record.steps}
    for index, step in enumerate(record.steps):
        here = f"steps.{index}"
        for cell in step.cells:
            yield from (f"{here}: {fault}" for fault in _faults_of_cell(cell, record))
        if step.use not in uses.get(step.node, ()):
            yield f"{here}: {step.node!r} has no method {step.use!r}"
        for port, sources in step.sources():
            for source in sources:
                if source.step not in steps:
                    yield f"{here}: inputs.{port}: no step {source.step}"
    for index, skipped in enumerate(record.skipped):
        unknown = sorted(skipped.counts.keys() - record.nodes.keys())
        yield from (f"skipped.{index}: no node {name!r}" for name in unknown)
    for index, shown in enumerate(record.not_shown):
        yield from (f"not_shown.{index}: {fault}" for fault in _faults_of_cell(shown, record))


def _faults_of_cell(cell: Cell | NotShown, record: Record) -> Iterator[str]:
    node = record.nodes.get(cell.node)
    if node is None:
        yield f"no node {cell.node!r}"
    elif cell.labels.keys() != set(node.axes):
        yield f"its labels are not those of {cell.node!r}: {', '.join(sorted(node.axes))}"

"""A run as plain data, for ``run.json``: what ran, with which settings, how it ended."""

from __future__ import annotations

import platform
import shlex
import sys
from collections.abc import Iterator, Mapping
from importlib.metadata import PackageNotFoundError, version
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from nodegraph.execute.call import Outcome
from nodegraph.execute.events import plain
from nodegraph.execute.results import Run
from nodegraph.graph import Graph, GraphNode
from nodegraph.plan import Output, Step, StepInput
from nodegraph.state import State
from nodegraph.validation import first_error

FORMAT = 1
_LIBRARIES = ("nodegraph", "numpy", "scipy", "pandas", "numba", "scikit-learn", "matplotlib")


def record(run: Run, command: str) -> dict[str, Any]:
    """Return everything about a run but its values; `command` runs it again."""
    graph = run.plan.graph
    return {
        "format": FORMAT,
        "command": command,
        "folder": str(graph.choices.folder.absolute()),
        "plugins": _plugin_files(graph),
        "title": graph.title,
        "included": dict(graph.spec.included),
        "inputs": plain(graph.inputs),
        "axes": {name: list(axis.labels) for name, axis in graph.axes.items()},
        "nodes": {name: _node(node) for name, node in graph.nodes.items()},
        "code": _code(run),
        "known": [str(one) for one in graph.spec.known],
        "left_out": [{"node": one, "reason": why} for one, why in graph.reasons_left_out().items()],
        "counts": run.counts(),
        "seconds": round(run.seconds, 6),
        "not_kept": dict(run.cache.not_stored) if run.cache else {},
        "steps": _steps(run, command),
        "skipped": _skipped(run),
        "versions": versions(graph),
    }


def versions(graph: Graph) -> dict[str, str]:
    """Return the versions of Python, of the libraries and of the plugins that took part."""
    plugins = {
        method.distribution for node in graph.nodes.values() for method in node.methods.values()
    }
    brought = dict(one.rsplit(" ", 1) for one in sorted(plugins) if one)
    found = {name: _version(name) for name in _LIBRARIES}
    return {
        "python": sys.version.split()[0],
        "platform": f"{platform.system()} {platform.machine()}",
        **{name: one for name, one in found.items() if one},
        **brought,
    }


def _plugin_files(graph: Graph) -> list[dict[str, str]]:
    """Return the plugin files that were named, with the SHA-256 of what was imported."""
    return [
        {"path": str(one.module.__file__), "sha256": one.digest}
        for one in graph.registry.loaded
        if one.digest
    ]


def _node(node: GraphNode) -> dict[str, Any]:
    return {
        "axes": list(node.axes),
        "gathered": list(node.gathered),
        "methods": {
            label or node.first.node.name: {
                "use": method.node.name,
                "plugin": method.plugin,
                "outputs": [port.name for port in method.node.outputs],
            }
            for label, method in node.methods.items()
        },
    }


def repeating(command: str, step: Step) -> str:
    """Return the command that repeats one step alone; what feeds it comes from the store."""
    only = (f" --only {shlex.quote(f'{axis}={label}')}" for axis, label in step.labels.items())
    return f"{command}{''.join(only)} --until {shlex.quote(step.node)}"


def _code(run: Run) -> dict[str, Any]:
    """Return what each method's code reaches, by plugin and name."""
    if run.cache is None:
        return {}
    reached = {
        f"{step.method.plugin}:{step.method.node.name}": run.cache.digest_of(step).code
        for step in run.plan.steps
    }
    return {
        name: {"units": dict(one.units), "versions": dict(one.versions)}
        for name, one in reached.items()
    }


def _steps(run: Run, command: str) -> list[dict[str, Any]]:
    shared = _shared(run)
    return [
        _step(run, step, outcome, command) | shared.get(step.index, {})
        for step, outcome in run.settled()
    ]


def _shared(run: Run) -> dict[int, dict[str, Any]]:
    """Return the other combinations of steps that stand for several: equal work is done once."""
    others: dict[int, list[dict[str, Any]]] = {}
    for name, cells in run.plan.cells.items():
        axes = run.plan.graph.nodes[name].axes
        for combination, index in cells.items():
            labels = dict(zip(axes, combination, strict=True))
            step = run.plan.steps[index]
            if (step.node, step.labels) != (name, labels):
                others.setdefault(index, []).append({"node": name, "labels": plain(labels)})
    return {index: {"also": found} for index, found in others.items()}


def _step(run: Run, step: Step, outcome: Outcome, command: str) -> dict[str, Any]:
    made: dict[str, Any] = {
        "step": step.index,
        "node": step.node,
        "use": step.method.node.name,
        "labels": plain(step.labels),
        "settings": {name: plain(value) for name, value in step.shown.items()},
        "inputs": {port: _needs(run, fed) for port, fed in step.inputs.items()},
        "state": outcome.state,
        "seconds": round(outcome.seconds, 6),
    }
    said: dict[str, Any] = {
        "stored": outcome.stored,
        "reason": outcome.reason,
        "place": outcome.place,
        "trace": outcome.trace,
        "warnings": list(outcome.warnings),
        "digests": list(outcome.digests),
        "repeat": repeating(command, step) if outcome.state is State.FAILED else "",
    }
    if run.cache is not None:
        said["key"] = outcome.key
        said["files"] = dict(run.cache.digest_of(step).files)
    return made | {key: one for key, one in said.items() if one}


def _needs(run: Run, fed: StepInput) -> Any:
    """Return which outputs of which steps feed a port, with their labels where it gathers."""
    if isinstance(fed, Output):
        return _output(run, fed)
    return [
        {"labels": plain(dict(zip(fed.axes, at, strict=True))), **_output(run, one)}
        for at, one in fed.entries
    ]


def _output(run: Run, output: Output) -> dict[str, Any]:
    ports = run.plan.steps[output.step].method.node.outputs
    return {"step": output.step, "output": ports[output.position].name}


def _skipped(run: Run) -> list[Mapping[str, Any]]:
    return [
        {"node": name, "labels": dict(zip(node.axes, at, strict=True)), "reason": reason}
        for name, node in run.plan.graph.nodes.items()
        for at, reason in run.plan.skipped[name].items()
    ]


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return ""


_Label = Annotated[str | int | float | bool, Field(union_mode="left_to_right")]
_Labels = dict[str, _Label]


class _Part(BaseModel):
    model_config = ConfigDict(strict=True)


_Kind = TypeVar("_Kind", bound=_Part)


class _Plugin(_Part):
    path: Annotated[str, Field(min_length=1)]
    sha256: str


class _Method(_Part):
    use: str
    plugin: str
    outputs: Annotated[list[str], Field(min_length=1)]


class _Node(_Part):
    axes: list[str]
    gathered: list[str]
    methods: dict[str, _Method]


class _Code(_Part):
    units: dict[str, str]
    versions: dict[str, str]


class _LeftOut(_Part):
    node: str
    reason: str


class _Cell(_Part):
    node: str
    labels: _Labels


class _Skipped(_Cell):
    reason: str


class _Source(_Part):
    step: int
    output: str
    labels: _Labels = {}


class _Step(_Cell):
    step: int
    use: str
    settings: dict[str, Any]
    inputs: dict[str, _Source | list[_Source]]
    state: Literal["done", "refused", "failed", "skipped", "unneeded"]
    seconds: float
    stored: bool = False
    reason: str = ""
    place: str = ""
    trace: str = ""
    warnings: list[str] = []
    digests: list[str] = []
    repeat: str = ""
    key: Annotated[str, Field(pattern="^[0-9a-f]{64}$")] = "0" * 64
    files: dict[str, str] = {}
    also: list[_Cell] = []


class _Record(_Part):
    command: str
    folder: Annotated[str, Field(min_length=1)]
    plugins: list[_Plugin]
    title: str
    included: dict[str, str]
    inputs: dict[str, Any]
    axes: dict[str, list[_Label]]
    nodes: dict[str, _Node]
    code: dict[str, _Code]
    known: list[str]
    left_out: list[_LeftOut]
    counts: dict[str, int]
    seconds: float
    not_kept: dict[str, int]
    steps: list[Any]
    skipped: list[_Skipped]
    versions: dict[str, str]


def misfit(data: Mapping[str, Any]) -> str:
    """Return which key of a record is first of another form than it is written in, and how.

    Parameters
    ----------
    data
        As read from JSON.

    Returns
    -------
    str
        ``steps.3.state: field required``; empty if all is well.
    """
    record, wrong = _read(_Record, data, ())
    return wrong if record is None else next(_at_odds(record), "")


def _read(kind: type[_Kind], data: Any, at: tuple[int | str, ...]) -> tuple[_Kind | None, str]:
    """Return data in their form, or what of them has another one."""
    try:
        return kind.model_validate(data), ""
    except ValidationError as error:
        return None, first_error(error, data, at)


def _at_odds(record: _Record) -> Iterator[str]:
    """Yield what is no step, and what a record says of something that it does not have."""
    if not _is_command(record.command):
        yield f"command: it runs no graph: {record.command}"
    for name, node in record.nodes.items():
        yield from (f"nodes.{name}: no axis {one!r}" for one in node.axes if one not in record.axes)
    there = _There(record)
    for at, data in enumerate(record.steps):
        # one after the other: all at once, they take more memory than what they are read from
        step, wrong = _read(_Step, data, ("steps", at))
        faults = there.faults(step) if step is not None else ()
        yield from [wrong] if wrong else (f"steps.{at}: {said}" for said in faults)
    for at, one in enumerate(record.skipped):
        yield from (f"skipped.{at}: {said}" for said in there.faults_of_cell(one))


def _is_command(text: str) -> bool:
    try:
        return shlex.split(text)[:2] == ["nodegraph", "run"] and len(shlex.split(text)) > 2
    except ValueError:
        return False


class _There:
    """What steps can refer to."""

    def __init__(self, record: _Record) -> None:
        self._axes = {name: set(one.axes) for name, one in record.nodes.items()}
        self._uses = {
            name: {method.use for method in one.methods.values()}
            for name, one in record.nodes.items()
        }
        numbers = (one.get("step") for one in record.steps if isinstance(one, Mapping))
        self._steps = {one for one in numbers if isinstance(one, int)}

    def faults(self, step: _Step) -> Iterator[str]:
        for cell in (step, *step.also):
            yield from self.faults_of_cell(cell)
        if step.use not in self._uses[step.node]:
            yield f"{step.node!r} has no method {step.use!r}"
        for port, fed in step.inputs.items():
            for one in fed if isinstance(fed, list) else [fed]:
                if one.step not in self._steps:
                    yield f"inputs.{port}: no step {one.step}"

    def faults_of_cell(self, cell: _Cell) -> Iterator[str]:
        axes = self._axes.get(cell.node)
        if axes is None:
            yield f"no node {cell.node!r}"
        elif cell.labels.keys() != axes:
            yield f"its labels are not those of {cell.node!r}: {', '.join(sorted(axes))}"

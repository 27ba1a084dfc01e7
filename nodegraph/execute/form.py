"""The form that the record of a run has, checked once where ``run.json`` is read."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from nodegraph.misfit import first_misfit

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
        return None, first_misfit(error, data, at)


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

"""The record of a run as files: ``run.json``, and one line per step in ``steps.jsonl.gz``.

A run may have a hundred thousand steps. Apart, they leave ``run.json`` small, and neither is ever
whole in memory as text.
"""

from __future__ import annotations

import gzip
import json
import zlib
from collections.abc import Iterable, Iterator
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

from nodegraph.errors import NodegraphError
from nodegraph.runs.folder import RECORD, STEPS, content_of, lines_of, missing
from nodegraph.runs.record import FORMAT, Cell, NotShown, Record, RecordedStep
from nodegraph.validation_errors import adapter_of, first_error


def record_bytes(record: Record) -> bytes:
    """Return the content of ``run.json``: the record without its steps."""
    # pydantic cannot write names of files that are not valid text; the escapes of JSON can
    data = adapter_of(Record).dump_python(record, exclude={"steps"}, exclude_defaults=True)
    return f"{json.dumps(data, indent=1)}\n".encode()


def steps_bytes(steps: Iterable[RecordedStep]) -> bytes:
    """Return the content of ``steps.jsonl.gz``: a line of JSON per step, compressed."""
    dump = adapter_of(RecordedStep).dump_python
    content = BytesIO()
    # level 6 takes ten times as long for a tenth less
    with gzip.GzipFile(fileobj=content, mode="wb", compresslevel=3, mtime=0) as file:
        for step in steps:
            file.write(f"{json.dumps(dump(step, exclude_defaults=True))}\n".encode())
    return content.getvalue()


def read_record(folder: Path) -> Record:
    """Return the record in the folder of a run.

    Raises
    ------
    NodegraphError
        If there is none, or none that this version can read.
    """
    path = folder / RECORD
    try:
        data = json.loads(content_of(path))
    except (FileNotFoundError, NotADirectoryError):
        raise missing(path) from None
    except (OSError, ValueError, RecursionError) as error:
        raise _unreadable(path, error) from error
    written = data.get("format") if isinstance(data, dict) else FORMAT
    if written != FORMAT:
        raise NodegraphError(
            f"{path} is of format {written}, and only {FORMAT} can be read; run the graph again"
        )
    record: Record = _validated(Record, data, path)
    for fault in _faults(record):
        raise _unreadable(path, fault)
    record = replace(record, steps=_read_steps(folder / STEPS))
    for fault in _faults_of_steps(record):
        raise _unreadable(folder / STEPS, fault)
    return record


def _read_steps(path: Path) -> list[RecordedStep]:
    steps: list[RecordedStep] = []
    try:
        for number, line in enumerate(lines_of(path), 1):
            steps.append(_validated(RecordedStep, json.loads(line), path, f"line {number}"))
    except FileNotFoundError:
        raise missing(path) from None
    except (OSError, EOFError, zlib.error, ValueError, RecursionError) as error:
        raise _unreadable(path, error) from error
    return steps


def _validated(kind: type, data: object, path: Path, *at: str) -> Any:
    from pydantic import ValidationError

    try:
        return adapter_of(kind).validate_python(data)
    except ValidationError as error:
        raise _unreadable(path, first_error(error, data, at)) from error


def _unreadable(path: Path, reason: object) -> NodegraphError:
    return NodegraphError(f"{path} cannot be read ({reason}); run the graph again")


def _faults(record: Record) -> Iterator[str]:
    """Yield every reference of a record to something that it does not have."""
    for name, node in record.nodes.items():
        yield from (
            f"nodes.{name}: no axis {axis!r}" for axis in node.axes if axis not in record.axes
        )
    for index, skipped in enumerate(record.skipped):
        unknown = sorted(skipped.counts.keys() - record.nodes.keys())
        yield from (f"skipped.{index}: no node {name!r}" for name in unknown)
    for index, shown in enumerate(record.not_shown):
        yield from (f"not_shown.{index}: {fault}" for fault in _faults_of_cell(shown, record))


def _faults_of_steps(record: Record) -> Iterator[str]:
    uses = {
        name: {method.use for method in node.methods.values()}
        for name, node in record.nodes.items()
    }
    steps = {step.step for step in record.steps}
    for line, step in enumerate(record.steps, 1):
        here = f"line {line}"
        for cell in step.cells:
            yield from (f"{here}: {fault}" for fault in _faults_of_cell(cell, record))
        if step.use not in uses.get(step.node, ()):
            yield f"{here}: {step.node!r} has no method {step.use!r}"
        for port, sources in step.sources():
            for source in sources:
                if source.step not in steps:
                    yield f"{here}: inputs.{port}: no step {source.step}"


def _faults_of_cell(cell: Cell | NotShown, record: Record) -> Iterator[str]:
    node = record.nodes.get(cell.node)
    if node is None:
        yield f"no node {cell.node!r}"
    elif cell.labels.keys() != set(node.axes):
        yield f"its labels are not those of {cell.node!r}: {', '.join(sorted(node.axes))}"

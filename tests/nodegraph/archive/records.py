from __future__ import annotations

from dataclasses import replace
from typing import Any

from nodegraph.execute.settings import RunSettings
from nodegraph.runs.record import FORMAT, Record

_EMPTY = Record(
    format=FORMAT,
    command="nodegraph run g.yaml",
    settings=RunSettings("g.yaml"),
    folder="/",
    plugins=[],
    title="",
    included={},
    inputs={},
    axes={},
    nodes={},
    code={},
    units={},
    known=[],
    left_out=[],
    counts={},
    seconds=0.0,
    steps=[],
    skipped=[],
    versions={},
)


def record_with(**parts: Any) -> Record:
    """Return the record of a run without steps, with these parts."""
    return replace(_EMPTY, **parts)

"""Whether a lock is one of the run beside which an archive would put it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path, PurePath
from typing import Any

from nodegraph.errors import NodegraphError, listed
from nodegraph.paper.frozen.lock import read_lock


def why_not(path: Path, graph: str, text: str, record: Mapping[str, Any]) -> str:
    """Return why a lock does not belong to a run; empty if it does.

    Parameters
    ----------
    path
        Of the lock.
    graph, text
        Name and text of the graph file that ran.
    record
        As ``run.json`` holds it.
    """
    try:
        data = read_lock(path).data
    except NodegraphError as error:
        return str(error)
    if data["text"] != {graph: text, **record["included"]}:
        return f"{path}: it froze another graph than this run's, or another text of it"
    if data["graph"] != graph:
        return f"{path}: it was written to lie elsewhere than beside {graph}"
    for part, was, now in (
        ("inputs", data["inputs"], record["inputs"]),
        ("axes", _labels(data), _labels(record)),
    ):
        other = [
            name for name in {**was, **now} if _by_name(was.get(name)) != _by_name(now.get(name))
        ]
        if other:
            return f"{path}: it froze other {part} than this run's: {listed(other)}"
    return ""


def _labels(data: Mapping[str, Any]) -> dict[str, list[Any]]:
    return {name: list(labels) for name, labels in data["axes"].items()}


def _by_name(value: Any) -> Any:
    """Return a value in which a file is its name alone, as a lock has other folders."""
    if isinstance(value, list):
        return [_by_name(one) for one in value]
    if isinstance(value, Mapping):
        return {str(name): _by_name(one) for name, one in value.items()}
    return PurePath(value).name if isinstance(value, str) else str(value)

"""ewokscore: tasks and links as plain data, executed in sequence."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from tests.benchmarks.work import Build, Run, Work


def ewokscore(work: Work, count: int) -> Build:
    library: Any = pytest.importorskip("ewokscore")
    written = _written(work, count)

    def build() -> Run:
        graph = library.load_graph(written)
        return lambda: library.execute_graph(graph)["return_value"]

    return build


def _written(work: Work, count: int) -> dict[str, object]:
    mapping = [{"source_output": "return_value", "target_input": "value"}]
    tasks = [work.first, *[work.step] * count]
    return {
        "graph": {"id": "chain"},
        "nodes": [
            {"id": f"n{at}", "task_type": "method", "task_identifier": _identifier(task)}
            for at, task in enumerate(tasks)
        ],
        "links": [
            {"source": f"n{at}", "target": f"n{at + 1}", "data_mapping": mapping}
            for at in range(count)
        ],
    }


def _identifier(task: Callable[..., object]) -> str:
    return f"{task.__module__}.{task.__qualname__}"

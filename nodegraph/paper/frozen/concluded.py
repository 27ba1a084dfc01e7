"""What the reported values of a run say: their conclusions, and their numbers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from nodegraph.display import name_at
from nodegraph.execute import Run
from nodegraph.hooks import Conclusion


@dataclass(frozen=True)
class Said:
    """What one reported value says.

    Attributes
    ----------
    name : str
        The node, its output where it has several, its labels where there are some.
    sentences : tuple of str
    numbers : str
        As CSV.
    """

    name: str
    sentences: tuple[str, ...]
    numbers: str


def said_by(run: Run) -> Iterator[Said]:
    """Yield what each reported value says; those of which no plugin knows it are left out."""
    graph = run.plan.graph
    for node, port in graph.reported:
        outputs = graph.nodes[node].outputs
        for output in [port] if port else outputs:
            for labels, value in run[f"{node}.{output}"].shown():
                kind = _kind(value, graph.registry.conclusions)
                if kind is not None:
                    name = f"{node}.{output}" if len(outputs) > 1 else node
                    full = name_at(name, labels)
                    yield Said(full, tuple(map(str, kind.conclude(value))), kind.numbers(value))


def _kind(value: Any, conclusions: tuple[Conclusion, ...]) -> Conclusion | None:
    return next((one for one in conclusions if isinstance(value, one.type)), None)

"""Timeflux: a chain of nodes, a cycle of its scheduler per frame, without its waiting between them.

Its releases name old versions of what nodegraph needs too; it runs with those of today:
``pip install --no-deps timeflux``.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pandas as pd
import pytest

graph: Any = pytest.importorskip("timeflux.core.graph")
Node: Any = pytest.importorskip("timeflux.core.node").Node
Scheduler: Any = pytest.importorskip("timeflux.core.scheduler").Scheduler


class Same(Node):  # type: ignore[misc, unused-ignore]
    """Hand on each frame."""

    def update(self) -> None:
        """Take what came in for what goes out."""
        self.o.data = self.i.data


class Source(Node):  # type: ignore[misc, unused-ignore]
    """Give a frame in each cycle."""

    def __init__(self) -> None:
        self._frame = pd.DataFrame(np.zeros((1, 180)))

    def update(self) -> None:
        """Give the frame."""
        self.o.data = self._frame


class Count(Node):  # type: ignore[misc, unused-ignore]
    """Count what arrives."""

    def __init__(self) -> None:
        self.count = 0

    def update(self) -> None:
        """Count a frame."""
        self.count += self.i.ready()


def timeflux_chain(nodes: int, frames: int) -> Callable[[], int]:
    """Return what sends frames through nodes that do nothing, and counts those that arrive."""
    names = ["source", *(f"n{number}" for number in range(nodes)), "count"]
    edges = [{"source": before, "target": after} for before, after in pairwise(names)]
    path = graph.Graph({"nodes": [{"id": name} for name in names], "edges": edges}).traverse()

    def run() -> int:
        count = Count()
        instances = {"source": Source(), **{name: Same() for name in names[1:-1]}, "count": count}
        scheduler = Scheduler(path, instances, rate=0)
        for _ in range(frames):
            scheduler.next()
        return count.count

    return run

"""csp: a chain of Python nodes on simulated time, a tick per frame."""

from collections.abc import Callable
from datetime import datetime, timedelta
from typing import Any

import numpy as np
import pytest

csp: Any = pytest.importorskip("csp")  # its nodes are compiled from source that names it
ts: Any = csp.ts


@csp.node  # type: ignore[untyped-decorator, unused-ignore]
def same(frame: ts[object]) -> ts[object]:
    """Hand on each frame."""
    if csp.ticked(frame):
        return frame


def csp_chain(nodes: int, frames: int) -> Callable[[], int]:
    """Return what sends frames through nodes that do nothing, and counts those that arrive."""

    @csp.graph  # type: ignore[untyped-decorator, unused-ignore]
    def chain() -> None:
        frame = csp.timer(timedelta(microseconds=1), np.zeros((60, 3)))
        for _ in range(nodes):
            frame = same(frame)
        csp.add_graph_output("count", csp.count(frame), tick_count=1)

    def run() -> int:
        end = timedelta(microseconds=frames)
        ((_, count),) = csp.run(chain, starttime=datetime(2026, 1, 1), endtime=end)["count"]
        return int(count)

    return run

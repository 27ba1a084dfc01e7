"""ezmsg: a chain of units in one process."""

from __future__ import annotations

import time
from collections.abc import AsyncGenerator, Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

ez: Any = pytest.importorskip("ezmsg.core")


class Same(ez.Unit):  # type: ignore[misc, unused-ignore]
    """Hand on each frame."""

    INPUT = ez.InputStream(object)
    OUTPUT = ez.OutputStream(object)

    @ez.subscriber(INPUT)  # type: ignore[untyped-decorator, unused-ignore]
    @ez.publisher(OUTPUT)  # type: ignore[untyped-decorator, unused-ignore]
    async def same(self, frame: object) -> AsyncGenerator[object, None]:
        """Hand on a frame."""
        yield self.OUTPUT, frame


def ezmsg_chain(nodes: int, frames: int) -> Callable[[], tuple[int, float]]:
    """Return what sends frames through units that do nothing.

    It returns how many arrive, and the seconds from the first of them to the last: processes,
    servers and connections are up by then.
    """
    arrivals: list[float] = []

    class Source(ez.Unit):  # type: ignore[misc, unused-ignore]
        OUTPUT = ez.OutputStream(object)

        @ez.publisher(OUTPUT)  # type: ignore[untyped-decorator, unused-ignore]
        async def send(self) -> AsyncGenerator[object, None]:
            frame = np.zeros((60, 3))
            for _ in range(frames):
                yield self.OUTPUT, frame

    class Count(ez.Unit):  # type: ignore[misc, unused-ignore]
        INPUT = ez.InputStream(object)

        @ez.subscriber(INPUT)  # type: ignore[untyped-decorator, unused-ignore]
        async def count(self, frame: object) -> None:
            arrivals.append(time.perf_counter())
            if len(arrivals) == frames:
                raise ez.NormalTermination

    def run() -> tuple[int, float]:
        arrivals.clear()
        units: dict[str, Any] = {
            "source": Source(),
            **{f"n{k}": Same() for k in range(nodes)},
            "count": Count(),
        }
        wires = [(a.OUTPUT, b.INPUT) for a, b in pairwise(units.values())]
        ez.run(units, connections=wires, force_single_process=True)
        return len(arrivals), arrivals[-1] - arrivals[0]

    return run

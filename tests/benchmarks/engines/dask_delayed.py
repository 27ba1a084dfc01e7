"""dask: delayed calls, computed by the synchronous scheduler."""

from __future__ import annotations

from typing import Any

import pytest

from tests.benchmarks.work import Build, Run, Work


def dask(work: Work, count: int) -> Build:
    delayed: Any = pytest.importorskip("dask").delayed

    def build() -> Run:
        first, step = delayed(work.first), delayed(work.step)
        last = first()
        for _ in range(count):
            last = step(last)
        return lambda: last.compute(scheduler="synchronous")

    return build

"""joblib.Memory: a loop of calls whose results are found on disk."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.benchmarks.work import Build, Engine, Run, Work


def joblib(folder: Path) -> Engine:
    """Return the engine that keeps its results in a folder; the first run fills it."""

    def prepare(work: Work, count: int) -> Build:
        library: Any = pytest.importorskip("joblib")

        def build() -> Run:
            memory = library.Memory(folder, verbose=0)
            first, step = memory.cache(work.first), memory.cache(work.step)

            def run() -> object:
                value = first()
                for _ in range(count):
                    value = step(value)
                return value

            return run

        return build

    return prepare

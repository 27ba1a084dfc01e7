"""pipefunc: functions that name their inputs and outputs, called through a pipeline."""

from __future__ import annotations

from typing import Any

import pytest

from tests.benchmarks.work import Build, Run, Work


def pipefunc(work: Work, count: int) -> Build:
    library: Any = pytest.importorskip("pipefunc")

    def build() -> Run:
        functions = [library.PipeFunc(work.first, "n0")]
        for at in range(count):
            renames = {"value": f"n{at}"}
            functions.append(library.PipeFunc(work.step, f"n{at + 1}", renames=renames))
        pipeline = library.Pipeline(functions)
        return lambda: pipeline(f"n{count}")

    return build

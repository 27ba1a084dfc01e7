"""Kedro: a pipeline of nodes, run by its sequential runner with everything in memory."""

from __future__ import annotations

import logging
from typing import Any

import pytest

from tests.benchmarks.work import Build, Run, Work


def kedro(work: Work, count: int) -> Build:
    pipelines: Any = pytest.importorskip("kedro.pipeline")
    io: Any = pytest.importorskip("kedro.io")
    runner: Any = pytest.importorskip("kedro.runner")
    logging.getLogger("kedro").setLevel(logging.ERROR)  # a line per node is not its work

    def build() -> Run:
        nodes = [pipelines.node(work.first, None, "n0")]
        for at in range(count):
            nodes.append(pipelines.node(work.step, f"n{at}", f"n{at + 1}", name=f"to_n{at + 1}"))
        result = pipelines.pipeline(nodes)

        def run() -> object:
            return runner.SequentialRunner().run(result, io.DataCatalog())[f"n{count}"].load()

        return run

    return build

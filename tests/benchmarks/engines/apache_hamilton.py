"""Apache Hamilton: functions whose arguments name what feeds them."""

from __future__ import annotations

import linecache
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from tests.benchmarks.work import Build, Engine, Run, Work

_FILE = "<chain of functions>"


def hamilton(work: Work, count: int) -> Build:
    driver: Any = pytest.importorskip("hamilton.driver")
    module = _module(work, count)

    def build() -> Run:
        result = driver.Builder().with_modules(module).build()
        return lambda: result.execute([f"n{count}"])[f"n{count}"]

    return build


def hamilton_cached(folder: Path) -> Engine:
    """Return the engine that keeps its results in a folder; the first run fills it."""

    def prepare(work: Work, count: int) -> Build:
        driver: Any = pytest.importorskip("hamilton.driver")
        module, last = _module(work, count), f"n{count}"

        def build() -> Run:
            # a driver of its own for each run, as in a second process
            written = driver.Builder().with_modules(module).with_cache(path=str(folder))
            return lambda: written.copy().build().execute([last])[last]

        return build

    return prepare


def _module(work: Work, count: int) -> ModuleType:
    """Return a module of one function per node, as its author would have written them."""
    utilities: Any = pytest.importorskip("hamilton.ad_hoc_utils")
    lines = ["def n0() -> kind: return first()"]
    lines += [f"def n{at + 1}(n{at}: kind) -> kind: return step(n{at})" for at in range(count)]
    names: dict[str, object] = {"kind": work.kind, "first": work.first, "step": work.step}
    exec(compile(_readable(lines), _FILE, "exec"), names)
    module: ModuleType = utilities.create_temporary_module(
        *(names[f"n{at}"] for at in range(count + 1))
    )
    return module


def _readable(lines: list[str]) -> str:
    """Return the lines as one text, and let its functions' source be found: caching hashes it."""
    text = "\n".join(lines)
    linecache.cache[_FILE] = (len(text), None, text.splitlines(keepends=True), _FILE)
    return text

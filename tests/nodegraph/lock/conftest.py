"""A run of toy nodes with its lock."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from nodegraph.execute.results import Run
from nodegraph.lock.lockfile import Lock, lock_text, read_lock

TEXT = """
inputs: {start: 40}
axes: {length: [3, 7]}
nodes:
  a: {use: read.number, with: {start: $start}}
  cut: {use: gaps.cut, in: a, with: {length: $length}}
  fill: {in: cut, alternatives: fill.*}
"""


class Frozen(NamedTuple):
    run: Run
    lock: Lock
    path: Path


@pytest.fixture
def freeze(run_of: Callable[..., Run], tmp_path: Path) -> Callable[[str], Frozen]:
    """Run a graph, and lock it."""

    def call(text: str) -> Frozen:
        run = run_of(text, store=tmp_path / "store")
        path = tmp_path / "toy.lock"
        path.write_text(lock_text(run, path))
        return Frozen(run, read_lock(path), path)

    return call


@pytest.fixture
def frozen(freeze: Callable[[str], Frozen]) -> Frozen:
    """A run and its lock."""
    return freeze(TEXT)

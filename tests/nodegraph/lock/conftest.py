"""A run of toy nodes with its lock."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from nodegraph.execute import Run
from nodegraph.lock.lockfile import Lock, lock_text, read_lock

TEXT = """
inputs: {start: 40}
axes: {length: [3, 7]}
nodes:
  a: {use: read.number, with: {start: $start}}
  cut: {use: gaps.cut, in: a, with: {length: $length}}
  fill: {in: cut, alternatives: fill.*}
"""


@pytest.fixture
def frozen(run_of: Callable[..., Run], tmp_path: Path) -> tuple[Run, Lock]:
    """A run and its lock."""
    run = run_of(TEXT, store=tmp_path / "store")
    path = tmp_path / "toy.lock"
    path.write_text(lock_text(run, path))
    return run, read_lock(path)

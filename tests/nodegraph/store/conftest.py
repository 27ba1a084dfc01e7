"""A store in a new folder, and ways to look at its files."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from nodegraph.store import Packer, Store


@pytest.fixture
def messages() -> list[str]:
    """What the store has reported."""
    return []


@pytest.fixture
def store(tmp_path: Path, messages: list[str]) -> Store:
    return Store(tmp_path / "store", Packer(), messages.append)


@pytest.fixture
def files(tmp_path: Path) -> Callable[..., list[Path]]:
    """List the files of a part of the store."""
    root = tmp_path / "store" / "format-2"
    return lambda part="": sorted(value for value in (root / part).rglob("*") if value.is_file())


@pytest.fixture
def age() -> Callable[[Path, float], None]:
    """Make a file so many seconds older."""

    def make_older(path: Path, seconds: float) -> None:
        status = path.stat()
        os.utime(path, (status.st_atime - seconds, status.st_mtime - seconds))

    return make_older

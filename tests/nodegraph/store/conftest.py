"""A store in a new folder, and ways to look at its files."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from nodegraph.store import Packer, Store


@pytest.fixture
def said() -> list[str]:
    """What the store had to say."""
    return []


@pytest.fixture
def store(tmp_path: Path, said: list[str]) -> Store:
    return Store(tmp_path / "store", Packer(), said.append)


@pytest.fixture
def files(tmp_path: Path) -> Callable[..., list[Path]]:
    """List the files of a part of the store."""
    root = tmp_path / "store" / "format-1"
    return lambda part="": sorted(one for one in (root / part).rglob("*") if one.is_file())


@pytest.fixture
def age() -> Callable[[Path, float], None]:
    """Make a file so many seconds older."""

    def make_older(path: Path, seconds: float) -> None:
        status = path.stat()
        os.utime(path, (status.st_atime - seconds, status.st_mtime - seconds))

    return make_older

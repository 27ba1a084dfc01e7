"""What was read once is remembered, as long as it holds."""

from __future__ import annotations

import ast
import json
import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from nodegraph.cache_key import Code, Reached

from .conftest import Folder

FILES = {
    "tools.py": "def walk(x): return x\ndef other(x): return 1",
    "fills.py": "import numpy as np\nimport tools\ndef fill(x): return tools.walk(np.sum(x))",
}


@pytest.fixture
def fill(folder: Folder) -> Callable[..., object]:
    """A function whose files were written long ago."""
    folder.write(FILES)
    for name in FILES:
        age(folder.path / name, seconds=100)
    return folder.function("fills:fill")


def age(file: Path, *, seconds: float) -> None:
    when = time.time_ns() - int(seconds * 1e9)
    os.utime(file, ns=(when, when))


def remember(function: Callable[..., object]) -> tuple[Reached, dict[str, Any]]:
    code = Code([])
    reached = code.of(function)
    remembered = json.loads(json.dumps(code.remembered()))
    assert isinstance(remembered, dict)
    return reached, remembered


def test_nothing_is_read_again(
    folder: Folder, fill: Callable[..., object], monkeypatch: pytest.MonkeyPatch
) -> None:
    reached, remembered = remember(fill)
    again = Code([], remembered)
    monkeypatch.setattr(ast, "parse", None)
    assert again.of(fill) == reached
    assert again.remembered() == remembered


def test_an_edited_file_is_read_again(folder: Folder, fill: Callable[..., object]) -> None:
    reached, remembered = remember(fill)
    folder.write({"tools.py": FILES["tools.py"].replace("return x", "return y")})
    age(folder.path / "tools.py", seconds=50)
    assert Code([], remembered).of(fill).digest != reached.digest


def test_an_edit_that_keeps_the_time_but_not_the_size(
    folder: Folder, fill: Callable[..., object]
) -> None:
    reached, remembered = remember(fill)
    file = folder.path / "tools.py"
    state = file.stat()
    folder.write({"tools.py": FILES["tools.py"].replace("return x", "return x + 1")})
    os.utime(file, ns=(state.st_atime_ns, state.st_mtime_ns))
    assert Code([], remembered).of(fill).digest != reached.digest


@pytest.mark.parametrize(
    "seconds", [0.5, -100, 50], ids=["in the same tick", "from the future", "put back"]
)
def test_an_edit_that_keeps_time_and_size(
    folder: Folder, fill: Callable[..., object], seconds: float
) -> None:
    file = folder.path / "tools.py"
    age(file, seconds=seconds)
    state = file.stat()
    reached, remembered = remember(fill)
    folder.write({"tools.py": FILES["tools.py"].replace("return x", "return y")})
    os.utime(file, ns=(state.st_atime_ns, state.st_mtime_ns))
    assert file.stat().st_size == state.st_size
    assert Code([], remembered).of(fill).digest != reached.digest


def test_what_another_version_remembered_is_left(
    folder: Folder, fill: Callable[..., object]
) -> None:
    reached, remembered = remember(fill)
    assert Code([], {"form": "other", "sources": 1}).of(fill) == reached
    assert Code([], {**remembered, "form": "other"}).remembered()["sources"] == {}

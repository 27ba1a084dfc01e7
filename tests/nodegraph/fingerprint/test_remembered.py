"""What was read once is remembered, as long as it holds."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from nodegraph.fingerprint import Code, Reached
from nodegraph.fingerprint import source as summary_module

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


@pytest.fixture
def parsed(monkeypatch: pytest.MonkeyPatch) -> list[bytes]:
    """The sources that were parsed."""
    sources: list[bytes] = []
    really = summary_module.summarise

    def summarise(source: bytes) -> object:
        sources.append(source)
        return really(source)

    monkeypatch.setattr(summary_module, "summarise", summarise)
    return sources


def age(file: Path, *, seconds: float) -> None:
    when = time.time_ns() - int(seconds * 1e9)
    os.utime(file, ns=(when, when))


def remember(function: Callable[..., object]) -> tuple[Reached, dict[str, Any]]:
    code = Code([])
    reached = code.of(function)
    remembered = json.loads(json.dumps(code.remembered()))
    assert isinstance(remembered, dict)
    return reached, remembered


def test_nothing_is_parsed_again(fill: Callable[..., object], parsed: list[bytes]) -> None:
    reached, remembered = remember(fill)
    assert len(parsed) == 2
    again = Code([], remembered)
    assert again.of(fill) == reached
    assert len(parsed) == 2
    assert again.remembered() == remembered


def test_an_edited_file_is_parsed_again(
    folder: Folder, fill: Callable[..., object], parsed: list[bytes]
) -> None:
    reached, remembered = remember(fill)
    folder.write({"tools.py": FILES["tools.py"].replace("return x", "return y")})
    age(folder.path / "tools.py", seconds=50)
    assert Code([], remembered).of(fill).digest != reached.digest
    assert len(parsed) == 3


def test_an_edit_that_keeps_the_time_but_not_the_size(
    folder: Folder, fill: Callable[..., object]
) -> None:
    reached, remembered = remember(fill)
    file = folder.path / "tools.py"
    state = file.stat()
    folder.write({"tools.py": FILES["tools.py"].replace("return x", "return x + 1")})
    os.utime(file, ns=(state.st_atime_ns, state.st_mtime_ns))
    assert Code([], remembered).of(fill).digest != reached.digest


def test_an_edit_in_the_same_tick(folder: Folder, fill: Callable[..., object]) -> None:
    file = folder.path / "tools.py"
    age(file, seconds=0.5)
    state = file.stat()
    reached, remembered = remember(fill)
    folder.write({"tools.py": FILES["tools.py"].replace("return x", "return y")})
    os.utime(file, ns=(state.st_atime_ns, state.st_mtime_ns))
    assert file.stat().st_size == state.st_size
    assert Code([], remembered).of(fill).digest != reached.digest


def test_a_file_from_the_future_is_not_remembered(
    folder: Folder, fill: Callable[..., object], parsed: list[bytes]
) -> None:
    age(folder.path / "tools.py", seconds=-100)
    _, remembered = remember(fill)
    parsed.clear()
    Code([], remembered).of(fill)
    assert len(parsed) == 1


@pytest.mark.parametrize("key", ["format", "python"])
def test_what_another_version_remembered_is_left(
    fill: Callable[..., object], parsed: list[bytes], key: str
) -> None:
    reached, remembered = remember(fill)
    parsed.clear()
    assert Code([], remembered | {key: "other"}).of(fill) == reached
    assert len(parsed) == 2


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_damage_is_left_out(fill: Callable[..., object], data: st.DataObject) -> None:
    reached, remembered = remember(fill)
    holder: Any = remembered
    while True:
        keys = list(holder) if isinstance(holder, dict) else list(range(len(holder)))
        key = data.draw(st.sampled_from(keys))
        inner = holder[key]
        if not isinstance(inner, (dict, list)) or not inner or data.draw(st.booleans()):
            break
        holder = inner
    holder[key] = data.draw(st.sampled_from([None, 0.5, [None]]))
    assert Code([], remembered).of(fill) == reached


def test_a_name_of_a_part_that_is_not_there_is_damage(fill: Callable[..., object]) -> None:
    reached, remembered = remember(fill)
    for entry in remembered["files"].values():
        summary = entry["summary"]
        summary["names"] = {name: [99] for name in summary["names"]}
    assert Code([], remembered).of(fill) == reached


@pytest.mark.parametrize("remembered", [None, {}, [], "text", {"format": 1}, {"files": 3}])
def test_what_is_no_memory_at_all(fill: Callable[..., object], remembered: Any) -> None:
    assert Code([], remembered).of(fill) == Code([]).of(fill)

"""Code that was edited after it was imported is not what its file says."""

from __future__ import annotations

import importlib
import os
import time
from pathlib import Path

import pytest

from nodegraph.cache_key import Code
from nodegraph.import_time import STARTED
from nodegraph.plugin import loading

TEXT = """
from nodegraph import node

@node("a.b")
def b(*, x: float = 1.0) -> float:
    return x
"""
HELPER = "def helper(x):\n    return x\n"
MAIN = "from stale_helper import helper\n\ndef f(x):\n    return helper(x)\n"
FUTURE = 10_000_000_000


@pytest.fixture(autouse=True)
def _begun(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("nodegraph.cache_key.functions.STARTED", STARTED)


def edited(path: Path, text: str) -> None:
    path.write_text(text)
    now = time.time_ns() + FUTURE
    os.utime(path, ns=(now, now))


def test_a_file_that_was_read_again_is_as_it_says(tmp_path: Path) -> None:
    path = tmp_path / "mine.py"
    path.write_text(TEXT)
    old = loading.from_file(path).module.b
    assert Code([]).of(old).unstable == ""
    edited(path, TEXT.replace("return x", "return x + 1"))
    assert "mine was edited after it was imported" in Code([]).of(old).unstable
    now = time.time_ns()
    os.utime(path, ns=(now, now))
    new = loading.from_file(path).module.b
    assert Code([]).of(new).unstable == ""


def test_an_edited_helper_that_is_imported_already_is_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    for name, text in (("stale_helper", HELPER), ("stale_main", MAIN)):
        path = tmp_path / f"{name}.py"
        path.write_text(text)
        os.utime(path, ns=(1, 1))
    function = importlib.import_module("stale_main").f
    assert Code([]).of(function).unstable == ""
    edited(tmp_path / "stale_helper.py", HELPER.replace("return x", "return -x"))
    assert "stale_helper was edited after it was imported" in Code([]).of(function).unstable

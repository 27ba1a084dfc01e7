"""Kernels without numba, so that a test can change their constants."""

from __future__ import annotations

from types import ModuleType

import pytest


def run_as_python(monkeypatch: pytest.MonkeyPatch, module: ModuleType) -> None:
    """Let all kernels of a module be the functions that they are written as."""
    for name, member in list(vars(module).items()):
        if hasattr(member, "py_func"):
            monkeypatch.setattr(module, name, member.py_func)

"""Small packages in a folder of their own, edited and read again."""

from __future__ import annotations

import importlib
import sys
import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import pytest

from nodegraph.cache_key import Code, Reached


@dataclass
class Folder:
    """A folder on Python's path, whose modules are imported anew each time they are asked for."""

    path: Path
    followed: Iterable[str] = ("nodegraph",)

    def write(self, files: Mapping[str, str]) -> None:
        for name, text in files.items():
            file = self.path / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(textwrap.dedent(text), encoding="utf-8")

    def function(self, where: str) -> Callable[..., object]:
        """Return ``module:name``, imported from the files as they are."""
        module, _, name = where.partition(":")
        self.forget()
        result: Callable[..., object] = getattr(importlib.import_module(module), name)
        return result

    def reached(self, where: str) -> Reached:
        """Return what a function reaches, as another process would."""
        return Code(self.followed).of(self.function(where))

    def forget(self) -> None:
        importlib.invalidate_caches()
        for name, module in list(sys.modules.items()):
            if str(self.path) in str(getattr(module, "__file__", "")):
                del sys.modules[name]

    def changes(self, where: str, files: Mapping[str, str]) -> set[str]:
        """Return the units that an edit changes, adds or takes away; checks the digest as well."""
        before = self.reached(where)
        self.write(files)
        after = self.reached(where)
        both = {*before.units, *after.units}
        changed = {name for name in both if before.units.get(name) != after.units.get(name)}
        versions = before.versions != after.versions
        assert (before.digest != after.digest) == bool(changed or versions)
        return changed


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Folder]:
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    monkeypatch.syspath_prepend(tmp_path)
    result = Folder(tmp_path)
    yield result
    result.forget()


@pytest.fixture(autouse=True)
def _just_begun(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the program begin after whatever the tests write and import."""
    monkeypatch.setattr("nodegraph.cache_key.functions.STARTED", 2**62)

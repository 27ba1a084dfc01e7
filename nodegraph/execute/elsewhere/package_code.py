"""The code of plugin packages as their files have it, to see whether another process has the same.

A worker lives long: it goes on with the code that it imported when the files have been edited
since, and its results would be kept as those of the new code.
"""

from __future__ import annotations

import hashlib
import re
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path

_IMPORTED = re.compile(rb"^\s*(?:from|import)\s+(\w+)", re.MULTILINE)

Package = tuple[str, tuple[str, ...]]
"""A digest of all files, and which others of the packages they import."""


def code_of(packages: Iterable[str]) -> dict[str, Package]:
    """Return the code of top-level packages that are imported; those without files are left out."""
    named = set(packages)
    found = {name: _package(name, named) for name in sorted(named)}
    return {name: code for name, code in found.items() if code[0]}


def reached(package: str, code: Mapping[str, Package]) -> set[str]:
    """Return a package and all that it imports, directly or not."""
    found: set[str] = set()
    pending = [package]
    while pending:
        name = pending.pop()
        if name in code and name not in found:
            found.add(name)
            pending.extend(code[name][1])
    return found


def _package(name: str, named: set[str]) -> Package:
    digest, imported, files = hashlib.sha256(), set[str](), _files(name)
    for relative, file in files:
        content = file.read_bytes()
        digest.update(f"{relative} {len(content)}\n".encode() + content)
        imported.update(one.decode() for one in _IMPORTED.findall(content))
    return digest.hexdigest() if files else "", tuple(sorted(imported & named - {name}))


def _files(name: str) -> list[tuple[str, Path]]:
    module = sys.modules.get(name)
    folders = [Path(one) for one in getattr(module, "__path__", ())]
    if not folders and getattr(module, "__file__", None):
        file = Path(str(getattr(module, "__file__", "")))
        return [(file.name, file)] if file.suffix == ".py" and file.is_file() else []
    inside = [(one, folder) for folder in folders for one in folder.rglob("*.py")]
    return sorted((file.relative_to(folder).as_posix(), file) for file, folder in inside)

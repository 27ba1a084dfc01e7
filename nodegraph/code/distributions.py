"""Which distribution brought a module, and its version, without reading more than needed."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from importlib import metadata
from typing import Any, NamedTuple

_NAME = re.compile(r"^Name:[ \t]*(.+?)[ \t]*$", re.MULTILINE)
_VERSION = re.compile(r"^Version:[ \t]*(.+?)[ \t]*$", re.MULTILINE)


class Owner(NamedTuple):
    """A distribution.

    Attributes
    ----------
    name, version : str
    """

    name: str
    version: str


class Distributions:
    """Looks up distributions.

    Parameters
    ----------
    remembered
        What `remembered` returned in an earlier process. A distribution of the same name and
        version brings the same modules, so its list of files need not be read again.
    """

    def __init__(self, remembered: Any = None) -> None:
        self._known = _owners(remembered)
        self._files: dict[str, list[tuple[Owner, str]]] = {}

    def owners(self, top: str, folder: str) -> list[Owner]:
        """Return the distributions in a folder that bring a top-level module."""
        known = self._known.get(top)
        if known and all(_is_there(owner, folder) for owner in known):
            return known
        named = metadata.distributions(name=top, path=[folder])
        found = [_owner(one) for one in named if _has(_files(one), top, ("/__init__.", "."))]
        if not found:
            found = [owner for owner, files in self._in(folder) if _has(files, top, "/.")]
        self._known[top] = found
        return found

    def version(self, name: str) -> str:
        """Return the version of the distribution of that name; empty when there is none."""
        try:
            return metadata.version(name)
        except (metadata.PackageNotFoundError, ValueError):
            return ""

    def remembered(self) -> dict[str, list[list[str]]]:
        """Return what was found, for a later process."""
        return {
            top: [[one.name, one.version] for one in owners] for top, owners in self._known.items()
        }

    def _in(self, folder: str) -> list[tuple[Owner, str]]:
        if folder not in self._files:
            every = metadata.distributions(path=[folder])
            self._files[folder] = [(_owner(one), _files(one)) for one in every]
        return self._files[folder]


def _is_there(owner: Owner, folder: str) -> bool:
    found = metadata.distributions(name=owner.name, path=[folder])
    return any(_owner(one) == owner for one in found)


def _has(files: str, top: str, ends: Iterable[str]) -> bool:
    return any(f"\n{top}{end}" in files for end in ends)


def _owner(distribution: metadata.Distribution) -> Owner:
    # one's own reading: `metadata` parses all of the description, which is a hundred times longer
    about = distribution.read_text("METADATA") or distribution.read_text("PKG-INFO") or ""
    name, version = _NAME.search(about), _VERSION.search(about)
    return Owner(name[1] if name else "", version[1] if version else "")


def _files(distribution: metadata.Distribution) -> str:
    files = distribution.read_text("RECORD")
    if files is None:
        listed = distribution.read_text("top_level.txt") or ""
        files = "".join(f"{line}/__init__.py\n" for line in listed.splitlines())
    return f"\n{files}"


def _owners(remembered: Any) -> dict[str, list[Owner]]:
    """Return what is well formed of what was remembered."""
    found: dict[str, list[Owner]] = {}
    for top, owners in remembered.items() if isinstance(remembered, Mapping) else ():
        try:
            pairs = [(name, version) for name, version in owners]
        except (TypeError, ValueError):
            continue
        if all(isinstance(text, str) for pair in pairs for text in pair):
            found[str(top)] = [Owner(*pair) for pair in pairs]
    return found

"""Locations of modules, found without importing them, and whether code or version counts."""

from __future__ import annotations

import os
import re
import sys
import sysconfig
from collections.abc import Iterable, Mapping
from functools import cached_property, lru_cache
from importlib import metadata
from importlib.machinery import ModuleSpec
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

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
        version has the same modules, so its list of files need not be read again.
    """

    def __init__(self, remembered: object = None) -> None:
        self._known = _owners(remembered)
        self._files: dict[str, list[tuple[Owner, str]]] = {}

    def owners(self, top: str, folder: str) -> list[Owner]:
        """Return the distributions in a folder that bring a top-level module."""
        known = self._known.get(top)
        if known and all(_is_there(owner, folder) for owner in known):
            return known
        named = metadata.distributions(name=top, path=[folder])
        owners = [
            _owner(distribution)
            for distribution in named
            if _has(_files(distribution), top, ("/__init__.", "."))
        ]
        if not owners:
            owners = [owner for owner, files in self._in(folder) if _has(files, top, "/.")]
        self._known[top] = owners
        return owners

    def version(self, name: str) -> str:
        """Return the version of the distribution of that name; empty when there is none."""
        try:
            return metadata.version(name)
        except (metadata.PackageNotFoundError, ValueError):
            return ""

    def remembered(self) -> dict[str, list[list[str]]]:
        """Return all locations found, for a later process."""
        return {
            top: [[owner.name, owner.version] for owner in owners]
            for top, owners in self._known.items()
        }

    def _in(self, folder: str) -> list[tuple[Owner, str]]:
        if folder not in self._files:
            every = metadata.distributions(path=[folder])
            self._files[folder] = [
                (_owner(distribution), _files(distribution)) for distribution in every
            ]
        return self._files[folder]


def _is_there(owner: Owner, folder: str) -> bool:
    distributions = metadata.distributions(name=owner.name, path=[folder])
    return any(_owner(distribution) == owner for distribution in distributions)


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


def _owners(remembered: object) -> dict[str, list[Owner]]:
    """Return the well-formed entries of remembered data."""
    owners: dict[str, list[Owner]] = {}
    for top, items in remembered.items() if isinstance(remembered, Mapping) else ():
        try:
            pairs = [(name, version) for name, version in items]
        except (TypeError, ValueError):
            continue
        if all(isinstance(text, str) for pair in pairs for text in pair):
            owners[str(top)] = [Owner(*pair) for pair in pairs]
    return owners


UNKNOWN = "unknown"
_INSTALLED = {"site-packages", "dist-packages"}


class Place(NamedTuple):
    """The location of a module.

    Attributes
    ----------
    file : str
        Its source, or what was compiled from it; empty when it has none.
    folders : tuple of str
        Where its submodules lie, if it is a package.
    """

    file: str
    folders: tuple[str, ...] = ()


class Origin(NamedTuple):
    """The version, or files, that stand for a top-level module and all below it.

    Attributes
    ----------
    followed : bool
        Whether its code does.
    versions : mapping of distribution to version
        Otherwise these do; for the standard library there is none but Python's own.
    """

    followed: bool
    versions: Mapping[str, str]


class Places:
    """Finds modules by name.

    Parameters
    ----------
    followed
        Top-level modules whose code counts wherever they lie.
    distributions
    """

    def __init__(self, followed: Iterable[str], distributions: Distributions) -> None:
        self._followed = frozenset(followed)
        self._distributions = distributions
        self._places: dict[str, Place | None] = {}
        self._origins: dict[str, Origin] = {}

    def place(self, name: str) -> Place | None:
        """Return the location of a module, or None if there is none."""
        if name not in self._places:
            self._places[name] = self._find(name)
        return self._places[name]

    def origin(self, name: str) -> Origin:
        """Return the version, or files, that stand for a module."""
        top = name.partition(".")[0]
        if top not in self._origins:
            self._origins[top] = self._judge(top)
        return self._origins[top]

    def _find(self, name: str) -> Place | None:
        module = sys.modules.get(name)
        if module is not None:
            return _of_module(module)
        parent = name.rpartition(".")[0]
        above = self.place(parent) if parent else None
        if parent and (above is None or not above.folders):
            return None
        return _of_spec(_search(name, list(above.folders) if above else None))

    def _judge(self, top: str) -> Origin:
        place = self.place(top)
        where = (place.file or next(iter(place.folders), "")) if place else ""
        if top in self._followed:
            return Origin(True, {})
        if top in sys.stdlib_module_names and _is_pythons(where):
            return Origin(False, {})
        if not where:
            return Origin(False, {top: self._distributions.version(top) or UNKNOWN})
        folder = _installed_in(where)
        owners = self._distributions.owners(top, folder) if folder else []
        if not owners or self._with_plugins.intersection(owners):
            return Origin(True, {})
        return Origin(False, {owner.name: owner.version for owner in owners})

    @cached_property
    def _with_plugins(self) -> frozenset[Owner]:
        """The distributions of what is followed, and of what else they install."""
        owners: set[Owner] = set()
        for top in self._followed:
            place = self.place(top)
            folder = _installed_in(place.file) if place else ""
            owners.update(self._distributions.owners(top, folder) if folder else ())
        return frozenset(owners)


def _of_module(module: object) -> Place | None:
    place = _of_spec(getattr(module, "__spec__", None))
    if place is not None or not isinstance(module, ModuleType):
        return place
    file = getattr(module, "__file__", None)
    return Place(file or "", tuple(getattr(module, "__path__", ())))


def _of_spec(spec: ModuleSpec | None) -> Place | None:
    if spec is None:
        return None
    file = spec.origin if spec.has_location else ""
    return Place(file or "", tuple(spec.submodule_search_locations or ()))


def _search(name: str, folders: list[str] | None) -> ModuleSpec | None:
    for finder in sys.meta_path:
        try:
            spec = finder.find_spec(name, folders)
        except Exception:
            # a third-party finder failed, as it would for Python
            continue
        if spec is not None:
            return spec
    return None


def _is_pythons(where: str) -> bool:
    """Whether a file of that name is Python's own, and not a user's that hides it."""
    return not where or (where.startswith(_pythons_folders()) and not _installed_in(where))


@lru_cache(maxsize=1)
def _pythons_folders() -> tuple[str, ...]:
    paths = sysconfig.get_paths()
    # the last as modules name it: a path by another link is another text
    own = (
        paths["stdlib"],
        paths["platstdlib"],
        os.path.join(sys.base_prefix, "DLLs"),
        os.path.dirname(os.__file__),
    )
    return tuple(os.path.join(folder, "") for folder in own)


def _installed_in(where: str) -> str:
    """Return the folder for installed packages that holds a file; empty when none does."""
    path = Path(where)
    return next((str(folder) for folder in (path, *path.parents) if folder.name in _INSTALLED), "")

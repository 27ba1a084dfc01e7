"""Where modules lie, found without importing them, and whether their code or version counts."""

from __future__ import annotations

import os
import sys
import sysconfig
from collections.abc import Iterable, Mapping
from functools import cached_property, lru_cache
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

from nodegraph.code.distributions import Distributions, Owner

UNKNOWN = "unknown"
_INSTALLED = {"site-packages", "dist-packages"}


class Place(NamedTuple):
    """Where a module lies.

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
    """What tells of a change in a top-level module and all below it.

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
        """Return where a module lies, or None when there is none."""
        if name not in self._places:
            self._places[name] = self._find(name)
        return self._places[name]

    def origin(self, name: str) -> Origin:
        """Return what tells of a change in a module."""
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
        """The distributions that brought what is followed, with whatever else they brought."""
        found: set[Owner] = set()
        for top in self._followed:
            place = self.place(top)
            folder = _installed_in(place.file) if place else ""
            found.update(self._distributions.owners(top, folder) if folder else ())
        return frozenset(found)


def _of_module(module: Any) -> Place | None:
    place = _of_spec(getattr(module, "__spec__", None))
    if place is not None or not isinstance(module, ModuleType):
        return place
    file = getattr(module, "__file__", None)
    return Place(file or "", tuple(getattr(module, "__path__", ())))


def _of_spec(spec: Any) -> Place | None:
    if spec is None:
        return None
    file = spec.origin if spec.has_location else ""
    return Place(file or "", tuple(spec.submodule_search_locations or ()))


def _search(name: str, folders: list[str] | None) -> Any:
    for finder in sys.meta_path:
        try:
            spec = finder.find_spec(name, folders)
        except Exception:
            # somebody else's finder: Python itself would go no further, we need not be told
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
    return tuple(os.path.join(one, "") for one in own)


def _installed_in(where: str) -> str:
    """Return the folder for installed packages that holds a file; empty when none does."""
    path = Path(where)
    return next((str(one) for one in (path, *path.parents) if one.name in _INSTALLED), "")

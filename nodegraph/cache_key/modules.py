"""The modules that code imports, directly or not: found and read without importing them."""

from __future__ import annotations

import glob
import os
import sys
import sysconfig
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from email.parser import HeaderParser
from functools import cache, cached_property
from importlib.machinery import PathFinder
from importlib.util import find_spec, resolve_name
from itertools import takewhile
from pathlib import Path
from typing import NamedTuple

from nodegraph.cache_key.files import FileMemo
from nodegraph.cache_key.sources import ANY, ModuleSource, read_source
from nodegraph.import_time import STARTED

UNKNOWN = "unknown"
"""The version of a distribution that is not installed."""
_NOT_FOLLOWED = {"nodegraph.plugin.registry", "nodegraph.plugin.kind", "nodegraph.execute.call"}
"""Modules that find, call and show what plugins define, whatever it is; all of nodegraph hangs on
them."""
_INSTALLED = {"site-packages", "dist-packages"}


class ModuleFiles(NamedTuple):
    """The file of a module, if it has one, and the folders of its submodules, if it has some."""

    file: str
    folders: tuple[str, ...] = ()


At = tuple[str, str | None]
"""A module and the name that is used of it; an empty name for all of it, None for its import, and
`ANY` for a package with all of its modules."""


@dataclass
class ReferencedCode:
    """The code that references lead to.

    Attributes
    ----------
    digests : dict of module to digest
        Digests of the modules whose code counts.
    edited : dict of module to path and time
        The files that decide which modules these are, as far as they were edited since the program
        began: when they were, in nanoseconds since 1970.
    versions : dict of distribution to version
        Versions of the distributions of all others.
    troubles : list of str
        Why digests do not tell which code is run.
    """

    digests: dict[str, str] = field(default_factory=dict)
    edited: dict[str, tuple[str, int]] = field(default_factory=dict)
    versions: dict[str, str] = field(default_factory=dict)
    troubles: list[str] = field(default_factory=list)

    def add(self, other: ReferencedCode) -> None:
        """Add what another one has."""
        self.digests |= other.digests
        self.edited |= other.edited
        self.versions |= other.versions
        self.troubles += other.troubles


class Modules:
    """Finds modules by name, and the modules that they import.

    Parameters
    ----------
    followed
        Top-level modules whose code counts wherever they lie, with all that their distributions
        install. So does the code of modules that were not installed. Of every other module the
        version counts.
    memo
        Remembers sources, and the modules that folders hold.
    """

    def __init__(self, followed: Iterable[str], memo: FileMemo) -> None:
        self._followed = frozenset(followed)
        self._memo = memo
        self._places: dict[str, ModuleFiles | None] = {}
        self._versions: dict[str, Mapping[str, str] | None] = {}
        self._known: dict[At, tuple[ReferencedCode, list[At]]] = {}
        self._wholes: dict[str, At | None] = {}
        self._reached: dict[tuple[At, ...], ReferencedCode] = {}
        self._sources: dict[str, tuple[ModuleSource, ReferencedCode]] = {}

    def add(self, file: str, name: str) -> str:
        """Make a file known as a module of that name, and return the name that it has here."""
        place = self._place(name)
        while place is not None and os.path.abspath(place.file) != file:
            name += "'"
            place = self._place(name)
        self._places[name] = place or ModuleFiles(file)
        return name

    def reach(self, references: Iterable[str]) -> ReferencedCode:
        """Return the code that references lead to, directly or not.

        A name that a package imports leads to the module that it is imported from, and not to what
        else the package imports, unless an import of the package does more than to bind names.
        """
        first = tuple(self._all_that_differ(_absolute("", references)))
        if first not in self._reached:
            self._reached[first] = self._reach(first)
        return self._reached[first]

    def _reach(self, first: Iterable[At]) -> ReferencedCode:
        result = ReferencedCode()
        waiting = list(first)
        seen: set[At] = set()
        while waiting:
            at = waiting.pop()
            if at not in seen:
                seen.add(at)
                if at not in self._known:
                    own = ReferencedCode()
                    follow = self._all(at[0]) if at[1] == ANY else self._follow(*at, own)
                    self._known[at] = own, self._all_that_differ(follow)
                own, more = self._known[at]
                result.add(own)
                waiting += more
        return result

    def _all_that_differ(self, follow: Iterable[At]) -> list[At]:
        """Return modules with names, once where several names lead to the same code."""
        return list(dict.fromkeys(map(self._without_name, follow)))

    def _without_name(self, at: At) -> At:
        """Return a module without the name, unless it is a package, of which names matter."""
        module, name = at
        if name == ANY:
            return at
        if module not in self._wholes:
            self._wholes[module] = self._whole(module)
        return self._wholes[module] or at

    def _whole(self, module: str) -> At | None:
        if self._counted(module) is not None:
            return module.partition(".")[0], ""
        return None if self._folders(module) else (module, "")

    def _follow(self, module: str, name: str | None, own: ReferencedCode) -> Iterator[At]:
        """Add a module, and yield all that it leads to."""
        versions = self._counted(module)
        own.versions |= versions or {}
        place = self._place(module)
        if versions is not None or module in _NOT_FOLLOWED or place is None:
            return
        parent = module.rpartition(".")[0]
        if parent:
            yield parent, None
        if module not in self._sources:
            self._sources[module] = self._read(module, place.file)
        source, found = self._sources[module]
        own.add(found)
        package = module if place.folders else parent
        if place.folders and name != "" and not source.acts:
            passed = list(self._passed(module, name, source)) if name else []
            if passed or name is None:
                whole = [each for each in source.imports if each.endswith(":")]
                yield from (*_absolute(package, whole), *passed)
                return
        if place.file:
            own.digests[module] = source.digest
        yield from _absolute(package, source.imports)
        if ANY in source.imports:
            top = module.partition(".")[0]
            if self._folders(top):
                yield top, ANY
            else:
                text = f"{module} imports a module whose name is known only when it runs"
                own.troubles.append(text)

    def _read(self, module: str, file: str) -> tuple[ModuleSource, ReferencedCode]:
        """Return the source of a module, and whether it can be read and was edited."""
        if not file:
            return ModuleSource(""), ReferencedCode()
        try:
            source = ModuleSource(*self._memo.get(file, read_source))
            time = os.stat(file).st_mtime_ns
        except OSError as error:
            trouble = f"{module}: its file cannot be read: {error.strerror or error}"
            return ModuleSource(""), ReferencedCode(troubles=[trouble])
        return source, ReferencedCode(edited={module: (file, time)} if time > STARTED else {})

    def _passed(self, package: str, name: str, source: ModuleSource) -> Iterator[At]:
        """Yield where a package takes a name from; nothing if it may be of the package itself."""
        references = source.names.get(name, [])
        if "" in references:
            return
        yield from _absolute(package, references)
        yield from ((module, name) for module, _ in _absolute(package, source.names.get("*", [])))
        if self._place(f"{package}.{name}"):
            yield f"{package}.{name}", ""

    def _all(self, top: str) -> Iterator[At]:
        for folder in self._folders(top):
            for file in sorted(glob.glob("**/*.py", root_dir=folder, recursive=True)):
                name = file.removesuffix(".py").replace(os.sep, ".")
                yield f"{top}.{name}".removesuffix(".__init__"), ""

    def _folders(self, name: str) -> tuple[str, ...]:
        place = self._place(name)
        return place.folders if place else ()

    def _place(self, name: str) -> ModuleFiles | None:
        if name not in self._places:
            self._places[name] = self._find(name)
        return self._places[name]

    def _find(self, name: str) -> ModuleFiles | None:
        module = sys.modules.get(name)
        if module is not None:
            names = vars(module)  # its own `__getattr__` may return anything
            return ModuleFiles(names.get("__file__") or "", tuple(names.get("__path__", ())))
        parent = name.rpartition(".")[0]
        above = self._place(parent) if parent else None
        if parent and above is None:
            return None
        last = name.rpartition(".")[2]
        spec = PathFinder.find_spec(last, above.folders) if above else find_spec(name)
        if spec is None:
            return None
        file = spec.origin if spec.has_location else ""
        return ModuleFiles(file or "", tuple(spec.submodule_search_locations or ()))

    def _counted(self, module: str) -> Mapping[str, str] | None:
        """Return the versions that stand for a module's code, or None if the code counts."""
        top = module.partition(".")[0]
        if top not in self._versions:
            self._versions[top] = None if top in self._followed else self._judge(top)
        return self._versions[top]

    def _judge(self, top: str) -> Mapping[str, str] | None:
        place = self._place(top)
        if place is None:
            return {top: UNKNOWN}
        where = place.file or next(iter(place.folders), "")
        if not _INSTALLED.intersection(Path(where).parts):
            return {} if not where or where.startswith(_pythons_folders()) else None
        owners = self._owners(top)
        return None if not owners or self._with_plugins.intersection(owners) else owners

    @cached_property
    def _with_plugins(self) -> frozenset[str]:
        """The distributions of what is followed."""
        return frozenset(owner for top in self._followed for owner in self._owners(top))

    def _owners(self, top: str) -> Mapping[str, str]:
        """Return the distributions that install a top-level module, with their versions."""
        place = self._place(top)
        versions = {}
        for path in (place.folders or (place.file,)) if place else ():
            folder = os.path.dirname(path)
            if _INSTALLED.intersection(Path(folder).parts):
                for about in self._memo.get(folder, _installed).get(top, ()):
                    name, version = self._memo.get(os.path.join(folder, about), _name_and_version)
                    versions[name] = version
        return versions


def _installed(folder: str) -> Mapping[str, list[str]]:
    """Return files about the distributions that install each top-level module in a folder."""
    result: defaultdict[str, list[str]] = defaultdict(list)
    for name in ("METADATA", "PKG-INFO"):
        for about in sorted(glob.glob(f"*.*-info/{name}", root_dir=folder)):
            where = os.path.join(folder, os.path.dirname(about))
            files = _content(os.path.join(where, "top_level.txt")).split()
            files = files or _content(os.path.join(where, "RECORD")).splitlines()
            tops = {file.partition(b"/")[0].partition(b".")[0] for file in files}
            for top in tops:
                result[top.decode("utf-8", "replace")].append(about)
    return result


def _content(file: str) -> bytes:
    with suppress(OSError), open(file, "rb") as opened:
        return opened.read()
    return b""


def _name_and_version(about: str) -> tuple[str, str]:
    with open(about, encoding="utf-8", errors="replace") as opened:
        headers = HeaderParser().parsestr("".join(takewhile(str.strip, opened)))
    return headers["Name"], headers["Version"]


def _absolute(package: str, references: Iterable[str]) -> Iterator[At]:
    for reference in references:
        module, _, name = reference.partition(":")
        if reference == ANY:
            continue
        if module.startswith("."):
            try:
                module = resolve_name(module, package)
            except ImportError:  # outside of any package it fails when it is run
                continue
        yield module, "" if name == "*" else name


@cache
def _pythons_folders() -> tuple[str, ...]:
    folders = (*map(sysconfig.get_path, ("stdlib", "platstdlib")), os.path.dirname(os.__file__))
    return tuple(os.path.join(folder, "") for folder in folders)

"""Which code decides what a function returns."""

from __future__ import annotations

import gc
import hashlib
import os
import sys
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass

from nodegraph.fingerprint.functions import Live
from nodegraph.fingerprint.modules import Distributions, Places
from nodegraph.fingerprint.names import FORMATS, Links, Module, Reach
from nodegraph.fingerprint.source import Sources, short_digest
from nodegraph.import_time import LOADED, STARTED
from nodegraph.plugin.hook_types import Format


def edited_since(modules: Iterable[Module], function: Callable[..., object]) -> Iterator[str]:
    """Yield the files edited since the program began, or since their module was last read.

    A module that was imported later may be up to date all the same; that is not known.
    """
    own = getattr(function, "__globals__", {})
    for module in modules:
        there = (
            own if own.get("__file__") == module.file else vars(sys.modules.get(module.name, sys))
        )
        if module.file and (module.name in sys.modules or there is own):
            loaded = there.get(LOADED, STARTED)
            if _changed(module.file) > loaded:
                yield f"{module.name} was edited after it was imported; start the program again"


def _changed(file: str) -> int:
    try:
        return os.stat(file).st_mtime_ns
    except OSError:
        return 0


_FORMAT = 1
_PYTHON = f"{sys.version_info.major}.{sys.version_info.minor}"

_Gathered = tuple[defaultdict[str, set[str]], set[str], set[str], set[Module]]


@dataclass(frozen=True)
class Reached:
    """The code that a function reaches.

    Attributes
    ----------
    digest : str
        Of `units` and `versions`.
    units : mapping of ``module:name`` to digest
        Every function, class and constant; ``<statements>`` are what else a module runs when it
        is imported, ``name[variable]`` is what a function was made with.
    versions : mapping of distribution to version
        Of the code that is not followed; ``python`` stands for its standard library too.
    unstable : str
        Why an equal digest would not mean equal code; empty when it does.
    """

    digest: str
    units: Mapping[str, str]
    versions: Mapping[str, str]
    unstable: str = ""


class Code:
    """Finds the code that functions reach, from source files and without importing anything.

    Each file is read once in the life of this object: make another after an edit.

    Parameters
    ----------
    followed
        Top-level modules whose code counts wherever they lie, those of all plugins. So does that
        of modules that were not installed. Of every other module the version counts.
    remembered
        What `remembered` returned in an earlier process. What does not hold any more, or is not
        of that form, is left out.
    formats
        Returns the formats of the plugins in use: a function that calls `nodegraph.formats` reaches
        the code of all of them.
    """

    def __init__(
        self,
        followed: Iterable[str],
        remembered: Mapping[str, object] | None = None,
        formats: Callable[[], Iterable[Format]] = tuple,
    ) -> None:
        known = remembered if isinstance(remembered, Mapping) else {}
        ours = known.get("format") == _FORMAT and known.get("python") == _PYTHON
        self._sources = Sources(known.get("files") if ours else None)
        self._distributions = Distributions(known.get("distributions") if ours else None)
        self._places = Places(followed, self._distributions)
        self._links = Links(self._places, self._sources)
        self._formats = formats
        self._known: dict[int, tuple[object, Reached]] = {}

    def of(self, function: Callable[..., object]) -> Reached:
        """Return the code that a function reaches, found once in the life of this object."""
        known = self._known.get(id(function))
        if known is None:
            # the function is kept with it, so that no other one can get its id
            with _without_collection():
                known = self._known[id(function)] = (function, self._find(function))
        return known[1]

    def remembered(self) -> dict[str, object]:
        """Return data that a later process need not read again, as plain values for JSON."""
        return {
            "format": _FORMAT,
            "python": _PYTHON,
            "files": self._sources.remembered(),
            "distributions": self._distributions.remembered(),
        }

    def _find(self, function: Callable[..., object]) -> Reached:
        live = Live(self._links, self._places)
        reach = live.look_at(function)
        if ":".join(FORMATS) in self._gather(reach)[0]:
            for form in self._formats():
                described = form.type.__qualname__, form.suffixes, form.read, form.recognizes
                reach = live.look_at(described, f"format:{form.name}")
        digests_by_unit, versioned, troubles, modules = self._gather(reach)
        troubles |= set(edited_since(modules, function))
        for label, digests in live.units.items():
            digests_by_unit[label] |= digests
        units = {label: _combined(digests) for label, digests in sorted(digests_by_unit.items())}
        versions = {"python": _PYTHON}
        for top in sorted(versioned):
            versions.update(self._places.origin(top).versions)
        return Reached(
            hashlib.sha256(repr((units, sorted(versions.items()))).encode()).hexdigest(),
            units,
            versions,
            "; ".join(dict.fromkeys([*live.troubles, *sorted(troubles)])),
        )

    def _gather(self, reach: Reach) -> _Gathered:
        """Return digests by label, modules whose version counts, troubles, and modules read."""
        digests: defaultdict[str, set[str]] = defaultdict(set)
        versioned, troubles = set(reach.versioned), set()
        seen = set(reach.definitions)
        waiting = list(seen)
        while waiting:
            unit = self._links.unit(waiting.pop())
            digests[unit.label].add(unit.digest)
            versioned |= unit.reach.versioned
            troubles |= {unit.trouble} - {""}
            new = unit.reach.definitions - seen
            seen |= new
            waiting.extend(new)
        return digests, versioned, troubles, {definition.module for definition in seen}


@contextmanager
def _without_collection() -> Iterator[None]:
    # syntax trees are many small objects, none of them garbage: collecting triples the time
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()


def _combined(digests: set[str]) -> str:
    """Return the digest of a label; several units that have one name count together."""
    return next(iter(digests)) if len(digests) == 1 else short_digest(*sorted(digests))

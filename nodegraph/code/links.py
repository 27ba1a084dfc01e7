"""What each name of a module leads to; what was followed once is kept."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from nodegraph.code.parts import Summary, short_digest
from nodegraph.code.places import Places
from nodegraph.code.search import Search
from nodegraph.code.sources import Sources
from nodegraph.code.spots import (
    NOT_FOLLOWED,
    STATEMENTS,
    Meaning,
    Module,
    Reach,
    Spot,
    Step,
    Unit,
    absolute,
    label_of,
    parts_of,
    runs,
)


class Links:
    """Follows names from module to module; what was followed once is kept.

    Parameters
    ----------
    places
        Finds modules.
    sources
        Reads them.
    """

    def __init__(self, places: Places, sources: Sources) -> None:
        self._places = places
        self._sources = sources
        self._by_name: dict[str, Module | None] = {}
        self._by_file: dict[tuple[str, str], Module] = {}
        self._entered: dict[Module, frozenset[Spot]] = {}
        self._units: dict[Spot, Unit] = {}
        self._steps: dict[Step, Reach] = {}
        self._meanings: dict[Module, dict[str, Meaning | None]] = {}

    def module(self, name: str) -> Module | None:
        """Return a module whose code counts, or None where its version does, or there is none."""
        if name not in self._by_name:
            self._by_name[name] = self._find(name)
        return self._by_name[name]

    def module_in(self, file: str, name: str) -> Module:
        """Return the module that a file is."""
        at = (file, name)
        if at not in self._by_file:
            package = Path(file).stem == "__init__"
            self._by_file[at] = Module(name, file, self._sources.summary(file), package=package)
        return self._by_file[at]

    def entered(self, module: Module) -> frozenset[Spot]:
        """Return what runs when a module is imported: its statements, and its packages'."""
        if module not in self._entered:
            above = self.module(module.name.rpartition(".")[0]) if "." in module.name else None
            own = {Spot(module, STATEMENTS)} if runs(module.summary) else set()
            self._entered[module] = (self.entered(above) if above else frozenset()) | own
        return self._entered[module]

    def meaning(self, module: Module, name: str) -> Meaning | None:
        """Return what a name stands for in a module, or None if the module does not bind it."""
        known = self._meanings.setdefault(module, {})
        if name not in known:
            known[name] = self._meant(module, name)
        return known[name]

    def versioned(self, names: Iterable[str]) -> frozenset[str]:
        """Return the top-level modules of those whose version counts."""
        return frozenset(
            name.partition(".")[0] for name in names if self._places.origin(name).versions
        )

    def unit(self, spot: Spot) -> Unit:
        """Return what a spot is made of, and what it leads to."""
        if spot not in self._units:
            self._units[spot] = self._made(spot)
        return self._units[spot]

    def reach(self, module: Module | None, references: Iterable[str]) -> Reach:
        """Return what references lead to, those without a module's name as seen in a module."""
        return Search(self, self._places, module).run(references)

    def step(self, step: Step) -> Reach:
        """Return what a name leads to that was found in one module and belongs to another."""
        if step not in self._steps:
            self._steps[step] = Search(self, self._places, None).run_on(step)
        return self._steps[step]

    def _meant(self, module: Module, name: str) -> Meaning | None:
        summary = module.summary
        if (module.name, name) in NOT_FOLLOWED:
            return Meaning(frozenset(), (), frozenset())
        if name not in summary.names and name not in summary.imports:
            return None
        targets = [target.partition(":") for target in summary.imports.get(name, ())]
        full = [(absolute(module, inside), taken) for inside, _, taken in targets]
        return Meaning(
            frozenset({Spot(module, name)} if name in summary.names else ()),
            tuple(one for one in full if one[0] and self._places.origin(one[0]).followed),
            self.versioned(inside for inside, _ in full if inside),
        )

    def _find(self, name: str) -> Module | None:
        if not self._places.origin(name).followed:
            return None
        place = self._places.place(name)
        if place is None:
            return None
        return (
            self.module_in(place.file, name)
            if place.file
            else Module(name, "", Summary(), package=True)
        )

    def _made(self, spot: Spot) -> Unit:
        module, summary = spot.module, spot.module.summary
        parts = parts_of(spot)
        references = [reference for part in parts for reference in part.references]
        if spot.name == STATEMENTS:
            references += summary.effects
        return Unit(
            label_of(spot),
            short_digest(*(part.digest for part in parts)),
            self.reach(module, references),
            f"{module.name}: {summary.trouble}" if summary.trouble else "",
        )

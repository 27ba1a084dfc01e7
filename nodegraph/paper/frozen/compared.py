"""How far a run agrees with a lock, result by result, and where it begins not to."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from nodegraph.execute import Run
from nodegraph.paper.frozen.explained import Change, Explained
from nodegraph.paper.frozen.lock import Lock
from nodegraph.paper.frozen.recorded import Recorded, exact_of
from nodegraph.paper.frozen.results import Cell, Results, cells_of
from nodegraph.paper.spread import Spread

_MEASURED = re.compile(r"[-+]?\d*\.\d+(?:e[-+]?\d+)?", re.I)


@dataclass(frozen=True)
class Grade:
    """How far one result is from the one in a lock.

    Attributes
    ----------
    state : str
        ``identical``, ``near`` (within the tolerance), ``moved``, or ``unknown``.
    apart : float
        Root mean square of the differences, relative to the usual size; 0 where that is not known.
    said : str
        What differs besides, or instead.
    """

    state: str
    apart: float = 0.0
    said: str = ""


@dataclass(frozen=True)
class Moved:
    """A combination with another result, and how its step is another."""

    cell: Cell
    grade: Grade
    change: Change


@dataclass
class Compared(Spread[Moved]):
    """How far a run agrees with a lock.

    Attributes
    ----------
    origins, followers
        Combinations beyond the tolerance: those with which that begins, and the rest.
    identical, near : int
        Combinations with the same result to the bit, and with one within the tolerance.
    ended : Counter of str
        Of the identical ones, those without a result: how many were ``refused``, ``failed`` or
        ``skipped`` in the lock and again.
    farthest : tuple of Cell and float, or None
        The one of those within the tolerance that is farthest away.
    drawn : Counter of str
        Combinations of each node that drew the same numbers otherwise.
    unknown : Counter of str
        Those of whose values there is no digest.
    only_locked, only_now : list of str
        Combinations that only the lock has, or only the run.
    """

    identical: int = 0
    near: int = 0
    ended: Counter[str] = field(default_factory=Counter)
    farthest: tuple[Cell, float] | None = None
    drawn: Counter[str] = field(default_factory=Counter)
    unknown: Counter[str] = field(default_factory=Counter)
    only_locked: list[str] = field(default_factory=list)
    only_now: list[str] = field(default_factory=list)

    @property
    def count(self) -> int:
        """Of combinations that were compared."""
        return self.identical + self.near + self.beyond


def compare(lock: Lock, run: Run, results: Results) -> Compared:
    """Compare every result of a run with what a lock holds of it.

    Parameters
    ----------
    lock
    run
        Of the graph of the lock.
    results
        Of that run.
    """
    return _Comparing(lock, run, results).compare()


class _Comparing:
    def __init__(self, lock: Lock, run: Run, results: Results) -> None:
        self._lock = lock
        self._run = run
        self._results = results
        self._explained = Explained(lock, run)
        self._found = Compared()
        self._near: set[int] = set()

    def compare(self) -> Compared:
        left = {(group, at) for group, steps in self._lock.results.items() for at in steps}
        for cell in cells_of(self._run):
            was = self._lock.results.get(cell.group, {}).get(cell.at)
            left.discard((cell.group, cell.at))
            if was is None:
                self._found.only_now.append(cell.name)
            else:
                self._sort_in(cell, self._grade(cell, was))
        self._found.only_locked = [f"{group} at {at}" for group, at in sorted(left)]
        return self._found

    def _sort_in(self, cell: Cell, grade: Grade) -> None:
        found = self._found
        if grade.state == "identical":
            found.identical += 1
            if ended := self._results.ended(cell.index):
                found.ended[ended.partition(":")[0]] += 1
        elif grade.state == "unknown":
            found.unknown[cell.node] += 1
        elif grade.state == "near":
            found.near += 1
            self._near.add(cell.index)
            if found.farthest is None or found.farthest[1] < grade.apart:
                found.farthest = (cell, grade.apart)
        else:
            moved = Moved(cell, grade, self._explained.change(cell))
            changed = bool(moved.change.own)
            found.add(moved, cell.node, cell.index, self._needed(cell), changed=changed)

    def _needed(self, cell: Cell) -> tuple[int, ...]:
        return self._run.plan.steps[cell.index].needed

    def _grade(self, cell: Cell, was: Recorded) -> Grade:
        ended = self._results.ended(cell.index)
        if ended or was.ended:
            same = _plain(ended) == _plain(was.ended)
            said = f"was {was.ended or 'done'}, now {ended or 'done'}"
            return Grade("identical") if same else Grade("moved", 0.0, said)
        values = self._of_values(cell, was)
        if values.state == "moved" or self._results.opaque_digest(cell.index) == was.opaque:
            return values
        return self._of_drawing(cell, values)

    def _of_values(self, cell: Cell, was: Recorded) -> Grade:
        digest = self._results.digest(cell.index)
        if digest == was.digest:
            nothing = not digest and not was.opaque
            return Grade("unknown" if nothing else "identical")
        apart = self._apart(cell, was)
        if exact_of(self._results, cell.index) != was.exact:
            return Grade("moved", apart, "types, shapes, texts or which samples are missing differ")
        return Grade("near" if apart <= self._lock.data["tolerance"] else "moved", apart)

    def _of_drawing(self, cell: Cell, values: Grade) -> Grade:
        """Return the grade of a result whose drawing, or files, are others."""
        if self._found.reaches(self._needed(cell)):
            return Grade("moved", values.apart)
        drifted = values.state == "near" or not self._near.isdisjoint(self._needed(cell))
        is_file = self._results.gives_files(cell.index)
        if is_file and (not drifted or self._explained.change(cell).own):
            return Grade("moved", 0.0, "its files have other bytes")
        if drifted:
            return Grade("near", values.apart)
        self._found.drawn[cell.node] += 1
        return values

    def _apart(self, cell: Cell, was: Recorded) -> float:
        found = self._results.sketch(cell.index)
        if found is None or was.projections is None:
            return 0.0
        return found.against(self._lock.scales[cell.group]).apart(was.projections)


def first_of_each(moved: Iterable[Moved]) -> list[list[Moved]]:
    """Return what moved by groups that changed in the same way, in their order."""
    groups: dict[tuple[Any, ...], list[Moved]] = {}
    for one in moved:
        groups.setdefault((one.cell.group, one.change), []).append(one)
    return list(groups.values())


def _plain(said: str) -> str:
    """Return a reason without its measured numbers, which drift."""
    return _MEASURED.sub("#", said)

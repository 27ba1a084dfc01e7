"""Comparison of the results of a run with a lock: how far they agree, where differences begin."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

from nodegraph.execute import Run
from nodegraph.lock.changes import Change, Changes
from nodegraph.lock.locked_result import LockedResult
from nodegraph.lock.lockfile import Lock
from nodegraph.lock.results import Cell, Results, cells_of
from nodegraph.runs.diff import Spread
from nodegraph.state import State

_DECIMALS = re.compile(r"[-+]?(?:(?<!\d)\d+)?\.\d+(?:e[-+]?\d+)?", re.I)


class Agreement(StrEnum):
    """The agreement of one result with the one in a lock."""

    IDENTICAL = "identical"
    NEAR = "near"
    MOVED = "moved"
    UNKNOWN = "unknown"


class Grade(StrEnum):
    """The agreement of the results of a study with its lock, from the best to the worst."""

    IDENTICAL = "identical"
    WITHIN_TOLERANCE = "within tolerance"
    SAME_CONCLUSIONS = "same conclusions"
    DIVERGED = "diverged"


@dataclass(frozen=True)
class Match:
    """The distance of one result from the one in a lock.

    Attributes
    ----------
    agreement : Agreement
    distance : float
        Root mean square difference relative to the usual size; 0 if unknown.
    text : str
        What differs in addition, or instead.
    """

    agreement: Agreement
    distance: float = 0.0
    text: str = ""


@dataclass(frozen=True)
class Moved:
    """A combination with another result, and how its step changed."""

    cell: Cell
    match: Match
    change: Change


@dataclass
class Compared(Spread[Moved]):
    """The agreement of all results of a run with a lock.

    Attributes
    ----------
    origins, followers
        Combinations beyond the tolerance: those with which differences begin, and the rest.
    identical, near : int
        How many combinations have the same result to the bit, or one within the tolerance.
    without_value : Counter of str
        How many of the identical ones are ``refused``, ``failed`` or ``skipped``.
    farthest : tuple of Cell and float, or None
        The combination within the tolerance that differs most.
    drawn : Counter of str
        How many combinations of each node have another drawing of the same numbers.
    unknown : Counter of str
        How many combinations of each node have no digest.
    only_locked, only_now : list of str
        Combinations that only the lock has, or only the run.
    """

    identical: int = 0
    near: int = 0
    without_value: Counter[str] = field(default_factory=Counter)
    farthest: tuple[Cell, float] | None = None
    drawn: Counter[str] = field(default_factory=Counter)
    unknown: Counter[str] = field(default_factory=Counter)
    only_locked: list[str] = field(default_factory=list)
    only_now: list[str] = field(default_factory=list)

    @property
    def count(self) -> int:
        """The number of combinations that were compared."""
        return self.identical + self.near + self.beyond


def compare(lock: Lock, run: Run, results: Results) -> Compared:
    """Compare every result of a run with the one in a lock.

    Parameters
    ----------
    lock
    run
        Of the graph of the lock.
    results
        Of that run.
    """
    return _Comparison(lock, run, results).compare()


class _Comparison:
    def __init__(self, lock: Lock, run: Run, results: Results) -> None:
        self._lock = lock
        self._results = results
        self._cells = list(cells_of(run))
        self._network = run.plan.network
        self._changes = Changes(lock.study, run)
        self._compared = Compared()
        self._near: set[int] = set()

    def compare(self) -> Compared:
        study = self._lock.study
        unmatched = {(group, at) for group, locked in study.results.items() for at in locked.steps}
        for cell in self._cells:
            was = study.recorded(cell.group, cell.at)
            unmatched.discard((cell.group, cell.at))
            if was is None:
                self._compared.only_now.append(cell.name)
            else:
                self._add(cell, self._match(cell, was))
        self._compared.only_locked = [f"{group} at {at}" for group, at in sorted(unmatched)]
        return self._compared

    def _add(self, cell: Cell, match: Match) -> None:
        compared = self._compared
        if match.agreement is Agreement.IDENTICAL:
            compared.identical += 1
            if ending := self._results.ending(cell.index):
                compared.without_value[ending.partition(":")[0]] += 1
        elif match.agreement is Agreement.UNKNOWN:
            compared.unknown[cell.node] += 1
        elif match.agreement is Agreement.NEAR:
            compared.near += 1
            self._near.add(cell.index)
            if compared.farthest is None or compared.farthest[1] < match.distance:
                compared.farthest = (cell, match.distance)
        else:
            moved = Moved(cell, match, self._changes.of(cell))
            sources = self._network.pred[cell.index]
            compared.add(moved, cell.node, cell.index, sources, moved.change.own)

    def _match(self, cell: Cell, was: LockedResult) -> Match:
        ending = self._results.ending(cell.index)
        if ending or was.ending:
            if _without_decimals(ending) == _without_decimals(was.ending):
                return Match(Agreement.IDENTICAL)
            text = f"was {was.ending or State.DONE}, now {ending or State.DONE}"
            return Match(Agreement.MOVED, text=text)
        match = self._match_values(cell, was)
        if match.agreement is Agreement.MOVED:
            return match
        same = self._results.opaque_digest(cell.index) == was.opaque
        return match if same else self._match_drawing(cell, match)

    def _match_values(self, cell: Cell, was: LockedResult) -> Match:
        digest = self._results.digest(cell.index)
        if digest == was.digest:
            known = digest or was.opaque
            return Match(Agreement.IDENTICAL if known else Agreement.UNKNOWN)
        distance = self._distance(cell, was)
        if self._results.exact(cell.index) != was.exact:
            text = "types, shapes, texts or which samples are missing differ"
            return Match(Agreement.MOVED, distance, text)
        near = distance <= self._lock.study.tolerance
        return Match(Agreement.NEAR if near else Agreement.MOVED, distance)

    def _match_drawing(self, cell: Cell, values: Match) -> Match:
        """Return the match of a result whose drawings or files differ."""
        sources = self._network.pred[cell.index]
        if self._compared.reaches(sources):
            return Match(Agreement.MOVED, values.distance)
        near = values.agreement is Agreement.NEAR or not self._near.isdisjoint(sources)
        has_files = self._results.has_files(cell.index)
        if has_files and (not near or self._changes.of(cell).own):
            return Match(Agreement.MOVED, text="the bytes of its files differ")
        if near:
            return Match(Agreement.NEAR, values.distance)
        self._compared.drawn[cell.node] += 1
        return values

    def _distance(self, cell: Cell, was: LockedResult) -> float:
        sketch = self._results.sketch(cell.index)
        if sketch is None or was.projections is None:
            return 0.0
        scale = self._lock.study.results[cell.group].scale
        return sketch.against(scale).apart(was.projections)


def group_by_change(moved: Iterable[Moved]) -> list[list[Moved]]:
    """Return combinations grouped by node, alternative and change, in their order."""
    groups: dict[tuple[str, Change], list[Moved]] = {}
    for item in moved:
        groups.setdefault((item.cell.group, item.change), []).append(item)
    return list(groups.values())


@dataclass(frozen=True)
class Verdict:
    """The outcome of a comparison.

    Attributes
    ----------
    grade : Grade
    conclusions_changed : bool
        Possible even within the tolerance: the last digit may decide a tie.
    """

    grade: Grade
    conclusions_changed: bool = False

    @property
    def holds(self) -> bool:
        """Whether the study still has its results and its conclusions."""
        return self.grade is not Grade.DIVERGED and not self.conclusions_changed

    @property
    def text(self) -> str:
        """The verdict in a few words."""
        if self.conclusions_changed and self.grade is not Grade.DIVERGED:
            return f"{self.grade}, but conclusions changed"
        return self.grade


def verdict(compared: Compared, conclusions: bool, changed: Sequence[str]) -> Verdict:
    """Return the outcome of a comparison.

    Results beyond the tolerance may have the same conclusions only if the study itself did not
    change: an edited method has diverged, whatever follows from it.

    Parameters
    ----------
    compared
    conclusions
        Whether the study draws any.
    changed
        The conclusions that changed.
    """
    own_changes = any(moved.change.own for moved in compared.origins)
    if compared.only_locked or compared.only_now or own_changes:
        grade = Grade.DIVERGED
    elif compared.beyond:
        grade = Grade.SAME_CONCLUSIONS if conclusions and not changed else Grade.DIVERGED
    else:
        grade = Grade.WITHIN_TOLERANCE if compared.near else Grade.IDENTICAL
    return Verdict(grade, bool(changed))


def _without_decimals(reason: str) -> str:
    """Return a reason without decimal numbers, which may differ by rounding."""
    return _DECIMALS.sub("#", reason)

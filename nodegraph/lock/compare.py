"""How far a run agrees with a lock, result by result, and where it begins not to."""

from __future__ import annotations

import csv
import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

from nodegraph.execute import Run
from nodegraph.lock.lockfile import Lock
from nodegraph.lock.provenance import FileNames, account, file_names, short_unit, units_of
from nodegraph.lock.results import Cell, Recorded, Results, Said, cells_of, exact_of
from nodegraph.lock.sketch import Parts, Span
from nodegraph.plan import Step
from nodegraph.runs.changes import setting_changes
from nodegraph.runs.diff import Spread
from nodegraph.state import State

_AROUND_ALL = ("python", "platform")
"""Versions that every result may depend on."""


@dataclass(frozen=True)
class Change:
    """How a step is another than the one in a lock.

    Attributes
    ----------
    own : tuple of str
        What of the study itself is another: code of a method, settings, files, what feeds it.
    around : tuple of str
        What is another of what it stands on: versions of libraries, and of Python.
    """

    own: tuple[str, ...] = ()
    around: tuple[str, ...] = ()


class Explained:
    """Compares a run with the account in a lock.

    Parameters
    ----------
    lock
    run
        With a store, by which the code of its methods is known.
    """

    def __init__(self, lock: Lock, run: Run) -> None:
        self._was = lock.data
        self._run = run
        self._names = FileNames(run.plan.graph)
        self._now = account(run, self._names)

    def change(self, cell: Cell) -> Change:
        """Return how the step of a combination is another."""
        step = self._run.plan.steps[cell.index]
        was, now = (one["methods"].get(cell.group, {}) for one in (self._was, self._now))
        own = [
            *_used(was, now),
            *setting_changes(
                was.get("settings", {}), now.get("settings", {}), file_names(step, self._names)
            ),
            *self._axes(step),
            *self._files(step),
            *_fed(was.get("in", {}), now.get("in", {})),
            *self._code(step, was.get("code"), now.get("code")),
        ]
        return Change(tuple(own), tuple(self._versions(self._libraries(step))))

    def everywhere(self) -> Iterator[str]:
        """Yield what is another of the study as a whole: versions, and files' content."""
        yield from self._versions({**self._was["versions"], **self._now["versions"]})
        for name, digest in self._was["files"].items():
            if self._now["files"].get(name, digest) != digest:
                yield f"the content of {name} is another"

    @cached_property
    def same_syntax(self) -> bool:
        """Whether digests of code can be compared: each Python has a syntax of its own."""
        was, now = (one["versions"]["python"].split(".")[:2] for one in (self._was, self._now))
        return bool(was == now)

    def _axes(self, step: Step) -> Iterator[str]:
        for axis in step.labels:
            was, now = (one["axes"].get(axis) for one in (self._was, self._now))
            if was != now and isinstance(was, dict) and isinstance(now, dict):
                yield from (f"axis {axis}: {one}" for one in setting_changes(was, now))

    def _files(self, step: Step) -> Iterator[str]:
        was, now = self._was["files"], self._now["files"]
        for setting, name in file_names(step, self._names).items():
            known = [was[name]] if name in was else was.values()
            if now[name] not in known:
                yield f"{setting}: the content of {name} is another"

    def _code(self, step: Step, was: str | None, now: str | None) -> Iterator[str]:
        if was == now or not self.same_syntax:
            return
        edited = list(self._edited(step))
        yield from edited or ("its code was edited",)

    def _edited(self, step: Step) -> Iterator[str]:
        if self._run.cache is None:
            return
        for name, digest in self._run.cache.digest_of(step).code.units.items():
            module, _, unit = name.partition(":")
            known = self._units.get(module, {}).get(unit or module)
            if known is None:
                yield f"code: {name} is new to it"
            elif known != short_unit(digest):
                yield f"code: {name} was edited"

    @cached_property
    def _units(self) -> Mapping[str, Mapping[str, str]]:
        return {module: units_of(line) for module, line in self._was["code"].items()}

    def _libraries(self, step: Step) -> Mapping[str, str]:
        cache = self._run.cache
        reached = cache.digest_of(step).code.versions if cache is not None else {}
        return {**dict.fromkeys(_AROUND_ALL, ""), **reached}

    def _versions(self, names: Mapping[str, Any]) -> Iterator[str]:
        was, now = self._was["versions"], self._now["versions"]
        for name in names:
            if was.get(name) != now.get(name):
                yield f"{name} was {was.get(name, 'not used')}, now {now.get(name, 'not used')}"


def _used(was: Mapping[str, Any], now: Mapping[str, Any]) -> Iterator[str]:
    for name in ("use", "plugin"):
        if was and was.get(name) != now.get(name):
            yield f"{name} was {was.get(name)}, now {now.get(name)}"


def _fed(was: Mapping[str, Any], now: Mapping[str, Any]) -> Iterator[str]:
    yield from (f"input {one}" for one in setting_changes(was, now))


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
            said = f"was {was.ended or State.DONE}, now {ended or State.DONE}"
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


Grade_verdict = Literal["identical", "within tolerance", "same conclusions", "diverged"]


@dataclass(frozen=True)
class Verdict:
    """What a comparison comes to.

    Attributes
    ----------
    grade : str
        How far the results are those of the lock.
    turned : bool
        Whether the study concludes something else: a tie may turn with the last digit.
    """

    grade: Grade_verdict
    turned: bool = False

    @property
    def holds(self) -> bool:
        """Whether the study still gives its results, and the same conclusions."""
        return self.grade != "diverged" and not self.turned

    @property
    def text(self) -> str:
        """The verdict in a few words."""
        beside = self.turned and self.grade != "diverged"
        return f"{self.grade}, but conclusions changed" if beside else self.grade


def verdict(found: Compared, conclusions: bool, changed: Sequence[str]) -> Verdict:
    """Return what a comparison comes to.

    Results beyond the tolerance are put down to libraries and processors only if nothing of the
    study itself explains them: a method that was edited has diverged, whatever follows from it.

    Parameters
    ----------
    found
    conclusions
        Whether the study draws any.
    changed
        Conclusions that are others.
    """
    return Verdict(_grade(found, conclusions and not changed), bool(changed))


def _grade(found: Compared, concludes_the_same: bool) -> Grade_verdict:
    lone = found.only_locked or found.only_now
    if lone or any(one.change.own for one in found.origins):
        return "diverged"
    if found.origins or found.followers:
        return "same conclusions" if concludes_the_same else "diverged"
    return "within tolerance" if found.near else "identical"


Rows = list[list[str]]
"""The cells of a table, its head first."""

_LABELS = 3
"""Cells at the beginning of a row that are shown to say which one it is, at most."""


def conclusions_changed(was: Mapping[str, Any], said: Sequence[Said]) -> Iterator[str]:
    """Yield each conclusion that is no longer drawn, or was not before.

    Parameters
    ----------
    was
        As in a lock: sentences by the name of what says them.
    said
        By the run.
    """
    now = {one.name: list(one.sentences) for one in said if one.sentences}
    for name in {**was, **now}:
        before, here = was.get(name, []), now.get(name, [])
        yield from (f"{name}: no longer: {one}" for one in before if one not in here)
        yield from (f"{name}: now: {one}" for one in here if one not in before)


def numbers_changed(was: Mapping[str, str], said: Sequence[Said], least: float) -> Iterator[str]:
    """Yield for each table how many rows have other numbers, and the largest change.

    Parameters
    ----------
    was
        As in a lock: CSV by names.
    said
    least
        Relative size of a change that counts.
    """
    for one in said:
        if one.name in was:
            yield from (f"{one.name}: {text}" for text in _table(was[one.name], one.numbers, least))


def _table(was: str, now: str, least: float) -> Iterator[str]:
    before, here = (list(csv.reader(text.splitlines())) for text in (was, now))
    if before[:1] != here[:1]:
        heads = [", ".join(rows[0]) if rows else "none" for rows in (before, here)]
        yield f"had the columns {heads[0]}, now {heads[1]}"
    elif len(before) != len(here):
        yield f"had {len(before) - 1} rows, now {len(here) - 1}"
    else:
        width = max(map(len, before + here), default=0)
        yield from _rows(_filled(before, width), _filled(here, width), least)


def _filled(rows: Rows, width: int) -> Rows:
    """Return rows that are all of one width."""
    return [row + [""] * (width - len(row)) for row in rows]


def _rows(before: Rows, here: Rows, least: float) -> Iterator[str]:
    """Yield how many rows differ, and the cell that does most, if any do."""
    sizes = [max(map(_size, column)) for column in zip(*before[1:], strict=True)]
    rows: set[int] = set()
    largest, text = least, ""
    for place, (was, now) in enumerate(zip(before, here, strict=True)):
        for column, (one, other) in enumerate(zip(was, now, strict=True)):
            apart = _apart(one, other, sizes[column]) if one != other else 0.0
            if apart > least:
                rows.add(place)
            if apart > largest:
                labels = ", ".join(now[: min(column, _LABELS)])
                largest, text = apart, f"{before[0][column]} of {labels}: {one}, now {other}"
    if rows:
        yield f"{len(rows)} of {len(here) - 1} rows are others; most of all {text}"


def _apart(one: str, other: str, size: float) -> float:
    """Return how far two cells are apart in units of their column; infinity if not by numbers."""
    apart = abs(_number(one) - _number(other)) / (size or 1.0)
    return apart if math.isfinite(apart) else math.inf


def _size(cell: str) -> float:
    number = _number(cell)
    return abs(number) if math.isfinite(number) else 0.0


def _number(cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        return math.nan


_NAMED = 5


def where(lock: Lock, cell: Cell, results: Results) -> Iterator[str]:
    """Yield for each array of which the lock knows parts how its shape, or which parts, differ.

    Parameters
    ----------
    lock
    cell
        One that has a value, in the lock and in the run.
    results
        Of the run.
    """
    kept = {
        place: lines[cell.at]
        for place, lines in lock.parts.get(cell.group, {}).items()
        if cell.at in lines
    }
    if not kept:
        return
    most = max([1, *(one.size for was in kept.values() for one in was.sums)])
    found = results.parts(cell.index, most)
    for place, was in kept.items():
        if place in found:
            now, axes = found[place]
            least = lock.data["tolerance"] * lock.scales[cell.group].get(place, 1.0)
            yield from (f"{place}: {one}" for one in _differing(was, now, axes, least))


def _differing(
    was: Parts, now: Parts, axes: Sequence[tuple[str, tuple[str, ...]]], least: float
) -> Iterator[str]:
    if was.shape != now.shape:
        yield f"had the shape {_sizes(was.shape)}, now {_sizes(now.shape)}"
        return
    spans = was.apart(now, least)
    if any(spans):
        named = zip(spans, axes, was.shape, strict=False)
        yield "differs in " + ", of ".join(_named(*one) for one in named)


def _named(spans: list[Span], axis: tuple[str, tuple[str, ...]], members: int) -> str:
    whole = _listed(spans, *axis, members)
    most = [one for one in spans if one.most]
    if len(most) == len(spans):
        return whole
    return f"{whole} (most in {_listed(most, *axis, members)})"


def _listed(spans: list[Span], word: str, names: tuple[str, ...], members: int) -> str:
    runs = list(_joined(spans))
    places = [at for first, last in runs for at in range(first, last + 1)]
    several = f"{word}s" if len(places) > 1 else word
    if len(places) == members:
        return f"all {members} {several}"
    if names:
        more = f" and {len(places) - _NAMED} more" if len(places) > _NAMED else ""
        return f"{several} {', '.join(names[at] for at in places[:_NAMED])}{more}"
    if len(runs) > _NAMED:
        return f"{len(places)} {several} between {places[0]} and {places[-1]}"
    return f"{several} {', '.join(_run(*one) for one in runs)}"


def _joined(spans: list[Span]) -> Iterator[tuple[int, int]]:
    """Yield first and last of spans, as one where they touch."""
    if not spans:
        return
    first, last = spans[0].first, spans[0].last
    for one in spans[1:]:
        if one.first > last + 1:
            yield first, last
            first = one.first
        last = one.last
    yield first, last


def _run(first: int, last: int) -> str:
    return str(first) if first == last else f"{first} to {last}"


def _sizes(shape: tuple[int, ...]) -> str:
    return " x ".join(map(str, shape))

"""Where two runs differ first, and what explains it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

from nodegraph.equality import difference
from nodegraph.formatting import name_at
from nodegraph.plugin.hook_types import Comparison
from nodegraph.runs.changes import code_changed, recorded_sources, settings_changed, sources_changed
from nodegraph.runs.saved_run import FinishedRun
from nodegraph.state import State
from nodegraph.store import Store

_Found = TypeVar("_Found")


@dataclass
class Spread(Generic[_Found]):
    """Combinations with another result, sorted into origins and followers.

    Attributes
    ----------
    origins : list
        What was found of combinations with another result although what feeds them has the same,
        or whose step itself is another; in the order of the graph.
    followers : Counter of str
        How many further combinations of each node have another result.
    """

    origins: list[_Found] = field(default_factory=list)
    followers: Counter[str] = field(default_factory=Counter)
    _steps: set[int] = field(default_factory=set, repr=False, compare=False, kw_only=True)

    @property
    def beyond(self) -> int:
        """Combinations with another result."""
        return len(self.origins) + self.followers.total()

    def reaches(self, needed: Iterable[int]) -> bool:
        """Whether any of these steps has another result."""
        return not self._steps.isdisjoint(needed)

    def add(
        self, found: _Found, node: str, step: int, needed: Collection[int], *, changed: bool
    ) -> None:
        """Sort in a combination with another result, after all that feeds it.

        Parameters
        ----------
        found
            What is kept of it if the difference begins with it.
        node
        step, needed
            Number of its step, and of those that feed it. A step may stand for several
            combinations, and is no source of itself.
        changed
            Whether the step itself is another.
        """
        if self.reaches(needed) and not changed:
            self.followers[node] += 1
        else:
            self.origins.append(found)
        self._steps.add(step)


RecordedStep = Mapping[str, Any]
_Cell = tuple[str, tuple[tuple[str, str], ...]]


@dataclass(frozen=True)
class Pair:
    """One combination of one node in both runs.

    Attributes
    ----------
    node : str
    labels : mapping of axis to label
    was, now : mapping
        Its step in either record.
    changes : tuple of str
        How the step itself is another; empty where only what feeds it is.
    """

    node: str
    labels: Mapping[str, Any]
    was: RecordedStep
    now: RecordedStep
    changes: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Node and labels: ``fill(fill=muscle, length=5)``."""
        return name_at(self.node, self.labels)

    @property
    def both_done(self) -> bool:
        """Whether both steps have a result."""
        return _has_result(self.was) and _has_result(self.now)


@dataclass
class Differences(Spread[Pair]):
    """What two runs do not share.

    Attributes
    ----------
    origins, followers
        Combinations with another result: those with which the difference begins, and the rest.
    equal, unknown : int
        Combinations with the same result, and those of which a run kept no digest.
    harmless : list of Pair
        Combinations with the same result although the step itself is another.
    only_was, only_now : Counter of str
        How many combinations of each node only one of the runs has.
    """

    equal: int = 0
    unknown: int = 0
    harmless: list[Pair] = field(default_factory=list)
    only_was: Counter[str] = field(default_factory=Counter)
    only_now: Counter[str] = field(default_factory=Counter)

    @property
    def same(self) -> bool:
        """Whether the runs have the same combinations, all with the same results."""
        return not (self.beyond or self.unknown or self.lone)

    @property
    def lone(self) -> int:
        """Combinations that only one of the runs has."""
        return self.only_was.total() + self.only_now.total()


def differences(was: FinishedRun, now: FinishedRun, store: Store) -> Differences:
    """Compare two finished runs step by step, by the digests of their results.

    Parameters
    ----------
    was, now
        Of one graph, or of two whose nodes have the same names.
    store
        Knows the digests of results that a run did not need to look at.
    """
    before, after = _by_cell(was.record), _by_cell(now.record)
    found = Differences(
        only_was=Counter(node for node, _ in before.keys() - after.keys()),
        only_now=Counter(node for node, _ in after.keys() - before.keys()),
    )
    how = _HowChanged(was.record, now.record)
    for cell in (one for one in after if one in before):
        pair = Pair(cell[0], _labels(after[cell], cell[0]), before[cell], after[cell])
        _sort_in(found, pair, _same_result(pair.was, pair.now, store), how)
    return found


def _sort_in(found: Differences, pair: Pair, same: bool | None, how: _HowChanged) -> None:
    if same is None:
        found.unknown += 1
        return
    pair = Pair(pair.node, pair.labels, pair.was, pair.now, tuple(how.changes(pair)))
    if not same:
        needed, changed = list(_needed(pair.now)), bool(pair.changes)
        found.add(pair, pair.node, pair.now["step"], needed, changed=changed)
        return
    found.equal += 1
    if pair.changes:
        found.harmless.append(pair)


def _same_result(was: RecordedStep, now: RecordedStep, store: Store) -> bool | None:
    """Return whether two steps ended alike, or None where that is not known."""
    if not (_has_result(was) and _has_result(now)):
        return was["state"] == now["state"] and was.get("reason") == now.get("reason")
    if was.get("key") and was.get("key") == now.get("key"):
        return True
    one, other = (_digests(step, store) for step in (was, now))
    return one == other if one and other else None


def _has_result(step: RecordedStep) -> bool:
    return State(step["state"]).has_value


def _digests(step: RecordedStep, store: Store) -> tuple[str, ...]:
    entry = store.find(step["key"]) if step.get("key") and not step.get("digests") else None
    return entry.digests if entry else tuple(step.get("digests", ()))


class _HowChanged:
    """Says how a step of one run is another in the other run."""

    def __init__(self, was: Mapping[str, Any], now: Mapping[str, Any]) -> None:
        self._was, self._now = was, now
        self._steps = tuple({one["step"]: one for one in run["steps"]} for run in (was, now))

    def changes(self, pair: Pair) -> Iterator[str]:
        was, now = pair.was, pair.now
        if _has_result(was) != _has_result(now):
            yield f"was {_ended(was)}, now {_ended(now)}"
        if was["use"] != now["use"]:
            yield f"used {was['use']}, now {now['use']}"
            return
        files = {*was.get("files", {}), *now.get("files", {})}
        yield from settings_changed(was["settings"], now["settings"], files)
        for name in sorted(files):
            if was.get("files", {}).get(name) != now.get("files", {}).get(name):
                yield f"{name}: the content of {now['settings'].get(name)} is another"
        sources = (recorded_sources(*one) for one in zip((was, now), self._steps, strict=True))
        yield from sources_changed(*sources)
        yield from code_changed(_code(self._was, was), _code(self._now, now))


def _code(record: Mapping[str, Any], step: RecordedStep) -> Mapping[str, Any]:
    methods = record["nodes"][step["node"]]["methods"].values()
    plugin = next(one["plugin"] for one in methods if one["use"] == step["use"])
    found: Mapping[str, Any] = record.get("code", {}).get(f"{plugin}:{step['use']}", {})
    return found


def _ended(step: RecordedStep) -> str:
    return f"{step['state']} ({step['reason']})" if step.get("reason") else str(step["state"])


def _by_cell(record: Mapping[str, Any]) -> dict[_Cell, RecordedStep]:
    """Return the step of each combination of each node."""
    return {
        (one["node"], _cell_labels(one["labels"])): step
        for step in record["steps"]
        for one in (step, *step.get("also", ()))
    }


def _labels(step: RecordedStep, node: str) -> Mapping[str, Any]:
    found: Mapping[str, Any] = next(
        one["labels"] for one in (step, *step.get("also", ())) if one["node"] == node
    )
    return found


def _cell_labels(labels: Mapping[str, Any]) -> tuple[tuple[str, str], ...]:
    return tuple(sorted((axis, str(label)) for axis, label in labels.items()))


def _needed(step: RecordedStep) -> Iterator[int]:
    for fed in step["inputs"].values():
        yield from (one["step"] for one in (fed if isinstance(fed, list) else [fed]))


def told_apart(one: Any, other: Any, comparisons: Iterable[Comparison]) -> tuple[str, ...]:
    """Return a sentence per difference of two values; nothing where they are the same.

    Parameters
    ----------
    one, other
        Of any type.
    comparisons
        Those that plugins bring; the first that fits says it. What none of them tells apart is
        compared part by part.
    """
    fitting = (kind for kind in comparisons if isinstance(one, kind.type))
    said = next((tuple(kind.compare(one, other)) for kind in fitting if _alike(kind, other)), ())
    rest = difference(one, other)
    return said or ((rest,) if rest else ())


def _alike(kind: Comparison, value: Any) -> bool:
    return isinstance(value, kind.type)

"""The first difference between two runs, and its explanation."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import Generic, TypeVar

from nodegraph.equality import difference
from nodegraph.formatting import name_at
from nodegraph.plugin.hook_types import Comparison
from nodegraph.runs.changes import (
    code_changes,
    file_change,
    recorded_sources,
    setting_changes,
    source_changes,
)
from nodegraph.runs.record import Labels, Record, RecordedCode, RecordedStep
from nodegraph.store import Store

_T = TypeVar("_T")
_Cell = tuple[str, tuple[tuple[str, str], ...]]


@dataclass
class Spread(Generic[_T]):
    """Combinations with another result, sorted into origins and followers.

    Attributes
    ----------
    origins : list
        Combinations whose inputs have the same results, or whose step changed in another way than
        the steps that feed it; in the order of the graph.
    followers : Counter of str
        How many further combinations of each node have another result.
    """

    origins: list[_T] = field(default_factory=list)
    followers: Counter[str] = field(default_factory=Counter)
    _steps: dict[int, frozenset[str]] = field(
        default_factory=dict, repr=False, compare=False, kw_only=True
    )

    @property
    def beyond(self) -> int:
        """The number of combinations with another result."""
        return len(self.origins) + self.followers.total()

    def reaches(self, needed: Iterable[int]) -> bool:
        """Return whether any of these steps has another result."""
        return not self._steps.keys().isdisjoint(needed)

    def add(
        self, origin: _T, node: str, step: int, needed: Collection[int], changes: Collection[str]
    ) -> None:
        """Add a combination with another result, after all that feeds it.

        Parameters
        ----------
        origin
            What to keep of it if the difference begins with it.
        node
        step, needed
            Its step, and the steps that feed it. A step may stand for several combinations.
        changes
            How the step itself changed.
        """
        before = {text for index in needed for text in self._steps.get(index, ())}
        if self.reaches(needed) and before.issuperset(changes):
            self.followers[node] += 1
        else:
            self.origins.append(origin)
        self._steps[step] = frozenset(before.union(changes))


@dataclass(frozen=True)
class Pair:
    """A combination of a node in both runs.

    Attributes
    ----------
    node : str
    labels : dict of axis to label
    was, now : RecordedStep
    changes : tuple of str
        How the step changed; empty if only its inputs did.
    """

    node: str
    labels: Labels
    was: RecordedStep
    now: RecordedStep
    changes: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Node and labels: ``fill(fill=muscle, length=5)``."""
        return name_at(self.node, self.labels)

    @property
    def have_results(self) -> bool:
        """Whether both steps have a result."""
        return self.was.has_result and self.now.has_result


@dataclass
class Differences(Spread[Pair]):
    """The differences of two runs.

    Attributes
    ----------
    origins, followers
        Combinations with another result: those with which the difference begins, and the rest.
    equal, unknown : int
        Combinations with the same result, and those without a digest in one of the runs.
    harmless : list of Pair
        Combinations with the same result although the step changed.
    only_was, only_now : Counter of str
        How many combinations of each node are in one of the runs only.
    """

    equal: int = 0
    unknown: int = 0
    harmless: list[Pair] = field(default_factory=list)
    only_was: Counter[str] = field(default_factory=Counter)
    only_now: Counter[str] = field(default_factory=Counter)

    @property
    def same(self) -> bool:
        """Whether the runs have the same combinations, all with the same results."""
        unpaired = self.only_was.total() + self.only_now.total()
        return not (self.beyond or self.unknown or unpaired)


def differences(was: Record, now: Record, store: Store) -> Differences:
    """Compare two runs step by step, by the digests of their results.

    Parameters
    ----------
    was, now
        Runs of one graph, or of two graphs whose nodes have the same names.
    store
        Has the digests of results that a run did not load.
    """
    before, after = _by_cell(was), _by_cell(now)
    result = Differences(
        only_was=Counter(cell[0] for cell in before if cell not in after),
        only_now=Counter(cell[0] for cell in after if cell not in before),
    )
    changes = _Changes(was, now)
    for cell, (labels, step) in after.items():
        if cell not in before:
            continue
        pair = Pair(cell[0], labels, before[cell][1], step)
        same = _same_result(pair.was, pair.now, store)
        if same is None:
            result.unknown += 1
            continue
        pair = replace(pair, changes=tuple(changes.of(pair)))
        if not same:
            needed = [source.step for _, sources in step.sources() for source in sources]
            result.add(pair, pair.node, step.step, needed, pair.changes)
            continue
        result.equal += 1
        if pair.changes:
            result.harmless.append(pair)
    return result


def _by_cell(record: Record) -> dict[_Cell, tuple[Labels, RecordedStep]]:
    """Return labels and step of each combination of each node."""
    return {
        (cell.node, tuple(sorted((axis, str(label)) for axis, label in cell.labels.items()))): (
            cell.labels,
            step,
        )
        for step in record.steps
        for cell in step.cells
    }


def _same_result(was: RecordedStep, now: RecordedStep, store: Store) -> bool | None:
    """Return whether two steps ended alike, or None if that is unknown."""
    if not (was.has_result and now.has_result):
        return was.state == now.state and was.reason == now.reason
    if was.key and was.key == now.key:
        return True
    digests = [_digests(step, store) for step in (was, now)]
    return digests[0] == digests[1] if all(digests) else None


def _digests(step: RecordedStep, store: Store) -> tuple[str, ...]:
    entry = store.find(step.key) if step.key and not step.digests else None
    return entry.digests if entry else tuple(step.digests)


class _Changes:
    """The changes of the steps of one run in another."""

    def __init__(self, was: Record, now: Record) -> None:
        self._was, self._now = was, now
        self._steps_was = {step.step: step for step in was.steps}
        self._steps_now = {step.step: step for step in now.steps}

    def of(self, pair: Pair) -> Iterator[str]:
        was, now = pair.was, pair.now
        if was.has_result != now.has_result:
            yield f"was {_ending(was)}, now {_ending(now)}"
        if was.use != now.use:
            yield f"used {was.use}, now {now.use}"
            return
        files = {*was.files, *now.files}
        yield from setting_changes(was.settings, now.settings, files)
        for name in sorted(files):
            if was.files.get(name) != now.files.get(name):
                yield file_change(name, was.settings.get(name), now.settings.get(name))
        yield from source_changes(
            recorded_sources(was, self._steps_was), recorded_sources(now, self._steps_now)
        )
        yield from code_changes(_code(self._was, was), _code(self._now, now))


def _code(record: Record, step: RecordedStep) -> RecordedCode:
    return record.code.get(f"{record.method(step).plugin}:{step.use}", RecordedCode())


def _ending(step: RecordedStep) -> str:
    return f"{step.state} ({step.reason})" if step.reason else step.state


def value_differences(
    value: object, other: object, comparisons: Iterable[Comparison]
) -> tuple[str, ...]:
    """Return a sentence per difference of two values; nothing if they are equal.

    Parameters
    ----------
    value, other
    comparisons
        Those of plugins. The first that fits both values is used; if it reports nothing, the
        values are compared part by part.
    """
    fitting = (
        comparison
        for comparison in comparisons
        if isinstance(value, comparison.type) and isinstance(other, comparison.type)
    )
    first = next(fitting, None)
    sentences = tuple(first.compare(value, other)) if first else ()
    rest = difference(value, other)
    return sentences or ((rest,) if rest else ())

"""What differs between two records of one graph: which steps, how they changed, where it begins."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property
from typing import Any

from nodegraph.equality import change, difference
from nodegraph.formatting import labels_of
from nodegraph.plugin.hook_results import HookResults
from nodegraph.runs.record import Cell, Record, RecordedCode, RecordedStep
from nodegraph.state import State
from nodegraph.store import Store

_AROUND_ALL = ("python", "platform")
"""Versions on which every result may depend."""


class Agreement(StrEnum):
    """The agreement of two results of a combination.

    Those that are the same but for the drawing of a picture are redrawn.
    """

    SAME = "same"
    REDRAWN = "redrawn"
    NEAR = "near"
    OTHER = "other"
    UNKNOWN = "unknown"


@dataclass(frozen=True)
class StepChange:
    """How a step changed between two runs.

    Attributes
    ----------
    own : tuple of str
        Its method, settings, files, sources and code.
    around : tuple of str
        Versions of the distributions that its code reaches, of Python and of the platform.
    """

    own: tuple[str, ...] = ()
    around: tuple[str, ...] = ()


@dataclass(frozen=True)
class Pair:
    """A combination in two records.

    Attributes
    ----------
    cell : Cell
    was, now : RecordedStep
    records : (Record, Record)
    feeds : set of Agreement
        How the results that feed it agree.
    """

    cell: Cell
    was: RecordedStep
    now: RecordedStep
    records: tuple[Record, Record] = field(repr=False, compare=False)
    feeds: frozenset[Agreement] = frozenset()

    @property
    def follows(self) -> bool:
        """Whether something that feeds it has another result."""
        return Agreement.OTHER in self.feeds

    @cached_property
    def change(self) -> StepChange:
        """How its step changed."""
        return changes(*self.records, self.was, self.now)


@dataclass(frozen=True)
class Judged:
    """The agreement of two results.

    Attributes
    ----------
    agreement : Agreement
    distance : float
        Root mean square difference relative to the usual size; 0 if unknown.
    text : str
        Further differences.
    """

    agreement: Agreement
    distance: float = 0.0
    text: str = ""


Judge = Callable[[Pair], Judged]
"""Compares the results of a combination."""


@dataclass
class Agreements:
    """The agreement of all combinations of two records.

    Attributes
    ----------
    counts : Counter of Agreement
    origins : list of (Pair, Judged)
        Combinations with which differences begin: those with the same results of all that feeds
        them, with a change that none of those has, or that failed or were refused in one run only.
    followers : Counter of str
        How many further combinations of each node have another result.
    near : list of (Pair, Judged)
    redrawn, unknown : Counter of str
        How many combinations of each node.
    alike : list of Pair
        Combinations with the same result.
    endings : Counter of str
        How many combinations without a result ended in the same way, by their state.
    only_was, only_now : list of Cell
        Combinations of one record only.
    """

    counts: Counter[Agreement] = field(default_factory=Counter)
    origins: list[tuple[Pair, Judged]] = field(default_factory=list)
    followers: Counter[str] = field(default_factory=Counter)
    near: list[tuple[Pair, Judged]] = field(default_factory=list)
    redrawn: Counter[str] = field(default_factory=Counter)
    unknown: Counter[str] = field(default_factory=Counter)
    alike: list[Pair] = field(default_factory=list)
    endings: Counter[str] = field(default_factory=Counter)
    only_was: list[Cell] = field(default_factory=list)
    only_now: list[Cell] = field(default_factory=list)

    @property
    def same(self) -> int:
        """The number of combinations with the same result."""
        return self.counts[Agreement.SAME] + self.counts[Agreement.REDRAWN]

    @property
    def compared(self) -> int:
        """The number of combinations whose results are known in both records."""
        return self.counts.total() - self.counts[Agreement.UNKNOWN]

    @property
    def beyond(self) -> int:
        """The number of combinations with another result."""
        return self.counts[Agreement.OTHER]

    @property
    def is_equal(self) -> bool:
        """Whether both have the same combinations, all with the same results."""
        return not (self.only_was or self.only_now) and self.same == self.counts.total()

    @property
    def harmless(self) -> Counter[str]:
        """How many combinations of each node have the same result although the step changed."""
        return Counter(pair.cell.node for pair in self.alike if pair.change.own)

    def by_change(self) -> list[list[tuple[Pair, Judged]]]:
        """Return the origins of a node that changed in the same way together, in their order."""
        groups: dict[tuple[str, StepChange, str], list[tuple[Pair, Judged]]] = {}
        for pair, judged in self.origins:
            same = (pair.cell.node, pair.change, judged.text)
            groups.setdefault(same, []).append((pair, judged))
        return list(groups.values())


def compare(was: Record, now: Record, judge: Judge) -> Agreements:
    """Compare the results of two runs of one graph, or of graphs whose nodes have the same names.

    Parameters
    ----------
    was, now
    judge
        Called for every combination that both have, after those that feed it.
    """
    before = {cell.key: (cell, step) for step in was.steps for cell in step.cells}
    agreements = Agreements()
    ended: dict[int, tuple[Agreement, frozenset[str]]] = {}
    for step in now.steps:
        needed = {source.step for _, sources in step.sources() for source in sources}
        feeds = frozenset(ended[index][0] for index in needed if index in ended)
        known = frozenset(text for index in needed if index in ended for text in ended[index][1])
        for cell in step.cells:
            if cell.key not in before:
                agreements.only_now.append(cell)
                continue
            pair = Pair(cell, before.pop(cell.key)[1], step, (was, now), feeds)
            judged = judge(pair)
            own = _add(agreements, pair, judged, known)
            ended[step.step] = (judged.agreement, own)
    agreements.only_was = [cell for cell, _ in before.values()]
    return agreements


def _add(
    agreements: Agreements, pair: Pair, judged: Judged, known: frozenset[str]
) -> frozenset[str]:
    """Add a combination; return the changes that explain it and what feeds it, if it differs."""
    node, agreement = pair.cell.node, judged.agreement
    agreements.counts[agreement] += 1
    if agreement is Agreement.OTHER:
        if pair.follows and known.issuperset(pair.change.own) and not _ended_otherwise(pair):
            agreements.followers[node] += 1
        else:
            agreements.origins.append((pair, judged))
        return known.union(pair.change.own)
    if agreement is Agreement.UNKNOWN:
        agreements.unknown[node] += 1
        return frozenset()
    if agreement is Agreement.NEAR:
        agreements.near.append((pair, judged))
        return frozenset()
    if agreement is Agreement.REDRAWN:
        agreements.redrawn[node] += 1
    if not pair.now.has_result:
        agreements.endings[pair.now.state] += 1
    agreements.alike.append(pair)
    return frozenset()


def _ended_otherwise(pair: Pair) -> bool:
    """Whether a step failed, or refused its input, in one of two runs."""
    states = {pair.was.state, pair.now.state}
    return len(states) > 1 and not states.isdisjoint((State.FAILED, State.REFUSED))


def choices(was: Record, now: Record) -> Iterator[str]:
    """Yield a text per input, and per axis, with another value."""
    kinds: tuple[tuple[str, Mapping[str, Any], Mapping[str, Any], Callable[[Any], str]], ...] = (
        ("input", was.inputs, now.inputs, str),
        ("axis", was.axes, now.axes, _labels),
    )
    for kind, before, after, text in kinds:
        for name in {**before, **after}:
            if name not in before:
                yield f"{kind} {name} is new: {text(after[name])}"
            elif name not in after:
                yield f"{kind} {name} is gone, it was {text(before[name])}"
            elif before[name] != after[name]:
                yield f"{kind} {name} was {text(before[name])}, now {text(after[name])}"


def _labels(labels: Iterable[object]) -> str:
    """Return labels as text: ``(5, 15)``."""
    return f"({', '.join(map(str, labels))})"


def by_digest(store: Store) -> Judge:
    """Return a judge by how steps ended, and by the digests of their results.

    Parameters
    ----------
    store
        Has the digests of results that a run did not load.
    """

    def judge(pair: Pair) -> Judged:
        was, now = pair.was, pair.now
        if not (was.has_result and now.has_result):
            if was.ending == now.ending:
                return Judged(Agreement.SAME)
            return Judged(Agreement.OTHER, text=f"was {_bracketed(was)}, now {_bracketed(now)}")
        if was.key and was.key == now.key:
            return Judged(Agreement.SAME)
        before, after = (digests_of(step, store) for step in (was, now))
        if not (before and after):
            return Judged(Agreement.UNKNOWN)
        return Judged(Agreement.SAME if before == after else Agreement.OTHER)

    return judge


def digests_of(step: RecordedStep, store: Store) -> tuple[str, ...]:
    """Return the digests of what a step gave; empty where they are not known.

    Parameters
    ----------
    step
    store
        Has those of results that the run did not load.
    """
    entry = store.find(step.key) if step.key and not step.digests else None
    return entry.digests if entry else tuple(step.digests)


def _bracketed(step: RecordedStep) -> str:
    return f"{step.state} ({step.reason})" if step.reason else step.state


def changes(was: Record, now: Record, step_was: RecordedStep, step_now: RecordedStep) -> StepChange:
    """Return how a step of one record changed in another."""
    methods = was.method(step_was), now.method(step_now)
    codes = (was.code.get(methods[0].full_name), now.code.get(methods[1].full_name))
    if methods[0].use != methods[1].use:
        return StepChange((f"used {methods[0].use}, now {methods[1].use}",))
    own: list[str] = []
    if methods[0].plugin != methods[1].plugin:
        own.append(f"plugin was {methods[0].plugin}, now {methods[1].plugin}")
    own += _setting_changes(step_was, step_now)
    if step_was.inputs and step_now.inputs:  # a lock has none: its graph decides them
        own += _source_changes(_sources(was, step_was), _sources(now, step_now))
    own += _code_changes(was, now, *codes)
    names = dict.fromkeys(_AROUND_ALL)
    names |= dict.fromkeys(name for code in codes if code for name in code.distributions)
    return StepChange(tuple(own), tuple(version_changes(was.versions, now.versions, names)))


def version_changes(
    was: Mapping[str, str], now: Mapping[str, str], names: Iterable[str]
) -> Iterator[str]:
    """Yield a text per version that is another."""
    for name in names:
        if was.get(name) != now.get(name):
            yield f"{name} was {was.get(name, 'not used')}, now {now.get(name, 'not used')}"


def _setting_changes(was: RecordedStep, now: RecordedStep) -> Iterator[str]:
    """Yield a text per setting with another value, and per file with another content."""
    for name in {**was.settings, **now.settings}:
        before, after = was.settings.get(name), now.settings.get(name)
        if name in was.files or name in now.files:
            if was.files.get(name) == now.files.get(name):
                continue
            if before == after:
                yield f"{name}: the content of {after} changed"
                continue
        if before != after:
            yield f"{name} was {before!r}, now {after!r}"


def _sources(record: Record, step: RecordedStep) -> dict[str, tuple[str, ...]]:
    """Return a text for each source of each port: ``fill.output as fill=muscle``."""
    steps = record.by_index
    return {
        port: tuple(
            f"{steps[source.step].node}.{source.output}"
            + (f" as {labels_of(source.labels)}" if source.labels else "")
            for source in sources
        )
        for port, sources in step.sources()
    }


def _source_changes(
    was: Mapping[str, tuple[str, ...]], now: Mapping[str, tuple[str, ...]]
) -> Iterator[str]:
    """Yield a text per port that is fed by something else."""
    for port in {**was, **now}:
        before, after = was.get(port, ()), now.get(port, ())
        if len(before) != len(after):
            yield f"{port} took {len(before)} values, now {len(after)}"
        else:
            pairs = zip(before, after, strict=True)
            first = next((pair for pair in pairs if pair[0] != pair[1]), None)
            if first is not None:
                yield f"{port} took {first[0]}, now {first[1]}"


def _code_changes(
    was: Record, now: Record, code_was: RecordedCode | None, code_now: RecordedCode | None
) -> Iterator[str]:
    """Yield a text per module that was edited, if both records have the code."""
    if code_was is None or code_now is None or not same_syntax(was, now):
        return
    for name in dict.fromkeys([*code_was.units, *code_now.units]):
        if name not in code_was.units:
            yield f"code: {name} was not used before"
        elif name not in code_now.units:
            yield f"code: {name} is no longer used"
        elif was.units.get(name) != now.units.get(name):
            yield f"code: {name} was edited"


def same_syntax(was: Record, now: Record) -> bool:
    """Whether digests of code can be compared: they depend on the version of Python."""
    before, after = (each.versions.get("python", "").split(".")[:2] for each in (was, now))
    return before == after


def value_differences(value: object, other: object, hooks: HookResults) -> tuple[str, ...]:
    """Return a sentence per difference of two values; nothing if they are equal.

    Parameters
    ----------
    value, other
    hooks
        The hooks of plugins. If none describes a difference, the values are compared part by part.
    """
    rest = difference(value, other)
    return _described(value, other, hooks) or ((rest,) if rest else ())


def output_differences(
    was: Mapping[str, object], now: Mapping[str, object], hooks: HookResults
) -> list[str]:
    """Return a sentence per difference of the outputs of a step.

    They are compared part by part only if no plugin describes a difference of any of them.

    Parameters
    ----------
    was, now
        By the names of outputs.
    hooks
        The hooks of plugins.
    """
    both = [(name, was[name], now[name]) for name in was if name in now]
    prefix = {name: f"{name}: " if len(both) > 1 else "" for name in was}
    described = [
        f"{prefix[name]}{text}"
        for name, value, other in both
        for text in _described(value, other, hooks)
    ]
    return described or [
        text for name, value, other in both if (text := change(value, other, name=name))
    ]


def _described(value: object, other: object, hooks: HookResults) -> tuple[str, ...]:
    kind = hooks.kind(type(value), "compare")
    if kind is None or kind.compare is None or not isinstance(other, kind.type):
        return ()
    return tuple(kind.compare(value, other))

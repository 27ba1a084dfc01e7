"""``nodegraph diff``."""

from __future__ import annotations

from argparse import Namespace
from collections import Counter
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from nodegraph.cli.common import MOST, counted, few, first_and_more, say

if TYPE_CHECKING:
    from nodegraph.plugin.registry import Registry
    from nodegraph.runs.diff import Differences, Pair
    from nodegraph.runs.saved_run import FinishedRun
    from nodegraph.store import Store


def diff(arguments: Namespace) -> int:
    """Print where two runs differ first, by how much, and what explains it; 1 if they do."""
    from nodegraph.execute import open_store
    from nodegraph.plugin.registry import Registry
    from nodegraph.runs.diff import differences
    from nodegraph.runs.saved_run import FinishedRun

    was, now = FinishedRun(arguments.run), FinishedRun(arguments.other)
    registry = Registry.installed(arguments.plugin)
    store = open_store(registry, arguments.store, say)
    found = differences(was, now, store)
    print(_summary(found, f"{arguments.run} and {arguments.other}"))
    for line in (*_asked(was.record, now.record), *_alone(found, arguments)):
        print(line)
    for pairs in _by_change(found.origins):
        first = pairs[0]
        print(f"\n{first_and_more(first.name, len(pairs), first.node)}")
        for line in (*_explained(first), *_values(first, now, registry, store)):
            print(f"    {line}")
    for line in _rest(found):
        print(f"\n{line}")
    return 0 if found.same else 1


def _summary(found: Differences, names: str) -> str:
    if found.same:
        return f"{names}: all {found.equal} combinations have the same results"
    unknown = f", {found.unknown} not known (their results were not stored)"
    return f"{names}: {found.beyond} combinations differ, {found.equal} have the same results" + (
        unknown if found.unknown else ""
    )


def _asked(was: Mapping[str, Any], now: Mapping[str, Any]) -> Iterator[str]:
    """Yield what was asked for otherwise, of the graph as a whole."""
    for part, called in (("inputs", "input"), ("axes", "axis")):
        for name in {**was[part], **now[part]}:
            one, other = was[part].get(name), now[part].get(name)
            if one != other:
                yield f"{called} {name} was {one}, now {other}"


def _alone(found: Differences, arguments: Namespace) -> Iterator[str]:
    for run, counts in ((arguments.run, found.only_was), (arguments.other, found.only_now)):
        if counts:
            yield f"only in {run}: {counted(counts)}"


def _by_change(pairs: list[Pair]) -> list[list[Pair]]:
    """Return pairs of one node that changed in the same way together, the first first."""
    groups: dict[tuple[str, tuple[str, ...]], list[Pair]] = {}
    for pair in pairs:
        groups.setdefault((pair.node, pair.changes), []).append(pair)
    return list(groups.values())


def _explained(pair: Pair) -> Iterator[str]:
    if not pair.changes:
        yield "settings, code and what feeds it are the same: it does not give one answer"
    yield from few(pair.changes, "changes")


def _values(pair: Pair, run: FinishedRun, registry: Registry, store: Store) -> Iterator[str]:
    """Yield how the outputs of the two steps differ, as far as they are stored."""
    from nodegraph.runs.diff import told_apart

    if not pair.both_done:
        return
    one, other = _loaded(pair.was, store), _loaded(pair.now, store)
    if not one or not other:
        yield "its values are no longer stored, and cannot be compared"
        return
    for name, before, here in zip(run.outputs(pair.now), one, other, strict=False):
        said = told_apart(before, here, registry.hooks.comparisons)
        yield from (f"{name}: {text}" if len(one) > 1 else text for text in said[:MOST])


def _loaded(step: Mapping[str, Any], store: Store) -> tuple[Any, ...]:
    from nodegraph.store import DamagedEntry

    entry = store.find(step["key"]) if step.get("key") else None
    try:
        return store.load(entry) if entry else ()
    except DamagedEntry:
        return ()


def _rest(found: Differences) -> Iterator[str]:
    if found.followers:
        yield f"what follows from that: {counted(found.followers)}"
    if found.harmless:
        changed = Counter(pair.node for pair in found.harmless)
        yield f"changed, with the same results: {counted(changed)}"

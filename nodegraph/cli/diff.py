"""``nodegraph diff``: where two runs differ first, and why."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph.cli.arguments import add_plugin, add_run, add_store
from nodegraph.cli.output import MOST, counted, few, first_and_more, say

if TYPE_CHECKING:
    from nodegraph.plugin.registry import Registry
    from nodegraph.runs.diff import Differences, Pair
    from nodegraph.runs.record import Record
    from nodegraph.store import Store

HELP = "Show where two runs differ first, and why; exit with status 1 if they differ."


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    add_run(parser)
    parser.add_argument("other", type=Path, metavar="RUN", help="Folder of another run.")
    add_plugin(parser)
    add_store(parser)


def diff(arguments: Namespace) -> int:
    """Print where two runs differ first, by how much, and what explains it."""
    from nodegraph.execute import open_store
    from nodegraph.plugin.registry import Registry
    from nodegraph.runs.diff import differences
    from nodegraph.runs.record_files import read_record

    was, now = read_record(arguments.run), read_record(arguments.other)
    registry = Registry.installed(arguments.plugin)
    store = open_store(registry, arguments.store, say)
    result = differences(was, now, store)
    print(_summary(result, f"{arguments.run} and {arguments.other}"))
    for line in _choices(was, now):
        print(line)
    for run, counts in ((arguments.run, result.only_was), (arguments.other, result.only_now)):
        if counts:
            print(f"only in {run}: {counted(counts)}")
    for pairs in _by_change(result.origins):
        first = pairs[0]
        print(f"\n{first_and_more(first.name, len(pairs), first.node)}")
        for line in (*_changes(first), *_values(first, now, registry, store)):
            print(f"    {line}")
    if result.followers:
        print(f"\nwhat follows from that: {counted(result.followers)}")
    if result.harmless:
        changed = Counter(pair.node for pair in result.harmless)
        print(f"\nchanged, with the same results: {counted(changed)}")
    return 0 if result.same else 1


def _summary(result: Differences, names: str) -> str:
    if result.same:
        return f"{names}: all {result.equal} combinations have the same results"
    unknown = f", {result.unknown} are unknown (their results were not stored)"
    differ = "combination differs" if result.beyond == 1 else "combinations differ"
    return f"{names}: {result.beyond} {differ}, {result.equal} have the same results" + (
        unknown if result.unknown else ""
    )


def _choices(was: Record, now: Record) -> Iterator[str]:
    """Yield each input and axis with another value."""
    kinds = (("input", was.inputs, now.inputs), ("axis", was.axes, now.axes))
    for kind, before, after in kinds:
        for name in {**before, **after}:
            if name not in before:
                yield f"{kind} {name} is new: {after[name]}"
            elif name not in after:
                yield f"{kind} {name} is gone, it was {before[name]}"
            elif before[name] != after[name]:
                yield f"{kind} {name} was {before[name]}, now {after[name]}"


def _by_change(pairs: list[Pair]) -> list[list[Pair]]:
    """Return the pairs of a node that changed in the same way together, in their order."""
    groups: dict[tuple[str, tuple[str, ...]], list[Pair]] = {}
    for pair in pairs:
        groups.setdefault((pair.node, pair.changes), []).append(pair)
    return list(groups.values())


def _changes(pair: Pair) -> Iterator[str]:
    if not pair.changes:
        yield "settings, code and inputs are the same: the method gives different results"
    yield from few(pair.changes, "changes")


def _values(pair: Pair, now: Record, registry: Registry, store: Store) -> Iterator[str]:
    """Yield the differences between the outputs of the two steps, as far as they are stored."""
    from nodegraph.runs.diff import value_differences
    from nodegraph.runs.recorded_value import stored_values

    if not pair.have_results:
        return
    before, after = stored_values(pair.was, store), stored_values(pair.now, store)
    if not before or not after:
        yield "its values are no longer stored and cannot be compared"
        return
    for name, value, other in zip(now.method(pair.now).outputs, before, after, strict=False):
        texts = value_differences(value, other, registry.hooks.comparisons)
        yield from (f"{name}: {text}" if len(before) > 1 else text for text in texts[:MOST])

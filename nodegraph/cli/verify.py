"""``nodegraph verify``."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from nodegraph.cli.common import MOST, counted, few, first_and_more, say, set_values
from nodegraph.state import State

if TYPE_CHECKING:
    from nodegraph.execute import Run
    from nodegraph.lock.compare import Compared, Moved
    from nodegraph.lock.lockfile import Lock
    from nodegraph.lock.results import Kept, Results, Said
    from nodegraph.store import Store

_NO_REASON = ": another processor, or it does not give one answer"


def verify(arguments: Namespace) -> int:
    """Run a frozen study, and tell how far its results are those in the lock.

    The status is 1 if it diverged, or if its conclusions are others however near its results are.
    """
    from nodegraph.cli.common import completed
    from nodegraph.execute import open_store
    from nodegraph.lock.lockfile import read_lock
    from nodegraph.lock.restore import other_texts, unlocked
    from nodegraph.plugin.registry import Registry

    lock = read_lock(arguments.lock)
    registry = Registry.installed(arguments.plugin)
    graph = unlocked(lock, registry, set_values(arguments))
    for text in other_texts(lock):
        say(text)
    store = open_store(registry, arguments.store, say)
    with _store_of_the_run(store, afresh=arguments.rerun) as used:
        return _told(lock, completed(arguments, graph, used), store)


def _told(lock: Lock, run: Run, store: Store) -> int:
    """Print the verdict and what it stands on; return the exit status."""
    from nodegraph.lock.compare import (
        Explained,
        compare,
        conclusions_changed,
        first_of_each,
        verdict,
    )
    from nodegraph.lock.results import Kept, Results, said_by

    not_stored = run.not_stored()  # before what is not stored is computed again
    results, said, kept = Results(run), list(said_by(run)), Kept(store)
    found = compare(lock, run, results)
    changed = list(conclusions_changed(lock.data["conclusions"], said))
    came_to = verdict(found, bool(lock.data["conclusions"]), changed)
    print(f"{came_to.text}: {lock.path}: {_counts(found, lock)}")
    for line in (*Explained(lock, run).everywhere(), *_notes(found), *not_stored):
        print(f"    {line}")
    for place, moved in enumerate(first_of_each(found.origins)[:MOST]):
        first = moved[0].cell
        name = first_and_more(first.name, len(moved), first.group)
        print(f"\n{'also' if place else 'first'}: {name}")
        for line in (*_explained(moved[0], run), *_values(moved, lock, results, kept)):
            print(f"    {line}")
    if found.followers:
        print(f"\nwhat follows from that: {counted(found.followers)}")
    for line in (*few(changed), *_numbers(lock, found, said), *_held(lock, found, changed)):
        print(line)
    return 0 if came_to.holds else 1


@contextmanager
def _store_of_the_run(store: Store, *, afresh: bool) -> Iterator[Store]:
    from nodegraph.lock.restore import Afresh

    if not afresh:
        yield store
        return
    with TemporaryDirectory(prefix="nodegraph-") as folder:
        yield Afresh(Path(folder), store, say)


def _counts(found: Compared, lock: Lock) -> str:
    parts = [f"{found.identical} of {found.count} results identical{_ended(found)}"]
    if found.near and found.farthest:
        cell, apart = found.farthest
        size = f"up to {apart:.1g}, {cell.name}" if apart else "but for their form"
        parts.append(f"{found.near} within {lock.data['tolerance']:g} of their size ({size})")
    return ", ".join([*parts, f"{found.beyond} beyond"] if found.beyond else parts)


def _ended(found: Compared) -> str:
    """Return how many of the identical results are none."""
    counts = [
        f"{count} {'' if state == State.FAILED else 'was ' if count == 1 else 'were '}{state}"
        for state, count in found.ended.items()
    ]
    return f" (of these {' and '.join(counts)}, as then)" if counts else ""


def _notes(found: Compared) -> Iterator[str]:
    if found.drawn.total():
        yield f"drawn otherwise from the same numbers: {counted(found.drawn)}"
    if found.unknown:
        yield f"cannot be stored, so not compared: {counted(found.unknown)}"
    for what, names in (("the lock", found.only_locked), ("this run", found.only_now)):
        if names:
            more = f" and {len(names) - MOST} more" if len(names) > MOST else ""
            yield f"only in {what}: {'; '.join(names[:MOST])}{more}"


def _explained(moved: Moved, run: Run) -> Iterator[str]:
    own, around = moved.change.own, moved.change.around
    if not own and not around:
        step = run.plan.steps[moved.cell.index]
        audited = run.cache.distrusted(step) if run.cache else ""
        why = f", and {audited}" if audited else _NO_REASON
        yield f"code, settings, files and libraries are the same{why}"
    yield from few(own, "changes")
    yield from around


def _values(moved: list[Moved], lock: Lock, results: Results, kept: Kept) -> Iterator[str]:
    """Yield by how much results differ and where: exactly, where the old ones are stored."""
    from nodegraph.lock.compare import where
    from nodegraph.runs.diff import told_apart

    first = moved[0]
    if first.grade.said:
        yield first.grade.said
    largest = max(moved, key=lambda one: one.grade.apart)
    if largest.grade.apart:
        most = "" if len(moved) == 1 else f", {largest.cell.name} most"
        yield f"by {largest.grade.apart:.2g} times their usual size (root mean square{most})"
    if results.ended(first.cell.index):
        return
    digest = lock.results[first.cell.group][first.cell.at].digest
    stored = results.beside(first.cell.index, digest, kept)
    if not stored:
        yield from where(lock, first.cell, results)
    for name, (was, now) in stored.items():
        said = told_apart(was, now, results.comparisons)
        yield from (f"{name}: {text}" for text in said[:MOST])


def _numbers(lock: Lock, found: Compared, said: list[Said]) -> Iterator[str]:
    """Yield how the tables changed, if it is more than rounding."""
    from nodegraph.lock.compare import numbers_changed

    if found.beyond:
        changed = numbers_changed(lock.data["tables"], said, lock.data["tolerance"])
        yield from few(list(changed))


def _held(lock: Lock, found: Compared, changed: list[str]) -> Iterator[str]:
    count = sum(map(len, lock.data["conclusions"].values()))
    if found.beyond and not changed and count:
        yield f"all conclusions are the same ({count})"

"""``nodegraph verify``."""

from __future__ import annotations

from argparse import Namespace
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from nodegraph.commands.chosen import say, set_values

if TYPE_CHECKING:
    from nodegraph.execute import Run
    from nodegraph.paper.frozen.compared import Compared, Moved
    from nodegraph.paper.frozen.concluded import Said
    from nodegraph.paper.frozen.kept import Kept
    from nodegraph.paper.frozen.lock import Lock
    from nodegraph.paper.frozen.results import Results
    from nodegraph.store import Store

_MOST = 12


def verify(arguments: Namespace) -> int:
    """Run a frozen study, and tell how far its results are those in the lock; 1 if diverged."""
    from nodegraph.commands.completed import completed
    from nodegraph.execute import open_store
    from nodegraph.paper.frozen.lock import read_lock
    from nodegraph.paper.frozen.unlocked import other_texts, unlocked
    from nodegraph.registry import Registry

    lock = read_lock(arguments.lock)
    registry = Registry.installed(arguments.plugin)
    graph = unlocked(lock, registry, _absolute(set_values(arguments)))
    for text in other_texts(lock):
        say(text)
    store = open_store(registry, arguments.store, say)
    with _store_of_the_run(store, afresh=arguments.rerun) as used:
        return _told(lock, completed(arguments, graph, used), store)


def _told(lock: Lock, run: Run, store: Store) -> int:
    """Print the verdict and what it stands on; return the exit status."""
    from nodegraph.paper.frozen.compared import compare, first_of_each
    from nodegraph.paper.frozen.concluded import said_by
    from nodegraph.paper.frozen.explained import Explained
    from nodegraph.paper.frozen.kept import Kept
    from nodegraph.paper.frozen.results import Results
    from nodegraph.paper.frozen.spoken import conclusions_changed
    from nodegraph.paper.frozen.verdict import verdict

    results, said, kept = Results(run), list(said_by(run)), Kept(store)
    found = compare(lock, run, results)
    changed = list(conclusions_changed(lock.data["conclusions"], said))
    came_to = verdict(found, bool(lock.data["conclusions"]), changed)
    print(f"{came_to}: {lock.path}: {_counts(found, lock)}")
    for line in (*Explained(lock, run).everywhere(), *_notes(found)):
        print(f"    {line}")
    for place, moved in enumerate(first_of_each(found.origins)[:_MOST]):
        print(f"\n{'also' if place else 'first'}: {_names(moved)}")
        for line in (*_explained(moved[0]), *_values(moved, lock, results, kept)):
            print(f"    {line}")
    for line in _rest(found):
        print(f"\n{line}")
    for line in (*_few(changed), *_numbers(lock, found, said), *_held(lock, found, changed)):
        print(line)
    return 1 if came_to == "diverged" else 0


@contextmanager
def _store_of_the_run(store: Store, *, afresh: bool) -> Iterator[Store]:
    from nodegraph.store import Store

    if not afresh:
        yield store
        return
    with TemporaryDirectory(prefix="nodegraph-") as folder:
        yield Store(Path(folder), store.packer, say)


def _absolute(inputs: Mapping[str, Any]) -> dict[str, Any]:
    """Return inputs in which files of the working directory are named wherever it is."""
    return {
        name: str(Path(one).absolute()) if isinstance(one, str) and Path(one).exists() else one
        for name, one in inputs.items()
    }


def _counts(found: Compared, lock: Lock) -> str:
    parts = [f"{found.identical} of {found.count} results identical"]
    if found.near and found.farthest:
        cell, apart = found.farthest
        size = f"up to {apart:.1g}, {cell.name}" if apart else "but for their form"
        parts.append(f"{found.near} within {lock.data['tolerance']:g} of their size ({size})")
    beyond = len(found.origins) + found.followers.total()
    return ", ".join([*parts, f"{beyond} beyond"] if beyond else parts)


def _notes(found: Compared) -> Iterator[str]:
    if found.drawn.total():
        yield f"drawn otherwise from the same numbers: {_counted(found.drawn)}"
    if found.unknown:
        yield f"cannot be stored, so not compared: {_counted(found.unknown)}"
    for what, names in (("the lock", found.only_locked), ("this run", found.only_now)):
        if names:
            more = f" and {len(names) - _MOST} more" if len(names) > _MOST else ""
            yield f"only in {what}: {'; '.join(names[:_MOST])}{more}"


def _names(moved: list[Moved]) -> str:
    first, more = moved[0].cell, len(moved) - 1
    return first.name + (f" and {more} more of {first.group}" if more else "")


def _explained(moved: Moved) -> Iterator[str]:
    own, around = moved.change.own, moved.change.around
    if not own and not around:
        yield (
            "code, settings, files and libraries are the same: another processor, or it does not "
            "give one answer"
        )
    yield from own[:_MOST]
    if len(own) > _MOST:
        yield f"and {len(own) - _MOST} more changes"
    yield from around


def _values(moved: list[Moved], lock: Lock, results: Results, kept: Kept) -> Iterator[str]:
    """Yield by how much results differ and where: exactly, where the old ones are stored."""
    from nodegraph.paper.frozen.where import where
    from nodegraph.paper.values import told_apart

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
        yield from (f"{name}: {text}" for text in said[:_MOST])


def _rest(found: Compared) -> Iterator[str]:
    if found.followers:
        yield f"what follows from that: {_counted(found.followers)}"


def _few(lines: list[str]) -> Iterator[str]:
    yield from lines[:_MOST]
    if len(lines) > _MOST:
        yield f"and {len(lines) - _MOST} more"


def _numbers(lock: Lock, found: Compared, said: list[Said]) -> Iterator[str]:
    """Yield how the tables changed, if it is more than rounding."""
    from nodegraph.paper.frozen.spoken import numbers_changed

    if found.origins or found.followers:
        changed = numbers_changed(lock.data["tables"], said, lock.data["tolerance"])
        yield from _few(list(changed))


def _held(lock: Lock, found: Compared, changed: list[str]) -> Iterator[str]:
    count = sum(map(len, lock.data["conclusions"].values()))
    if (found.origins or found.followers) and not changed and count:
        yield f"all conclusions are the same ({count})"


def _counted(counts: Counter[str]) -> str:
    return ", ".join(f"{node} ({count})" for node, count in counts.items() if count)

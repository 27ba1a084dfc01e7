"""``nodegraph verify``: whether a study gives its results again, then and now or twice in a row."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph.cli.arguments import add_executor, add_pairs, add_plugin, add_store, input_values
from nodegraph.cli.output import MOST, columns, counted, few, first_and_more, say
from nodegraph.state import State

if TYPE_CHECKING:
    from nodegraph.audit.audit import Audited
    from nodegraph.execute import Run
    from nodegraph.graph import Graph
    from nodegraph.lock.compare import Compared, Moved
    from nodegraph.lock.conclusions import Reported
    from nodegraph.lock.lockfile import Lock
    from nodegraph.lock.results import Results, StoredValues
    from nodegraph.store import Store

HELP = "Run a frozen study and compare its results with those in the lock."


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.description = (
        f"{HELP} The verdict is identical, within tolerance, same conclusions, or diverged. "
        "The exit status is 1 if results diverged or conclusions changed. With --repeat, it tells "
        "instead whether each method gives the same result again, called once more, with more "
        "threads, and in another process; the exit status is 1 if one does not."
    )
    parser.add_argument(
        "lock",
        type=Path,
        metavar="LOCK",
        help="File written by nodegraph lock; with --repeat, also a graph file.",
    )
    parser.add_argument("--rerun", action="store_true", help="Do not use stored results.")
    parser.add_argument(
        "--repeat",
        choices=("one", "all"),
        nargs="?",
        const="one",
        help="Repeat one combination of each method, or all, with the same inputs.",
    )
    add_pairs(parser, "set", "Value of an input, or path of a file that the lock has by name only.")
    add_plugin(parser)
    add_executor(parser)
    add_store(parser)


def verify(arguments: Namespace) -> int:
    """Run a study, and print how far its results agree with its lock, or when repeated."""
    from nodegraph.cli.graphs import graph_of, run_of
    from nodegraph.execute import open_store
    from nodegraph.lock.lockfile import is_lock, read_lock
    from nodegraph.lock.restore import edited_files, unlocked
    from nodegraph.plugin.registry import Registry

    path = arguments.lock
    if arguments.repeat and not (path.is_file() and is_lock(path)):
        return _repeat(
            arguments, graph_of(Namespace(graph=path, axis=[], only=[], **vars(arguments)))
        )
    lock = read_lock(path)
    registry = Registry.installed(arguments.plugin)
    graph = unlocked(lock, registry, input_values(arguments))
    for text in edited_files(lock):
        say(text)
    if arguments.repeat:
        return _repeat(arguments, graph)
    store = open_store(registry, arguments.store, say)
    with _store_for_run(store, rerun=arguments.rerun) as run_store:
        run = run_of(arguments, graph, store=run_store)
        status = _compare(lock, run, store)
        if not arguments.rerun:
            run.tidy()
        return status


@contextmanager
def _store_for_run(store: Store, *, rerun: bool) -> Iterator[Store]:
    from tempfile import TemporaryDirectory

    from nodegraph.lock.restore import StoreWithoutResults

    if not rerun:
        yield store
        return
    with TemporaryDirectory(prefix="nodegraph-") as folder:
        yield StoreWithoutResults(Path(folder), store, say)


def _compare(lock: Lock, run: Run, store: Store) -> int:
    """Print the verdict and the reasons for it; return the exit status."""
    from nodegraph.lock.changes import Changes
    from nodegraph.lock.compare import compare, verdict
    from nodegraph.lock.conclusions import conclusion_changes, reported_by
    from nodegraph.lock.results import Results, StoredValues

    not_stored = run.not_stored()  # before results that are not stored are computed again
    results, reported, stored = Results(run), list(reported_by(run)), StoredValues(store)
    compared = compare(lock, run, results)
    conclusions = lock.study.conclusions
    changed = list(conclusion_changes(conclusions, reported))
    outcome = verdict(compared, bool(conclusions), changed)
    print(f"{outcome.text}: {lock.path}: {_counts(compared, lock)}")
    for line in (*Changes(lock.study, run).everywhere(), *_notes(compared), *not_stored):
        print(f"    {line}")
    _print_origins(lock, run, compared, results, stored)
    if compared.followers:
        print(f"\nwhat follows from that: {counted(compared.followers)}")
    for line in (*few(changed), *_table_changes(lock, compared, reported)):
        print(line)
    count = sum(map(len, conclusions.values()))
    if compared.beyond and not changed and count:
        print(f"all conclusions are the same ({count})")
    return 0 if outcome.holds else 1


def _print_origins(
    lock: Lock, run: Run, compared: Compared, results: Results, stored: StoredValues
) -> None:
    """Print the combinations with which differences begin, and what explains them."""
    from nodegraph.lock.compare import group_by_change

    for index, moved in enumerate(group_by_change(compared.origins)[:MOST]):
        cell = moved[0].cell
        name = first_and_more(cell.name, len(moved), cell.group)
        print(f"\n{'also' if index else 'first'}: {name}")
        for line in (*_explanation(moved[0], run), *_values(moved, lock, results, stored)):
            print(f"    {line}")


def _counts(compared: Compared, lock: Lock) -> str:
    parts = [f"{compared.identical} of {compared.count} results identical{_ended(compared)}"]
    if compared.near and compared.farthest:
        cell, distance = compared.farthest
        size = f"up to {distance:.1g}, {cell.name}" if distance else "but for their form"
        parts.append(f"{compared.near} within {lock.study.tolerance:g} of their size ({size})")
    return ", ".join([*parts, f"{compared.beyond} beyond"] if compared.beyond else parts)


def _ended(compared: Compared) -> str:
    """Return how many of the identical results are failures or refusals."""
    counts = [
        f"{count} {'' if state == State.FAILED else 'was ' if count == 1 else 'were '}{state}"
        for state, count in compared.without_value.items()
    ]
    return f" (of these {' and '.join(counts)}, as before)" if counts else ""


def _notes(compared: Compared) -> Iterator[str]:
    if compared.drawn.total():
        yield f"drawn otherwise from the same numbers: {counted(compared.drawn)}"
    if compared.unknown:
        yield f"cannot be stored, so not compared: {counted(compared.unknown)}"
    for what, names in (("the lock", compared.only_locked), ("this run", compared.only_now)):
        if names:
            more = f" and {len(names) - MOST} more" if len(names) > MOST else ""
            yield f"only in {what}: {'; '.join(names[:MOST])}{more}"


def _explanation(moved: Moved, run: Run) -> Iterator[str]:
    own, around = moved.change.own, moved.change.around
    if not own and not around:
        step = run.plan.steps[moved.cell.index]
        doubt = run.cache.distrusted(step) if run.cache else ""
        reason = f", and {doubt}" if doubt else ": another processor, or a method that varies"
        yield f"code, settings, files and libraries are the same{reason}"
    yield from few(own, "changes")
    yield from around


def _values(
    moved: list[Moved], lock: Lock, results: Results, stored: StoredValues
) -> Iterator[str]:
    """Yield how much results differ, and in which places if the locked values are stored."""
    from nodegraph.runs.diff import value_differences

    first = moved[0]
    if first.match.text:
        yield first.match.text
    largest = max(moved, key=lambda other: other.match.distance)
    if largest.match.distance:
        most = "" if len(moved) == 1 else f", {largest.cell.name} most"
        yield f"by {largest.match.distance:.2g} times their usual size (root mean square{most})"
    if results.ending(first.cell.index):
        return
    digest = lock.study.results[first.cell.group].steps[first.cell.at].digest
    values = results.value_pairs(first.cell.index, digest, stored)
    for name, (was, now) in values.items():
        texts = value_differences(was, now, results.comparisons)
        yield from (f"{name}: {text}" for text in texts[:MOST])


def _table_changes(lock: Lock, compared: Compared, reported: list[Reported]) -> Iterator[str]:
    """Yield how the numbers of tables changed, if by more than rounding."""
    from nodegraph.lock.conclusions import table_changes

    if compared.beyond:
        changed = table_changes(lock.study.tables, reported, lock.study.tolerance)
        yield from few(list(changed))


def _repeat(arguments: Namespace, graph: Graph) -> int:
    """Run a graph, repeat its steps, and print for each method whether results are the same."""
    from nodegraph.audit.audit import audit, cases
    from nodegraph.cli.graphs import run_of, store_of

    if not arguments.executor:
        arguments.executor = "processes"  # a node that ends its process ends nothing else
    store = store_of(arguments, graph)
    run = run_of(arguments, graph, store=store)
    by_method = cases(run, every=arguments.repeat == "all")
    indices = {index for steps in by_method.values() for index in steps}
    say(f"repeating {len(indices)} of {len(run.plan.steps)} steps")
    audited = {result.step.index: result for result in audit(run, indices)}
    print(columns(list(_rows(run, by_method, audited))))
    for line in (*_consequences(audited.values(), writable=store.writable), *run.not_stored()):
        print(f"\n{line}")
    run.tidy()
    return 0 if all(result.grade.passes for result in audited.values()) else 1


def _rows(
    run: Run,
    by_method: Mapping[tuple[str, str], tuple[int, ...]],
    audited: Mapping[int, Audited],
) -> Iterator[tuple[str, ...]]:
    """Yield a row per node and method, with the worst of its steps."""
    yield "node", "method", "grade", "cases", "what"
    for (node, label), steps in by_method.items():
        method = run.plan.graph.nodes[node].methods[label].node.name
        worst = max((audited[index] for index in steps), key=lambda result: result.grade.rank)
        count = sum(audited[index].grade == worst.grade for index in steps)
        cases = f"{count} of {len(steps)}" if count < len(steps) else str(len(steps))
        yield node, method, worst.grade, cases, worst.text


def _consequences(audited: Iterable[Audited], *, writable: bool) -> Iterator[str]:
    """Yield the consequences for later runs."""
    several = {result.step.method.node.name for result in audited if result.varies}
    names = ", ".join(sorted(several))
    if several and writable:
        yield (
            f"{names}: results are no longer stored, nor results made from them, and runs say so, "
            "until the code is edited or `nodegraph cache clear` is run"
        )
    elif several:
        yield f"{names}: later runs will not know, because the store cannot be written"

"""``nodegraph verify``: whether a study gives its results again, then and now or twice in a row."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph.cli.arguments import (
    add_executor,
    add_json,
    add_pairs,
    add_plugin,
    add_store,
    values_of,
)
from nodegraph.cli.differences import origin_lines, origins
from nodegraph.cli.output import columns, counted, few, say
from nodegraph.state import State

if TYPE_CHECKING:
    from nodegraph.audit.audit import Audited
    from nodegraph.cli.answers import Repeated
    from nodegraph.execute.results import Run
    from nodegraph.graph import Graph
    from nodegraph.lock.lockfile import Lock
    from nodegraph.runs.compare import Agreements
    from nodegraph.runs.record import RecordedStep
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
    add_json(parser)


def verify(arguments: Namespace) -> int:
    """Run a study, and print how far its results agree with its lock, or when repeated."""
    from tempfile import TemporaryDirectory

    from nodegraph.cli.graphs import graph_of, run_of
    from nodegraph.execute.resume import open_store
    from nodegraph.lock.lockfile import is_lock, read_lock
    from nodegraph.lock.restore import StoreWithoutResults, edited_files, unlocked
    from nodegraph.plugin.registry import Registry

    path = arguments.lock
    if arguments.repeat and not (path.is_file() and is_lock(path)):
        return _repeat(
            arguments, graph_of(Namespace(graph=path, axis=[], only=[], **vars(arguments)))
        )
    lock = read_lock(path)
    registry = Registry.installed(arguments.plugin)
    graph = unlocked(lock, path, registry, values_of(arguments, "set"))
    for text in edited_files(lock, path):
        say(text)
    if arguments.repeat:
        return _repeat(arguments, graph)
    store = open_store(registry, arguments.store, say)
    with ExitStack() as ending:
        run_store = store
        if arguments.rerun:
            folder = ending.enter_context(TemporaryDirectory(prefix="nodegraph-"))
            run_store = StoreWithoutResults(Path(folder), store, say)
        run = run_of(arguments, graph, store=run_store)
        status = _compare(lock, path, run, store, as_json=arguments.json)
        if not arguments.rerun:
            run.tidy()
        return status


def _compare(lock: Lock, path: Path, run: Run, store: Store, *, as_json: bool) -> int:
    """Print the verdict and the reasons for it; return the exit status."""
    from nodegraph.cli.answers import VerifyAnswer, print_json
    from nodegraph.lock.conclusions import conclusion_changes, reported_by, table_changes
    from nodegraph.lock.grade import BySketch, changes_everywhere, outcome_of
    from nodegraph.lock.portable import FileNames, portable
    from nodegraph.lock.results import Results
    from nodegraph.runs.compare import compare
    from nodegraph.runs.recorded_value import StoredValues

    not_stored = run.not_stored()  # before results that are not stored are computed again
    results, reported = Results(run), list(reported_by(run))
    now = portable(run, FileNames(run.plan.graph), results)
    agreements = compare(lock.record, now, BySketch(lock, results))
    changed = list(conclusion_changes(lock.conclusions, reported))
    outcome = outcome_of(agreements, bool(lock.conclusions), changed)
    everywhere = list(changes_everywhere(lock.record, now))
    stores = StoredValues(store), StoredValues(run.cache.store if run.cache else store)
    found = origins(agreements, run.plan.graph.registry, stores)
    # where no result is beyond the tolerance, tables changed by rounding alone
    tables = list(table_changes(lock.tables, reported, lock.tolerance) if agreements.beyond else ())
    if as_json:
        print_json(
            VerifyAnswer(
                lock=str(path),
                grade=outcome.grade,
                holds=outcome.holds,
                identical=agreements.same,
                near=len(agreements.near),
                beyond=agreements.beyond,
                unknown=agreements.unknown.total(),
                tolerance=lock.tolerance,
                farthest=max((judged.distance for _, judged in agreements.near), default=0.0),
                changes=[*everywhere, *not_stored],
                only_locked=[cell.name for cell in agreements.only_was],
                only_now=[cell.name for cell in agreements.only_now],
                origins=found,
                follow=agreements.followers,
                conclusions=changed,
                tables=tables,
            )
        )
        return 0 if outcome.holds else 1
    print(f"{outcome.text}: {path}: {_counts(agreements, lock)}")
    for line in (*everywhere, *_notes(agreements), *not_stored):
        print(f"    {line}")
    for line in origin_lines(agreements, found, partial(_unexplained, run)):
        print(line)
    if agreements.followers:
        print(f"\nwhat follows from that: {counted(agreements.followers)}")
    for line in (*few(changed), *few(tables)):
        print(line)
    count = sum(map(len, lock.conclusions.values()))
    if agreements.beyond and not changed and count:
        print(f"all conclusions are the same ({count})")
    return 0 if outcome.holds else 1


def _counts(agreements: Agreements, lock: Lock) -> str:
    parts = [f"{agreements.same} of {agreements.compared} results identical{_ended(agreements)}"]
    if agreements.near:
        pair, judged = max(agreements.near, key=lambda item: item[1].distance)
        distance = judged.distance
        size = f"up to {distance:.1g}, {pair.cell.name}" if distance else "but for their form"
        parts.append(f"{len(agreements.near)} within {lock.tolerance:g} of their size ({size})")
    return ", ".join([*parts, f"{agreements.beyond} beyond"] if agreements.beyond else parts)


def _ended(agreements: Agreements) -> str:
    """Return how many of the identical results are failures or refusals."""
    counts = [
        f"{count} {'' if state == State.FAILED else 'was ' if count == 1 else 'were '}{state}"
        for state, count in agreements.endings.items()
    ]
    return f" (of these {' and '.join(counts)}, as before)" if counts else ""


def _notes(agreements: Agreements) -> Iterator[str]:
    if agreements.redrawn:
        yield f"drawn otherwise from the same numbers: {counted(agreements.redrawn)}"
    if agreements.unknown:
        yield f"cannot be stored, so not compared: {counted(agreements.unknown)}"
    for what, cells in (("the lock", agreements.only_was), ("this run", agreements.only_now)):
        if cells:
            yield f"only in {what}: {'; '.join(few([cell.name for cell in cells]))}"


def _unexplained(run: Run, recorded: RecordedStep) -> str:
    step = run.plan.steps[recorded.step]
    doubt = run.cache.distrusted(step) if run.cache else ""
    reason = f", and {doubt}" if doubt else ": another processor, or a method that varies"
    return f"code, settings, files and libraries are the same{reason}"


def _repeat(arguments: Namespace, graph: Graph) -> int:
    """Run a graph, repeat its steps, and print for each method whether results are the same."""
    from nodegraph.audit.audit import audit, cases
    from nodegraph.cli.answers import RepeatAnswer, print_json
    from nodegraph.cli.graphs import run_of, store_of

    if not arguments.executor:
        arguments.executor = "processes"  # a node that ends its process ends nothing else
    store = store_of(arguments, graph)
    run = run_of(arguments, graph, store=store)
    by_method = cases(run, every=arguments.repeat == "all")
    indices = {index for steps in by_method.values() for index in steps}
    say(f"repeating {len(indices)} of {len(run.plan.steps)} steps")
    audited = {result.step.index: result for result in audit(run, indices)}
    rows = list(_rows(run, by_method, audited))
    passes = all(result.grade.passes for result in audited.values())
    if arguments.json:
        print_json(RepeatAnswer(passes, rows))
        run.tidy()
        return 0 if passes else 1
    head = ("node", "method", "grade", "cases", "what")
    print(columns([head, *map(_cells, rows)]))
    for line in (*_consequences(audited.values(), writable=store.writable), *run.not_stored()):
        print(f"\n{line}")
    run.tidy()
    return 0 if passes else 1


def _cells(row: Repeated) -> tuple[str, ...]:
    cases = f"{row.worst} of {row.of}" if row.worst < row.of else str(row.of)
    return row.node, row.method, row.grade, cases, row.text


def _rows(
    run: Run,
    by_method: Mapping[tuple[str, str], tuple[int, ...]],
    audited: Mapping[int, Audited],
) -> Iterator[Repeated]:
    """Yield an entry per node and method, with the worst of its steps."""
    from nodegraph.cli.answers import Repeated

    for (node, label), steps in by_method.items():
        method = run.plan.graph.nodes[node].methods[label].node.name
        worst = max((audited[index] for index in steps), key=lambda result: result.grade.rank)
        count = sum(audited[index].grade == worst.grade for index in steps)
        yield Repeated(node, method, worst.grade, count, len(steps), worst.text)


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

"""``nodegraph diff``: where two runs differ first, and why."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph.cli.arguments import add_json, add_plugin, add_run, add_store
from nodegraph.cli.differences import origin_lines, origins
from nodegraph.cli.output import counted, say

if TYPE_CHECKING:
    from nodegraph.cli.answers import DiffAnswer, FirstDifference
    from nodegraph.runs.compare import Agreements

HELP = "Show where two runs differ first, and why; exit with status 1 if they differ."


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    add_run(parser)
    parser.add_argument("other", type=Path, metavar="RUN", help="Folder of another run.")
    add_plugin(parser)
    add_store(parser)
    add_json(parser)


def diff(arguments: Namespace) -> int:
    """Print where two runs differ first, by how much, and what explains it."""
    from nodegraph.cli.answers import print_json
    from nodegraph.execute.resume import open_store
    from nodegraph.plugin.registry import Registry
    from nodegraph.runs.compare import by_digest, choices, compare
    from nodegraph.runs.record_files import read_record
    from nodegraph.runs.recorded_value import StoredValues

    was, now = read_record(arguments.run), read_record(arguments.other)
    registry = Registry.installed(arguments.plugin)
    store = open_store(registry, arguments.store, say)
    agreements = compare(was, now, by_digest(store))
    stored = StoredValues(store)
    found = origins(agreements, registry, (stored, stored))
    if arguments.json:
        print_json(_answer(arguments, agreements, found, list(choices(was, now))))
        return 0 if agreements.is_equal else 1
    print(_summary(agreements, f"{arguments.run} and {arguments.other}"))
    for line in choices(was, now):
        print(line)
    for run, cells in (
        (arguments.run, agreements.only_was),
        (arguments.other, agreements.only_now),
    ):
        if cells:
            print(f"only in {run}: {counted(Counter(cell.node for cell in cells))}")
    for line in origin_lines(agreements, found, lambda step: _UNEXPLAINED):
        print(line)
    if agreements.followers:
        print(f"\nwhat follows from that: {counted(agreements.followers)}")
    if harmless := agreements.harmless:
        print(f"\nchanged, with the same results: {counted(harmless)}")
    return 0 if agreements.is_equal else 1


def _answer(
    arguments: Namespace, agreements: Agreements, found: list[FirstDifference], choices: list[str]
) -> DiffAnswer:
    from nodegraph.cli.answers import DiffAnswer

    return DiffAnswer(
        was=str(arguments.run),
        now=str(arguments.other),
        same=agreements.is_equal,
        equal=agreements.same,
        beyond=agreements.beyond,
        unknown=agreements.unknown.total(),
        choices=choices,
        only_was=Counter(cell.node for cell in agreements.only_was),
        only_now=Counter(cell.node for cell in agreements.only_now),
        follow=agreements.followers,
        harmless=agreements.harmless,
        origins=found,
    )


_UNEXPLAINED = "settings, code and inputs are the same: the method gives different results"


def _summary(agreements: Agreements, names: str) -> str:
    if agreements.is_equal:
        return f"{names}: all {agreements.same} combinations have the same results"
    unknown = agreements.unknown.total()
    differ = "combination differs" if agreements.beyond == 1 else "combinations differ"
    return f"{names}: {agreements.beyond} {differ}, {agreements.same} have the same results" + (
        f", {unknown} are unknown (their results were not stored)" if unknown else ""
    )

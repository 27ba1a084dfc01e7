"""``nodegraph cache``: list, prune or clear stored results."""

from __future__ import annotations

import re
import time
from argparse import ArgumentParser, Namespace
from typing import TYPE_CHECKING

from nodegraph.cli.arguments import add_json, add_store
from nodegraph.cli.output import columns
from nodegraph.errors import NodegraphError
from nodegraph.formatting import SIZES, number_of, size_text

if TYPE_CHECKING:
    from nodegraph.cli.answers import CacheAnswer
    from nodegraph.store import Amount, EntryOnDisk, Upkeep

HELP = "List, prune or clear stored results."

_MOST_ROWS = 1000
_AGES = {"d": 86400, "h": 3600, "m": 60}


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument(
        "action",
        nargs="?",
        default="size",
        choices=("size", "list", "prune", "clear"),
        help=f"What to do (default: size); list shows the {_MOST_ROWS:,} that were used last.",
    )
    parser.add_argument(
        "--older",
        default="",
        metavar="AGE",
        help="With prune: remove results that were not used for this long, such as 30d or 12h.",
    )
    parser.add_argument(
        "--keep",
        default="",
        metavar="SIZE",
        help="With prune: remove the least recently used results beyond this size, such as 10GB.",
    )
    add_store(parser)
    add_json(parser)


def cache(arguments: Namespace) -> int:
    """Show the size of the stored results, list them, or remove them."""
    from nodegraph.cli.answers import print_json
    from nodegraph.store import Upkeep, store_folder

    upkeep = Upkeep(store_folder(arguments.store))
    if arguments.action != "prune" and (arguments.older or arguments.keep):
        raise NodegraphError("--older and --keep belong to `nodegraph cache prune`")
    removed = None
    if arguments.action == "prune":
        removed = _prune(upkeep, arguments)
    elif arguments.action == "clear":
        removed = upkeep.clear()
    amount = upkeep.size()
    listed = list(upkeep.entries(_MOST_ROWS)) if arguments.action == "list" else []
    if arguments.json:
        print_json(_answer(upkeep, amount, removed, listed))
    elif removed is not None and arguments.action == "clear":
        print(f"removed {_amount(removed)} from {upkeep.folder}")
    elif removed is not None:
        print(f"removed {_amount(removed)}; {_amount(amount)} left in {upkeep.folder}")
        if (young := upkeep.unneeded()).blobs:
            print(
                f"{number_of(young.blobs, 'file')} ({size_text(young.size)}) of no result: arrays "
                "younger than an hour stay, as a run may be about to need them; "
                "`nodegraph cache clear` removes all"
            )
    else:
        _list(listed, amount.entries if listed else 0)
        print(f"{_amount(amount)} in {upkeep.folder}")
        if formats := upkeep.other_formats():
            print(f"other versions of nodegraph have results there, too: {', '.join(formats)}")
    return 0


def _answer(
    upkeep: Upkeep, amount: Amount, removed: Amount | None, listed: list[EntryOnDisk]
) -> CacheAnswer:
    from nodegraph.cli.answers import CacheAnswer, StoredResult

    return CacheAnswer(
        str(upkeep.folder),
        amount.entries,
        amount.blobs,
        amount.size,
        removed.entries if removed else 0,
        removed.size if removed else 0,
        [
            StoredResult(each.node, each.step, each.state, each.size, each.seconds, kept.used)
            for kept in listed
            for each in [kept.entry]
        ],
    )


def _list(listed: list[EntryOnDisk], count: int) -> None:
    """Print the results that were used last, of so many."""
    now = time.time()
    rows = [_row(result, now) for result in listed]
    if rows:
        print(columns([("node", "step", "state", "size", "took", "last used"), *rows]))
    if len(rows) < count:
        print(f"and {count - len(rows)} more")


def _row(result: EntryOnDisk, now: float) -> tuple[str, ...]:
    entry = result.entry
    took = _duration(entry.seconds)
    used = f"{_duration(max(0.0, now - result.used), whole=True)} ago"
    return entry.node, entry.step, entry.state, size_text(entry.size), took, used


def _prune(upkeep: Upkeep, arguments: Namespace) -> Amount:
    if not arguments.older and not arguments.keep:
        raise NodegraphError(
            "nothing to prune: name an age with --older, such as 30d, or a size with --keep, such "
            "as 10GB; `nodegraph cache clear` removes all results"
        )
    older = _age(arguments.older) if arguments.older else None
    keep = _bytes(arguments.keep) if arguments.keep else None
    return upkeep.prune(older, keep)


def _age(text: str) -> float:
    match = re.fullmatch(r"(\d+(?:\.\d+)?)\s*([dhm])", text)
    if match is None:
        raise NodegraphError(f"--older {text}: write days, hours or minutes, such as 30d, 12h, 45m")
    return float(match[1]) * _AGES[match[2]]


def _bytes(text: str) -> int:
    match = re.fullmatch(r"(\d+(?:\.\d+)?)\s*([KMGT]?B)", text, re.IGNORECASE)
    if match is None:
        raise NodegraphError(f"--keep {text}: write a size with its unit, such as 10GB or 500MB")
    return int(float(match[1]) * SIZES[match[2].upper()])


def _amount(amount: Amount) -> str:
    results, arrays = number_of(amount.entries, "result"), number_of(amount.blobs, "file")
    return f"{results} ({size_text(amount.size)}, arrays in {arrays})"


def _duration(seconds: float, *, whole: bool = False) -> str:
    """Return a duration in a fitting unit: 3.2 s, 45 min, 12 h, 30 d."""
    for length, unit in ((86400, "d"), (3600, "h"), (60, "min")):
        if seconds >= 2 * length:
            return f"{seconds / length:.0f} {unit}"
    if whole or seconds >= 100:
        return f"{seconds:.0f} s"
    return f"{1000 * seconds:.3g} ms" if seconds < 1 else f"{seconds:.3g} s"

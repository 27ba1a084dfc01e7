"""``nodegraph cache``."""

from __future__ import annotations

import re
import time
from argparse import Namespace

from nodegraph.cli.progress import columns
from nodegraph.errors import NodegraphError
from nodegraph.formatting import SIZES, size_text
from nodegraph.store import Amount, Kept, Upkeep, store_folder

_AGES = {"d": 86400, "h": 3600, "m": 60}


def cache(arguments: Namespace) -> int:
    """Tell what is stored, or remove it."""
    upkeep = Upkeep(store_folder(arguments.store))
    if arguments.action != "prune" and (arguments.older or arguments.keep):
        raise NodegraphError("--older and --keep belong to `nodegraph cache prune`")
    if arguments.action == "prune":
        _prune(upkeep, arguments)
    elif arguments.action == "clear":
        print(f"removed {_amount(upkeep.clear())} from {upkeep.folder}")
    elif arguments.action == "list":
        _list(upkeep)
    else:
        _size(upkeep)
    return 0


def _size(upkeep: Upkeep) -> None:
    print(f"{_amount(upkeep.size())} in {upkeep.folder}")
    if others := upkeep.other_formats():
        print(f"another version of nodegraph has stored results there, too: {', '.join(others)}")


def _list(upkeep: Upkeep) -> None:
    there = sorted(upkeep.entries(), key=lambda one: one.used, reverse=True)
    now = time.time()
    heads = ("node", "step", "state", "size", "took", "last used")
    if there:
        print(columns([heads, *(_row(one, now) for one in there)]))
    _size(upkeep)


def _row(kept: Kept, now: float) -> tuple[str, ...]:
    entry = kept.entry
    took = _seconds(entry.seconds)
    used = f"{_seconds(max(0.0, now - kept.used), whole=True)} ago"
    return (entry.node, entry.step, entry.state, size_text(entry.size), took, used)


def _prune(upkeep: Upkeep, arguments: Namespace) -> None:
    if not arguments.older and not arguments.keep:
        raise NodegraphError(
            "say what to remove: --older 30d for what was not used for so long, --keep 10GB for "
            "the longest unused beyond so much, or `nodegraph cache clear` for all"
        )
    older = _age(arguments.older) if arguments.older else None
    keep = _bytes_of(arguments.keep) if arguments.keep else None
    removed = upkeep.prune(older, keep)
    print(f"removed {_amount(removed)}; {_amount(upkeep.size())} left in {upkeep.folder}")


def _age(text: str) -> float:
    found = re.fullmatch(r"(\d+(?:\.\d+)?)\s*([dhm])", text)
    if found is None:
        raise NodegraphError(f"--older {text}: write days, hours or minutes, such as 30d, 12h, 45m")
    return float(found[1]) * _AGES[found[2]]


def _bytes_of(text: str) -> int:
    found = re.fullmatch(r"(\d+(?:\.\d+)?)\s*([KMGT]?B)", text, re.IGNORECASE)
    if found is None:
        raise NodegraphError(f"--keep {text}: write a size with its unit, such as 10GB or 500MB")
    return int(float(found[1]) * SIZES[found[2].upper()])


def _amount(amount: Amount) -> str:
    results = "result" if amount.entries == 1 else "results"
    return f"{amount.entries} {results} ({size_text(amount.size)}, arrays in {amount.blobs} files)"


def _seconds(seconds: float, *, whole: bool = False) -> str:
    """Return a time as a person says it: 3.2 s, 45 min, 12 h, 30 d."""
    for length, unit in ((86400, "d"), (3600, "h"), (60, "min")):
        if seconds >= 2 * length:
            return f"{seconds / length:.0f} {unit}"
    if whole or seconds >= 100:
        return f"{seconds:.0f} s"
    return f"{1000 * seconds:.3g} ms" if seconds < 1 else f"{seconds:.3g} s"

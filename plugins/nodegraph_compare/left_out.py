"""Sentences on what a comparison leaves out or counts several times."""

from __future__ import annotations

import re
import warnings
from collections import defaultdict
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import listed
from nodegraph_compare.blocks import unsuccessful
from nodegraph_compare.unused_axes import unused_axes

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from nodegraph import Absent, Across, Label
    from nodegraph_compare.blocks import Group
    from nodegraph_compare.question import Question
    from nodegraph_mocap import Table

MOST_GROUPS = 12
"""Groups that have a sentence each; of more, one sentence states the counts."""

_MOST_GROUPS = 8
_REASONS = 2
_MOST_NOTES = 40
_COMBINATION = re.compile(r"^([\w.]+)\(.*?\) (?=(?:failed|refused): )")  # of fill(k=1) failed: why
_MOST_LACKING = 3


def left_out(scores: Across[Table], question: Question, groups: Sequence[Group]) -> list[str]:
    """Return notes on what is left out, and warn of all that was not skipped on purpose.

    Notes on tables that count several times come last.

    Called by a node itself, so that the warning is the node's.

    Parameters
    ----------
    scores
        The gathered tables.
    question, groups
        Of the comparison.
    """
    same: dict[str, list[str]] = defaultdict(list)
    for group in groups:
        if text := dropped(group):
            same[text].append(group_text(group, question))
    sentences = [f"{start_text(_few(names))}{text}" for text, names in same.items()]
    missing = absences(unsuccessful(scores), question.compare)
    empty = [] if groups else ["the tables have no rows"]
    if sentences or missing or empty:
        warnings.warn(shortened([*sentences, *missing, *empty]), stacklevel=4)
    more = sum(map(len, [*same.values()][_MOST_NOTES:]))
    noted = [*sentences[:_MOST_NOTES], *([f"and so in {more} more groups"] if more else [])]
    return [
        *noted,
        *absences(scores.absent, question.compare),
        *unused_axes(scores, question.compare).values(),
    ]


def dropped(group: Group) -> str:
    """Return a note on blocks left out of a group and the methods they lack; empty if none are."""
    some = [f"{name} lacks {count}" for name, count in _lacking(group)]
    total, count = len(group.values), np.count_nonzero(~group.complete)
    clauses = [f"{count} of {total} blocks left out ({listed(some)})"] if some else []
    return "; ".join(filter(None, [*clauses, numberless(group)]))


def numberless(group: Group) -> str:
    """Return which methods have no number in any block; empty if there is none."""
    names = [name for name, usable in zip(group.methods, group.usable, strict=True) if not usable]
    return f"without any number, not compared: {listed(names)}" if names else ""


def narrowed(lacking: Iterable[tuple[Label, int]], used: int, total: int, blocks: str) -> str:
    """Return a note on the blocks left and the methods that lack most; empty if none are gone.

    ``10 of 40 gaps, the rest left out: mean_pose lacks 30``.

    Parameters
    ----------
    lacking
        Methods with the number of blocks that each lacks.
    used, total
        Numbers of blocks.
    blocks
        What several blocks are called.
    """
    if used == total:
        return ""
    some = sorted(((name, count) for name, count in lacking if count), key=lambda each: -each[1])
    clauses = [f"{name} lacks {count}" for name, count in some[:_MOST_LACKING]]
    more = len(some) - len(clauses)
    rest = f" and {more} more lack some" if more else ""
    return f"{used} of {total} {blocks}, the rest left out: {', '.join(clauses)}{rest}"


def narrowed_group(group: Group, blocks: str) -> str:
    """Return the note `narrowed` on a group."""
    if not group.usable.any():
        return ""
    used = int(np.count_nonzero(group.complete))
    return narrowed(_lacking(group), used, len(group.values), blocks)


def filled(
    taken: Iterable[tuple[Label, int]], total: int, fallback: Label | None, blocks: str
) -> str:
    """Return a note on methods that take another's value, and in how many blocks; or nothing."""
    lost = [f"{name} {count} of {total}" for name, count in taken if count]
    return f"missing {blocks} as by {fallback} ({', '.join(lost)})" if lost else ""


def filled_group(group: Group, fallback: Label | None, blocks: str) -> str:
    """Return the note `filled` on a group."""
    taken = zip(group.methods, group.taken, strict=False)
    return filled(taken, len(group.values), fallback, blocks)


def _lacking(group: Group) -> list[tuple[Label, int]]:
    """Return the number of missing blocks of the methods that lack some, not all."""
    lacking = np.count_nonzero(~np.isfinite(group.values), axis=0).tolist()
    both = zip(group.methods, lacking, group.usable, strict=True)
    return [(name, count) for name, count, usable in both if usable and count]


def absences(absent: Iterable[Absent], compare: str | None) -> list[str]:
    """Return the number of absent combinations by compared label and kind, with reasons.

    What is absent of several labels for the same reasons stands once.
    """
    reasons: dict[tuple[Label, str], list[str]] = defaultdict(list)
    for combination in absent:
        label = combination.labels.get(compare or "", "")
        reasons[label, combination.kind].append(combination.reason)
    same: dict[tuple[str, str], dict[int, list[Label]]] = {}
    for (label, kind), why in reasons.items():
        counts = same.setdefault((kind, _because(why)), {})
        counts.setdefault(len(why), []).append(label)
    return [
        "; ".join(
            f"{start_text(', '.join(map(str, labels)))}{count} combination{'s' * (count > 1)}"
            f"{' each' * (len(labels) > 1)}"
            for count, labels in counts.items()
        )
        + f" {kind}{because}"
        for (kind, because), counts in same.items()
    ]


def _few(groups: Sequence[str]) -> str:
    more = len(groups) - _MOST_GROUPS
    return "; ".join([*groups[:_MOST_GROUPS], *([f"and {more} more groups"] if more > 0 else [])])


def start_text(label: Label) -> str:
    """Return how a sentence on one label starts; where nothing is compared, with nothing."""
    return f"{label}: " if str(label) else ""


def shortened(sentences: list[str]) -> str:
    """Return sentences as one text; of many, the first and the number of others."""
    more = len(sentences) - _MOST_GROUPS
    rest = f"; and {more} more, see the table's notes" if more > 0 else ""
    return "; ".join(sentences[:_MOST_GROUPS]) + rest


def group_text(group: Group, question: Question) -> str:
    """Return the labels of a group as text: ``length 5, take jaw``."""
    pairs = zip(question.within, group.labels, strict=True)
    return ", ".join(f"{name} {label}" for name, label in pairs)


def block_text(question: Question) -> str:
    """Return what a block is, and the value of one."""
    over = " and ".join(question.averaged)
    also = f" The rows of a block include every {over}." if over else ""
    return (
        f"A block is one combination of {', '.join(question.blocks) or 'all rows'}; its value is "
        f"the mean of {question.metric} over its rows.{also}"
    )


def end_text(question: Question) -> str:
    """Return which end of the metric is the better one."""
    if question.better == "none":
        return f"Neither end of {question.metric} is the better one."
    return f"{question.better.capitalize()} is better."


def _because(why: list[str]) -> str:
    without_labels = (_COMBINATION.sub(r"\1 ", reason) for reason in why)
    reasons = [reason for reason in dict.fromkeys(without_labels) if reason]
    more = len(reasons) - _REASONS
    rest = f"; and {more} more reason{'s' * (more > 1)}" if more > 0 else ""
    return f" ({'; '.join(reasons[:_REASONS])}{rest})" if reasons else ""

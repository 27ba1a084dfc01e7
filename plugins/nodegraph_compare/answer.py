"""What a comparison says, in sentences: the best of each group, and what the numbers leave out."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.statistics import CONFIDENCE, RESAMPLES

if TYPE_CHECKING:
    from collections.abc import Iterable

    from nodegraph import Absent
    from nodegraph_compare.question import Question
    from nodegraph_compare.summary import Summary


_TOLD = 8


def answer(summary: Summary, question: Question, unit: str) -> str:
    """Return one sentence on a group: which mean is lowest, and which are not clearly apart.

    A method is apart when the bootstrap interval of its paired difference to the one with the
    lowest mean does not include 0. The intervals are not adjusted for their number.
    """
    place = group_text(summary, question)
    start = f"{place}: " if place else ""
    best = summary.best
    if best is None:
        return f"{start}no block has a number for every method; nothing can be said."
    told = f"{_name(summary, best)} has the lowest mean {question.metric}"
    if np.count_nonzero(summary.blocks) == 1:
        told = f"only {_name(summary, best)} has a mean {question.metric}"
    if not question.compare:
        told = f"the mean {question.metric} is known"
    return f"{start}{told} ({_numbers(summary, best, unit)}){_rest(summary, best)}."


def notes(question: Question, seed: int) -> list[str]:
    """Return what the columns of the table mean."""
    block = ", ".join(question.blocks) or "all rows"
    over = " and ".join(question.averaged)
    also = f" The rows of a block include every {over}." if over else ""
    return [
        f"A block is one combination of {block}; its value is the mean of {question.metric} over "
        f"its rows.{also} Lower is better.",
        "All statistics use only blocks in which every method with any number has all its "
        f"numbers. low, high: {CONFIDENCE:.0%} bootstrap percentile interval of the mean over "
        f"blocks ({RESAMPLES} resamples, seed {seed}).",
        "refused: share of combinations that were refused or failed; left missing: share of rows "
        "without a number.",
    ]


def dropped(summary: Summary, question: Question) -> str | None:
    """Return how many blocks were left out of a group, and whose numbers they lack."""
    group = summary.group
    lacking = np.count_nonzero(~np.isfinite(group.values), axis=0)
    both = list(zip(group.methods, lacking.tolist(), group.usable.tolist(), strict=True))
    some = [f"{name} lacks {count}" for name, count, usable in both if usable and count]
    without = [str(name) for name, _, usable in both if not usable]
    total, count = len(group.values), len(group.values) - len(summary.values)
    told = [f"{count} of {total} blocks left out ({', '.join(some)})"] if some else []
    told += [f"without any number, not compared: {', '.join(without)}"] if without else []
    place = group_text(summary, question)
    start = f"{place}: " if place else ""
    return start + "; ".join(told) if told else None


def absences(absent: Iterable[Absent], question: Question) -> list[str]:
    """Return how many combinations are absent, by method and kind, with the reasons."""
    reasons: dict[tuple[str, str], list[str]] = defaultdict(list)
    for one in absent:
        method = str(one.labels.get(question.compare or "", "")) or "all"
        reasons[method, one.kind].append(one.reason)
    return [
        f"{method}: {len(told)} {'combination' if len(told) == 1 else 'combinations'} {kind}"
        + _because(told)
        for (method, kind), told in reasons.items()
    ]


def shortened(told: list[str]) -> str:
    """Return sentences as one text, and how many more there are where there are many."""
    more = f"; and {len(told) - _TOLD} more, see the table's notes" if len(told) > _TOLD else ""
    return "; ".join(told[:_TOLD]) + more


def group_text(summary: Summary, question: Question) -> str:
    """Return the labels of a group as text: ``length 5, take jaw``."""
    pairs = zip(question.within, summary.group.labels, strict=True)
    return ", ".join(f"{name} {label}" for name, label in pairs)


def _numbers(summary: Summary, place: int, unit: str) -> str:
    count = int(summary.blocks[place])
    text = f"{summary.mean[place]:.3g} {unit}".rstrip()
    if count < 2:
        return f"{text}, one block"
    return f"{text}, interval {summary.low[place]:.3g} to {summary.high[place]:.3g}, {count} blocks"


def _rest(summary: Summary, best: int) -> str:
    others = [place for place in np.flatnonzero(summary.blocks).tolist() if place != best]
    if not others:
        return ""
    if len(summary.values) < 2:
        return "; one block says nothing of how far the others are apart"
    apart = np.percentile(
        summary.resampled[:, others] - summary.resampled[:, [best]], 50 * (1 - CONFIDENCE), axis=0
    )
    close = [_name(summary, place) for place, low in zip(others, apart, strict=True) if low <= 0]
    if not close:
        return "; the interval of every other method's paired difference to it lies above 0"
    more = len(others) - len(close)
    rest = f", the {'other' if more == 1 else f'other {more}'} clearly behind" if more else ""
    return (
        f"; not clearly apart from it: {', '.join(close)} "
        f"(the interval of the paired difference includes 0){rest}"
    )


def _because(told: list[str]) -> str:
    reasons = [reason for reason in dict.fromkeys(told) if reason]
    more = f"; and {len(reasons) - 2} more reasons" if len(reasons) > 2 else ""
    return f" ({'; '.join(reasons[:2])}{more})" if reasons else ""


def _name(summary: Summary, place: int) -> str:
    return str(summary.group.methods[place])

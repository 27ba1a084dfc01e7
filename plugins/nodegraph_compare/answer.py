"""What a table of means says, in sentences: the best of each group, and who is behind it."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.bootstrap import CONFIDENCE, FEWEST, RESAMPLES
from nodegraph_compare.left_out import block_text, end_text, group_text, listed
from nodegraph_compare.statistics import LEVEL, Test

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nodegraph import Label
    from nodegraph_compare.question import Question
    from nodegraph_compare.summary import Summary

_MOST_GROUPS = 12
_EXTREME = {"lower": "lowest", "higher": "highest"}
_TESTS = {
    "wilcoxon": "Wilcoxon's signed-rank test",
    "t": "the paired t-test",
    "sign": "the sign test",
}


def answers(
    found: Sequence[Summary], question: Question, unit: str, against: Label | None, test: Test
) -> list[str]:
    """Return the sentences on all groups: one on each, or on all of them where there are many."""
    if len(found) > _MOST_GROUPS and question.compare and question.better != "none":
        return [_counted(found, question)]
    told = []
    for one in found[:_MOST_GROUPS]:
        told.append(answer(one, question, unit))
        if against is not None and test != "none":
            told += _to_baseline(one, question, against)
    more = len(found) - _MOST_GROUPS
    return told + ([f"{more} more groups are in the table."] if more > 0 else [])


def answer(summary: Summary, question: Question, unit: str) -> str:
    """Return one sentence on a group: which mean is best, and which are not clearly apart.

    A method is apart when its paired difference to the one with the best mean is larger than
    Tukey's range allows, so that of equal methods any is called apart in 5 % of studies.
    """
    start = _start(summary, question)
    if not summary.blocks.any():
        return f"{start}no block has a number for every method; nothing can be said."
    if not question.compare:
        return f"{start}the mean {question.metric} is known ({_numbers(summary, 0, unit)})."
    if np.count_nonzero(summary.blocks) == 1:
        only = int(np.flatnonzero(summary.blocks)[0])
        numbers = _numbers(summary, only, unit)
        return f"{start}only {_name(summary, only)} has a mean {question.metric} ({numbers})."
    best = summary.best
    if best is None:
        return f"{start}{_span(summary, question, unit)}."
    told = f"{_name(summary, best)} has the {_EXTREME[question.better]} mean {question.metric}"
    return f"{start}{told} ({_numbers(summary, best, unit)}){_rest(summary, best)}."


def notes(question: Question, seed: int, against: Label | None, test: Test) -> list[str]:
    """Return what the numbers of the table mean."""
    told = [
        f"{block_text(question)} {end_text(question)}",
        "All statistics use only blocks in which every method with any number has all its "
        f"numbers. low, high: {CONFIDENCE:.0%} studentised bootstrap interval of the mean over "
        f"blocks ({RESAMPLES} resamples, seed {seed}; Student's below five blocks, none below "
        f"{FEWEST}), not adjusted for the number of intervals. Clearly behind the best: by "
        "Tukey's range of the paired differences, adjusted for all pairs of methods.",
    ]
    if against is not None and test != "none":
        told.append(
            f"p: {_TESTS[test]} of the paired differences to {against}, two-sided, after Holm's "
            "correction over the methods of a group."
        )
    return told


def _counted(found: Sequence[Summary], question: Question) -> str:
    wins = Counter(
        "none" if one.best is None else _name(one, one.best) for one in found
    ).most_common()
    extreme = _EXTREME[question.better]
    (first, most), *others = wins
    rest = f", {listed([f'{name} in {count}' for name, count in others])}" if others else ""
    return (
        f"Of {len(found)} groups ({', '.join(question.within)}), {first} has the {extreme} mean "
        f"{question.metric} in {most}{rest}."
    )


def _to_baseline(summary: Summary, question: Question, against: Label) -> list[str]:
    """Return which methods differ from the baseline, by the test."""
    paired = summary.paired
    if paired is None or not np.isfinite(paired.p).any():
        return []
    apart = paired.p < LEVEL
    sides = (("lower", paired.mean < 0.0), ("higher", paired.mean > 0.0))
    named = {
        side: [_name(summary, place) for place in np.flatnonzero(apart & where).tolist()]
        for side, where in sides
    }
    told = [f"{side}: {listed(names)}" for side, names in named.items() if names]
    said = f"{_start(summary, question)}against {against}, {question.metric} is "
    if not told:
        return [f"{said}not significantly different for any method (p < {LEVEL:g} after Holm)."]
    return [f"{said}significantly {'; '.join(told)} (p < {LEVEL:g} after Holm)."]


def _start(summary: Summary, question: Question) -> str:
    place = group_text(summary.group, question)
    return f"{place}: " if place else ""


def _numbers(summary: Summary, place: int, unit: str) -> str:
    count = int(summary.blocks[place])
    text = f"{summary.mean[place]:.3g} {unit}".rstrip()
    if count < FEWEST:
        return f"{text}, {'one block' if count == 1 else f'{count} blocks'}"
    return f"{text}, interval {summary.low[place]:.3g} to {summary.high[place]:.3g}, {count} blocks"


def _span(summary: Summary, question: Question, unit: str) -> str:
    """Return the extremes of a metric of which neither end is better."""
    low, high = int(np.nanargmin(summary.mean)), int(np.nanargmax(summary.mean))
    ends = [f"{_name(summary, one)} ({_numbers(summary, one, unit)})" for one in (low, high)]
    return f"the mean {question.metric} is lowest for {ends[0]} and highest for {ends[1]}"


def _rest(summary: Summary, best: int) -> str:
    others = [place for place in np.flatnonzero(summary.blocks).tolist() if place != best]
    count = len(summary.values)
    if count < FEWEST:
        told = "one block says" if count == 1 else f"{count} blocks say"
        return f"; {told} nothing of how far the others are apart"
    close = [_name(summary, place) for place in others if not summary.behind[place]]
    if not close:
        return "; every other method is clearly behind (paired differences, 5 % over all pairs)"
    more = len(others) - len(close)
    rest = f"; the {'other' if more == 1 else f'other {more}'} clearly behind" if more else ""
    return (
        f"; not clearly apart from it: {listed(close)} "
        f"(paired differences, 5 % over all pairs){rest}"
    )


def _name(summary: Summary, place: int) -> str:
    return str(summary.group.methods[place])

"""Sentences on a table of means: the best of each group, and which methods are behind it."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import listed
from nodegraph_compare.bootstrap import CONFIDENCE, FEWEST, RESAMPLES
from nodegraph_compare.left_out import (
    MOST_GROUPS,
    block_text,
    end_text,
    group_text,
    narrowed,
    numberless,
    start_text,
)
from nodegraph_compare.statistics import LEVEL, TEST_NAMES, Test
from nodegraph_tables.style import unit_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nodegraph import Label
    from nodegraph_compare.question import Question
    from nodegraph_compare.table.summary import Summary

_EXTREME = {"lower": "lowest", "higher": "highest"}


def answers(
    summaries: Sequence[Summary],
    question: Question,
    unit: str,
    against: Label | None,
    test: Test,
    blocks: str,
) -> list[str]:
    """Return the sentences on all groups: one on each, or on all of them where there are many.

    Where over a quarter of the blocks are left out, so that one method with a narrow reach decides
    over the blocks of all, the counts are stated.

    Parameters
    ----------
    summaries, question
        Of the comparison.
    unit
        Of the metric.
    against
        The baseline's label, if there is one.
    test
        Of the differences to it.
    blocks
        What several blocks are called.
    """
    if len(summaries) > MOST_GROUPS and question.compare and question.better != "none":
        return [_counted(summaries, question), *_narrow_groups(summaries, blocks)]
    sentences = []
    for same in _alike(summaries[:MOST_GROUPS], blocks):
        over, absent = narrowed(same[0].group, blocks), numberless(same[0].group)
        more = f"{f' ({over})' if over else ''}{f'; {absent}' if absent else ''}"
        sentences.append(f"{_answer(same, question, unit)}{more}.")
        if against is not None and test != "none":
            for summary in same:
                sentences += _to_baseline(summary, question, against)
    rest = len(summaries) - MOST_GROUPS
    return sentences + ([f"{rest} more groups are in the table."] if rest > 0 else [])


def _alike(summaries: Sequence[Summary], blocks: str) -> list[list[Summary]]:
    """Return the groups whose sentences differ only in their numbers, together."""
    together: dict[object, list[Summary]] = {}
    for place, summary in enumerate(summaries):
        known = summary.best is not None and len(summary.values) >= FEWEST
        over, absent = narrowed(summary.group, blocks), numberless(summary.group)
        key = (_best_names(summary), _rest(summary), over, absent) if known else place
        together.setdefault(key, []).append(summary)
    return list(together.values())


def _answer(same: Sequence[Summary], question: Question, unit: str) -> str:
    """Return a sentence on groups that are alike: which mean is best, which are not behind it.

    A method is apart when its paired difference to the one with the best mean is larger than
    Tukey's range allows, so that of equal methods any is called apart in 5 % of studies.
    """
    summary = same[0]
    start = _start(same, question)
    if not summary.blocks.any():
        return f"{start}no block has a number for every method; nothing can be said"
    if not question.compare:
        return f"{start}the mean {question.metric} is known ({_numbers(summary, 0, unit)})"
    if np.count_nonzero(summary.blocks) == 1:
        only = int(np.flatnonzero(summary.blocks)[0])
        numbers = _numbers(summary, only, unit)
        return f"{start}only {_name(summary, only)} has a mean {question.metric} ({numbers})"
    if summary.best is None:
        return f"{start}{_span(summary, question, unit)}"
    verb = "share" if np.count_nonzero(summary.bests) > 1 else "has"
    best = f"{_best_names(summary)} {verb} the {_EXTREME[question.better]} mean {question.metric}"
    return f"{start}{best} ({_numbers_of(same, unit)}){_rest(summary)}"


def notes(question: Question, seed: int, against: Label | None, test: Test) -> list[str]:
    """Return what the numbers of the table mean.

    Parameters
    ----------
    question
        Of the comparison.
    seed
        Of the bootstrap.
    against
        The baseline's label, if there is one.
    test
        Of the differences to it.
    """
    sentences = [
        f"{block_text(question)} {end_text(question)}",
        "All statistics use only blocks in which every method with any number has all its "
        f"numbers. [low, high] beside a mean: {CONFIDENCE:.0%} studentised bootstrap interval of "
        f"it over blocks ({RESAMPLES} resamples, seed {seed}; Student's below five blocks, none "
        f"below {FEWEST}), not adjusted for the number of intervals. Clearly behind the best: by "
        "Tukey's range of the paired differences, 5 % over all pairs of methods.",
    ]
    if against is not None and test != "none":
        sentences.append(
            f"p: {TEST_NAMES[test]} of the paired differences to {against}, two-sided, after "
            "Holm's correction over the methods of a group."
        )
    return sentences


def _counted(summaries: Sequence[Summary], question: Question) -> str:
    bests = (name for summary in summaries for name in _bests(summary) or ["none"])
    (first, most), *wins = Counter(bests).most_common()
    rest = f", {listed([f'{name} in {count}' for name, count in wins])}" if wins else ""
    return (
        f"Of {len(summaries)} groups ({', '.join(question.within)}), {first} has the "
        f"{_EXTREME[question.better]} mean {question.metric} in {most}{rest}."
    )


def _narrow_groups(summaries: Sequence[Summary], blocks: str) -> list[str]:
    """Return in how many groups over a quarter of the blocks are left out, and one of them."""
    narrow = [over for summary in summaries if (over := narrowed(summary.group, blocks))]
    if not narrow:
        return []
    return [
        f"In {len(narrow)} of them more than a quarter of the {blocks} are left out, because not "
        f"every method has them ({narrow[0]})."
    ]


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
    clauses = [f"{side}: {listed(names)}" for side, names in named.items() if names]
    start = f"{_start([summary], question)}against {against}, {question.metric} is "
    if not clauses:
        return [f"{start}not significantly different for any method (p < {LEVEL:g} after Holm)."]
    return [f"{start}significantly {'; '.join(clauses)} (p < {LEVEL:g} after Holm)."]


def _start(same: Sequence[Summary], question: Question) -> str:
    if len(question.within) == 1:
        places = f"{question.within[0]} {listed([summary.group.labels[0] for summary in same])}"
    else:
        places = "; ".join(group_text(summary.group, question) for summary in same)
    return start_text(places)


def _numbers_of(same: Sequence[Summary], unit: str) -> str:
    """Return the best mean and its interval, or from where to where the best means of groups go."""
    bests = [(summary, summary.best) for summary in same if summary.best is not None]
    if len(bests) == 1:
        return _numbers(*bests[0], unit)
    means = [float(summary.mean[place]) for summary, place in bests]
    counts = sorted({int(summary.blocks[place]) for summary, place in bests})
    blocks = f"{counts[0]} blocks" if len(counts) == 1 else f"{counts[0]} to {counts[-1]} blocks"
    ends = sorted({min(means), max(means)})
    return f"{_valued(ends, unit)}, {blocks} each"


def _numbers(summary: Summary, place: int, unit: str) -> str:
    count = int(summary.blocks[place])
    text = _valued([float(summary.mean[place])], unit)
    if count < FEWEST:
        return f"{text}, {'one block' if count == 1 else f'{count} blocks'}"
    ends = [float(summary.low[place]), float(summary.high[place])]
    bare = _valued(ends, unit if unit == "share" else "")
    return f"{text}, interval {bare}, {count} blocks"


def _valued(values: Sequence[float], unit: str) -> str:
    """Return numbers from first to last with their unit; shares in percent."""
    if unit == "share":
        values, unit = [100 * value for value in values], "%"
    return f"{' to '.join(f'{value:.3g}' for value in values)} {unit_text(unit)}".rstrip()


def _span(summary: Summary, question: Question, unit: str) -> str:
    """Return the extremes of a metric of which neither end is better."""
    low, high = int(np.nanargmin(summary.mean)), int(np.nanargmax(summary.mean))
    ends = [f"{_name(summary, place)} ({_numbers(summary, place, unit)})" for place in (low, high)]
    return f"the mean {question.metric} is lowest for {ends[0]} and highest for {ends[1]}"


def _rest(summary: Summary) -> str:
    worse = np.flatnonzero((summary.blocks > 0) & ~summary.bests).tolist()
    count = len(summary.values)
    if count < FEWEST:
        subject = "one block says" if count == 1 else f"{count} blocks say"
        return f"; {subject} nothing of how far the others are apart"
    if not worse:
        return ""
    close = [_name(summary, place) for place in worse if not summary.behind[place]]
    if not close:
        return "; every other method is clearly behind"
    more = len(worse) - len(close)
    rest = f"; the {'other' if more == 1 else f'other {more}'} clearly behind" if more else ""
    best = "them" if np.count_nonzero(summary.bests) > 1 else "it"
    return f"; not clearly apart from {best}: {listed(close)}{rest}"


def _best_names(summary: Summary) -> str:
    return listed(_bests(summary))


def _bests(summary: Summary) -> list[str]:
    return [_name(summary, place) for place in np.flatnonzero(summary.bests).tolist()]


def _name(summary: Summary, place: int) -> str:
    return str(summary.group.methods[place])

"""Notes below a table of means: what its numbers are, and what the verdicts rest on."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nodegraph import listed
from nodegraph_compare.inference import CONFIDENCE, LEVEL
from nodegraph_compare.left_out import block_text, end_text, filled, start_text
from nodegraph_compare.words import (
    change_of,
    few_blocks_text,
    group_title,
    plain_names,
    rules_text,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from nodegraph_compare.question import Question
    from nodegraph_compare.verdict import Verdict, Verdicts

_MOST_NOTES = 20

_MISSING = (
    "All statistics use only blocks in which every method with any number has all its numbers."
)
_FILLED = (
    "Where a method has no number in a block, that of {} stands; mean, common blocks: over those "
    "that all methods have; mean, worst of block: with the worst value of the block instead."
)


def notes(verdicts: Verdicts, question: Question) -> list[str]:
    """Return the meaning of the numbers of the table, and the data behind them."""
    groups, fallback = verdicts.groups, verdicts.fallback
    clusters = max((group.scope.clusters for group in groups), default=1)
    of = "the best" if verdicts.baseline is None else str(verdicts.baseline)
    ratio = verdicts.ratio
    what = "ratio of mean errors" if ratio else "difference of means"
    sentences = [
        f"{block_text(question)} {end_text(question)} "
        f"{rules_text(question, verdicts.units, clusters)}",
        f"{_MISSING if fallback is None else _FILLED.format(fallback)} {_number(verdicts)} "
        f"[low, high] beside a mean: its {100 * CONFIDENCE:.0f} % interval over units, not "
        "adjusted for the number of intervals; median: over blocks.",
    ]
    if any(group.paired is not None for group in groups):
        also = (
            f" difference: of means to {of}, its ends those of the ratio, less 1, times that mean."
            if ratio
            else ""
        )
        sentences.append(
            f"{'ratio' if ratio else 'difference'}: {what} to {of}, paired by units, with "
            f"{100 * CONFIDENCE:.0f} % intervals and p (at most {LEVEL:g}: clearly apart) by "
            "Tukey's range with the larger of a pair's own and the pooled standard error, over "
            "all pairs of a group, in steps: what is clearly apart is set aside, and the rest is "
            "judged again by itself; p and interval of a method are of the step in which it was "
            f"set aside, or of the last.{also} g: the mean difference over its standard deviation, "
            "above 0 where worse "
            f"than {of}; wins: units in which it is better; margin: the smallest within which it "
            "is shown to be equal (two one-sided tests at 5 %)."
        )
    if len(groups) > 1 and any(group.judged for group in groups):
        sentences.append(
            f"p is adjusted within a group: a claim that rests on any of the {len(groups)} "
            f"groups must multiply it by {len(groups)}."
        )
    if verdicts.overall is not None:
        sentences.append(
            "all: of each unit, the geometric mean of its means over the groups; p is of one "
            "comparison, without a factor for several groups."
        )
    for remark in (_few, _usual, _taken, _by_fallback, _doubts, _suspects):
        sentences += _of_groups(verdicts, remark)
    return sentences


def _number(verdicts: Verdicts) -> str:
    """Return what the number of a method is made of."""
    what = "their geometric mean" if verdicts.ratio else "their mean, as some are 0 or below"
    if verdicts.metric.better == "none":
        what = "their mean"
    clusters = max((group.scope.clusters for group in verdicts.groups), default=1)
    of = f"of each of the {verdicts.units}, of these {what}" if clusters > 1 else "of the recording"
    return (
        f"mean: over the blocks {of}; it depends on no other method, but for blocks that are left "
        "out because another lacks them."
    )


def _of_groups(verdicts: Verdicts, remark: Callable[[Verdicts, Verdict], str]) -> list[str]:
    """Return remarks on groups, the same remark on several once."""
    same: dict[str, list[str]] = {}
    every = range(len(verdicts.within))
    for group in verdicts.groups:
        if text := remark(verdicts, group):
            same.setdefault(text, []).append(group_title(verdicts, group, every))
    more = len(same) - _MOST_NOTES
    count = len(verdicts.groups)
    texts = [
        f"{'' if len(names) == count > 1 else start_text('; '.join(names))}{text}."
        for text, names in list(same.items())[:_MOST_NOTES]
    ]
    return texts + ([f"and so in {more} more groups"] if more > 0 else [])


def _few(_: Verdicts, group: Verdict) -> str:
    return few_blocks_text(group.scope)


def _usual(verdicts: Verdicts, group: Verdict) -> str:
    """Return which method is better in most blocks, where that is not the best one."""
    if group.usual is None:
        return ""
    place, share = group.usual
    (name,) = plain_names(verdicts, [place])
    return (
        f"{name} is better than {listed(plain_names(verdicts, group.best))} in most "
        f"{verdicts.blocks} ({100 * share:.0f} %), so that few large errors decide the mean"
    )


def _taken(verdicts: Verdicts, group: Verdict) -> str:
    taken = zip(verdicts.methods, group.taken.tolist(), strict=True)
    return filled(taken, group.of_blocks, verdicts.fallback, verdicts.blocks)


def _by_fallback(verdicts: Verdicts, group: Verdict) -> str:
    """Return the methods that are behind only because another's values replace missing ones."""
    worse = group.worse_than_best
    names = plain_names(verdicts, [place for place in group.tied if place in worse])
    if not names:
        return ""
    return (
        f"clearly behind only with {verdicts.fallback} in place of missing "
        f"{verdicts.blocks}: {listed(names)}"
    )


def _doubts(verdicts: Verdicts, group: Verdict) -> str:
    """Return which differences rest on normally distributed units."""
    doubtful = [] if group.paired is None else group.paired.doubtful.nonzero()[0].tolist()
    if not doubtful:
        return ""
    return (
        f"{listed(plain_names(verdicts, doubtful))}: the t-test alone finds a difference that sign "
        "flips do not confirm (p of flips); it rests on units that are normally distributed"
    )


def _suspects(verdicts: Verdicts, group: Verdict) -> str:
    """Return notes on the blocks whose truth is suspect, and on the answer without them."""
    other = group.without_suspects
    if other is None:
        return ""
    names, more = group.suspects[:_MOST_NOTES], len(group.suspects) - _MOST_NOTES
    rest = f"; and {more} more" if more > 0 else ""
    change = change_of(verdicts, group, other) or "the answer is the same"
    return f"without suspect {verdicts.blocks} {change} ({'; '.join(names)}{rest})"

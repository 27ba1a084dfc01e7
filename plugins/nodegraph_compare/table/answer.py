"""Sentences on a table of means: the best of each group, and which methods are behind it."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import listed
from nodegraph_compare.inference import CONFIDENCE, LEVEL
from nodegraph_compare.left_out import (
    MOST_GROUPS,
    block_text,
    end_text,
    filled,
    group_text,
    narrowed,
    numberless,
    start_text,
)
from nodegraph_compare.question import sign_of
from nodegraph_compare.scope import caution, few_blocks, rules, scope
from nodegraph_compare.table.sensitivity import (
    PLAIN,
    behind_by_all_rules,
    change_to,
    objections,
    suspects_text,
)
from nodegraph_tables.style import unit_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nodegraph import Label
    from nodegraph_compare.question import Question
    from nodegraph_compare.table.summary import Paired, Summary

_NOTED = 20
_MISSING = (
    "All statistics use only blocks in which every method with any number has all its numbers."
)
_FILLED = (
    "Where a method has no number in a block, that of {} stands; mean, common blocks: over those "
    "that all methods have; mean, worst of block: with the worst value of the block instead."
)
_MOST_BLOCKS = 0.55
"""Share of the blocks in which another method than the best is better for a remark."""

_EXTREME = {"lower": "lowest", "higher": "highest"}


def answers(
    summaries: Sequence[Summary],
    question: Question,
    unit: str,
    blocks: str,
    fallback: Label | None,
) -> list[str]:
    """Return the sentences on all groups: one on each, or on all of them where there are many.

    Parameters
    ----------
    summaries, question
        Of the comparison.
    unit
        Of the metric.
    blocks
        What several blocks are called.
    fallback
        The method whose values stand where another has none.
    """
    if len(summaries) > MOST_GROUPS and question.compare and question.better != "none":
        return [
            _counted(summaries, question, blocks),
            *_narrow_groups(summaries, blocks),
            *_unsteady_groups(summaries, blocks),
        ]
    sentences = []
    for same in _alike(summaries[:MOST_GROUPS], question, blocks, fallback):
        sentences.append(f"{_Answer(same, question, unit, blocks, fallback).text()}.")
        for summary in same:
            sentences += _to_baseline(summary, question)
    rest = len(summaries) - MOST_GROUPS
    return sentences + ([f"{rest} more groups are in the table."] if rest > 0 else [])


def notes(
    summaries: Sequence[Summary],
    question: Question,
    against: Label | None,
    fallback: Label | None,
) -> list[str]:
    """Return what the numbers of the table mean.

    Parameters
    ----------
    summaries, question
        Of the comparison.
    against
        The baseline's label, if there is one.
    fallback
        The method whose values stand where another has none.
    """
    of = "the best" if against is None else str(against)
    ratio = all(summary.ratio for summary in summaries)
    what = "ratio of mean errors" if ratio else "difference of means"
    sentences = [
        f"{block_text(question)} {end_text(question)} {rules(question)}",
        f"{_MISSING if fallback is None else _FILLED.format(fallback)} [low, high] beside a "
        f"mean: its {CONFIDENCE:.0%} interval over units, not adjusted for the number of "
        "intervals; median: over blocks.",
    ]
    if any(summary.paired is not None for summary in summaries):
        sentences.append(
            f"{'ratio' if ratio else 'difference'}: {what} to {of}, paired by units, with "
            f"{CONFIDENCE:.0%} intervals and p (at most {LEVEL:g}: clearly apart) by Tukey's range "
            "with the larger of a pair's own and the pooled standard error, over all pairs of a "
            "group. g: the mean difference over its standard deviation, above 0 where worse than "
            f"{of}; wins: units in which it is better; margin: the smallest within which it is "
            "shown to be equal (two one-sided tests at 5 %)."
        )
    if len(summaries) > 1 and any(summary.judged for summary in summaries):
        sentences.append(
            f"p is adjusted within a group: a claim that rests on any of the {len(summaries)} "
            f"groups must multiply it by {len(summaries)}."
        )
    for summary in summaries:
        start = start_text(group_text(summary.group, question))
        if few := few_blocks(summary.units, question):
            sentences.append(f"{start}{few}.")
        sentences += [f"{start}{text}" for text in _doubts(summary)]
        sentences += _suspects(summary, start)
    return sentences


def _suspects(summary: Summary, start: str) -> list[str]:
    """Return the blocks whose truth is suspect."""
    names, more = summary.suspects[:_NOTED], len(summary.suspects) - _NOTED
    rest = f"; and {more} more" if more > 0 else ""
    return [f"{start}the truth is suspect in {'; '.join(names)}{rest}."] if names else []


def _doubts(summary: Summary) -> list[str]:
    """Return which differences rest on normally distributed units."""
    paired = summary.paired
    names = [] if paired is None else _names(summary, paired.doubtful)
    if not names:
        return []
    return [
        f"{listed(names)}: the t-test alone finds a difference that sign flips do not confirm "
        "(p of flips); it rests on units that are normally distributed."
    ]


def _alike(
    summaries: Sequence[Summary], question: Question, blocks: str, fallback: Label | None
) -> list[list[Summary]]:
    """Return the groups whose sentences differ only in their numbers, together."""
    together: dict[object, list[Summary]] = {}
    for place, summary in enumerate(summaries):
        answer = _Answer([summary], question, "", blocks, fallback)
        key = place if summary.best is None or not summary.judged else answer.rest()
        together.setdefault((_best_names(summary), key), []).append(summary)
    return list(together.values())


class _Answer:
    """The sentence on groups that are alike: which mean is best, which are not behind it."""

    def __init__(
        self,
        same: Sequence[Summary],
        question: Question,
        unit: str,
        blocks: str,
        fallback: Label | None,
    ) -> None:
        self._same, self._question, self._unit, self._blocks = same, question, unit, blocks
        self._summary, self._fallback = same[0], fallback

    def text(self) -> str:
        """Return the sentence, without its full stop."""
        summary, question = self._summary, self._question
        start = _start(self._same, question)
        absent = numberless(summary.group)
        end = f"; {absent}" if absent else ""
        if not summary.blocks.any():
            return f"{start}no block has a number for every method; nothing can be said{end}"
        if not question.compare:
            numbers = self._numbers(summary, 0)
            return f"{start}the mean {question.metric} is known ({numbers}){end}"
        if np.count_nonzero(summary.blocks) == 1:
            only = int(np.flatnonzero(summary.blocks)[0])
            numbers = self._numbers(summary, only)
            name = _name(summary, only)
            return f"{start}only {name} has a mean {question.metric} ({numbers}){end}"
        if summary.best is None:
            return f"{start}{self._span()}{self._over()}{end}"
        verb = "share" if np.count_nonzero(summary.bests) > 1 else "has"
        best = f"{_best_names(summary)} {verb} the {_EXTREME[question.better]} mean"
        numbers = self._numbers_of()
        return f"{start}{best} {question.metric} ({numbers}){self.rest()}"

    def rest(self) -> str:
        """Return what follows the best mean: for what it holds, and what is not behind."""
        summary = self._summary
        units = summary.units
        absent = numberless(summary.group)
        suspect = suspects_text(summary, self._blocks)
        texts = [*self._verdict(), *filter(None, [suspect, absent])]
        held = f" {scope(units, self._question, self._blocks)}" if units.count else ""
        missing = filled(summary.group, self._fallback, self._blocks)
        return f"{held}{self._over()}{missing}" + "".join(f"; {text}" for text in texts)

    def _over(self) -> str:
        over = narrowed(self._summary.group, self._blocks)
        return f" ({over})" if over else ""

    def _verdict(self) -> list[str]:
        summary, question = self._summary, self._question
        if summary.units.speech == "nothing":
            why = summary.units.why or f"{summary.units.count} units"
            further = scope(summary.units, question, self._blocks)
            return [f"nothing can be said {further}: {why}", *self._typical()]
        few = caution(summary.units, question)
        objection = objections(summary, self._blocks)
        apart = self._apart() if summary.judged else []
        if objection:
            apart = [f"no verdict stands: {objection}"]
        return [*apart, *self._typical(), *([few] if few else [])]

    def _apart(self) -> list[str]:
        summary = self._summary
        worse = (summary.blocks > 0) & ~summary.bests
        if not worse.any():
            return []
        behind = behind_by_all_rules(summary)
        close = _names(summary, worse & ~behind)
        texts = ["every other method is clearly behind"]
        if close:
            more = np.count_nonzero(worse) - len(close)
            rest = f"; the {'other' if more == 1 else f'other {more}'} clearly behind"
            best = "them" if np.count_nonzero(summary.bests) > 1 else "it"
            texts = [f"not clearly apart from {best}: {listed(close)}{rest if more else ''}"]
        if depends := _names(summary, summary.behind & ~behind):
            texts.append(
                f"clearly behind only with {self._fallback} in place of missing {self._blocks}: "
                f"{listed(depends)}"
            )
        if summary.margin is not None and summary.paired is not None:
            texts.append(_equal(summary, summary.paired))
        return texts

    def _typical(self) -> list[str]:
        """Return which method is better in most blocks, where that is not the best one."""
        summary = self._summary
        first = int(np.nanargmin(summary.rank))
        values = summary.group.values[summary.group.complete]
        better = sign_of(summary.end) * (values[:, [first]] - values[:, summary.bests]) < 0.0
        share = float(better.mean())
        if summary.bests[first] or share < _MOST_BLOCKS:
            return []
        return [
            f"{_name(summary, first)} is better in most {self._blocks} ({share:.0%}), so that few "
            "large errors decide the mean"
        ]

    def _numbers_of(self) -> str:
        """Return the best mean and its interval, or the range of the best means of groups."""
        bests = [(summary, summary.best) for summary in self._same if summary.best is not None]
        if len(bests) == 1:
            return self._numbers(*bests[0])
        means = [float(summary.mean[place]) for summary, place in bests]
        counts = sorted({int(summary.blocks[place]) for summary, place in bests})
        span = f"{counts[0]}" if len(counts) == 1 else f"{counts[0]} to {counts[-1]}"
        ends = sorted({min(means), max(means)})
        return f"{_valued(ends, self._unit)}, {span} {self._blocks} each"

    def _numbers(self, summary: Summary, place: int) -> str:
        count = int(summary.blocks[place])
        several = (
            f"one {self._blocks.removesuffix('s')}" if count == 1 else f"{count} {self._blocks}"
        )
        text = _valued([float(summary.mean[place])], self._unit)
        if not np.isfinite(summary.low[place]):
            return f"{text}, {several}"
        ends = [float(summary.low[place]), float(summary.high[place])]
        bare = _valued(ends, self._unit if self._unit == "share" else "")
        return f"{text}, interval {bare}, {several}"

    def _span(self) -> str:
        """Return the extremes of a metric of which neither end is better."""
        summary = self._summary
        low, high = int(np.nanargmin(summary.mean)), int(np.nanargmax(summary.mean))
        ends = [f"{_name(summary, at)} ({self._numbers(summary, at)})" for at in (low, high)]
        metric = self._question.metric
        return f"the mean {metric} is lowest for {ends[0]} and highest for {ends[1]}"


def _equal(summary: Summary, paired: Paired) -> str:
    """Return which methods are practically equal to the reference."""
    names = _names(summary, summary.equal)
    to = _name(summary, paired.reference)
    if names:
        return f"equal to {to} within {summary.margin}: {listed(names)}"
    nearest = int(np.nanargmin(paired.margin))
    shown = f"{_name(summary, nearest)} within {paired.margin[nearest]:.3g}"
    return f"none is shown to be equal to {to} within {summary.margin} (nearest: {shown})"


def _counted(summaries: Sequence[Summary], question: Question, blocks: str) -> str:
    bests = (name for summary in summaries for name in _names(summary, summary.bests) or ["none"])
    (first, most), *wins = Counter(bests).most_common()
    rest = f", {listed([f'{name} in {count}' for name, count in wins])}" if wins else ""
    alone = sum(
        summary.judged and bool((summary.behind | summary.bests)[summary.blocks > 0].all())
        for summary in summaries
    )
    held = {scope(summary.units, question, blocks) for summary in summaries if summary.units.count}
    return (
        f"Of {len(summaries)} groups ({', '.join(question.within)}), {first} has the "
        f"{_EXTREME[question.better]} mean {question.metric} in {most}{rest}"
        f"{f' {listed(sorted(held))}' if held else ''}; all others are clearly behind in {alone}."
    )


def _narrow_groups(summaries: Sequence[Summary], blocks: str) -> list[str]:
    """Return in how many groups blocks are left out, and an example."""
    narrow = [over for summary in summaries if (over := narrowed(summary.group, blocks))]
    if not narrow:
        return []
    return [
        f"In {len(narrow)} of them {blocks} are left out, because not every method has them "
        f"({narrow[0]})."
    ]


def _unsteady_groups(summaries: Sequence[Summary], blocks: str) -> list[str]:
    """Return in how many groups another rule gives another answer."""
    texts = []
    for plain in (False, True):
        groups = [
            any(change_to(s, v.summary) for v in s.variants if (v.rule == PLAIN) == plain)
            for s in summaries
        ]
        if any(groups):
            what = f"without suspect {blocks}" if plain else f"by another rule for missing {blocks}"
            texts.append(f"In {sum(groups)} of them the answer is another {what}.")
    return texts


def _to_baseline(summary: Summary, question: Question) -> list[str]:
    """Return which methods differ from the baseline, where there is one."""
    paired = summary.paired
    if summary.against is None or paired is None or not summary.judged:
        return []
    middle = 1.0 if summary.ratio else 0.0
    sides = (("lower", paired.value < middle), ("higher", paired.value > middle))
    named = {side: _names(summary, paired.apart & where) for side, where in sides}
    differing = [f"{side}: {listed(names)}" for side, names in named.items() if names]
    to = _name(summary, summary.against)
    start = f"{_start([summary], question)}against {to}, {question.metric} is "
    if not differing:
        return [f"{start}not significantly different for any method (p < {LEVEL:g})."]
    return [f"{start}significantly {'; '.join(differing)} (p < {LEVEL:g})."]


def _start(same: Sequence[Summary], question: Question) -> str:
    if len(question.within) == 1:
        places = f"{question.within[0]} {listed([summary.group.labels[0] for summary in same])}"
    else:
        places = "; ".join(group_text(summary.group, question) for summary in same)
    return start_text(places)


def _valued(values: Sequence[float], unit: str) -> str:
    """Return numbers from first to last with their unit; shares in percent."""
    if unit == "share":
        values, unit = [100 * value for value in values], "%"
    return f"{' to '.join(f'{value:.3g}' for value in values)} {unit_text(unit)}".rstrip()


def _best_names(summary: Summary) -> str:
    return listed(_names(summary, summary.bests))


def _names(summary: Summary, where: np.typing.NDArray[np.bool_]) -> list[str]:
    return [_name(summary, place) for place in np.flatnonzero(where).tolist()]


def _name(summary: Summary, place: int) -> str:
    return str(summary.group.methods[place])

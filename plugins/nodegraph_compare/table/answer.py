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
    start_text,
)
from nodegraph_compare.question import EXTREME, sign_of
from nodegraph_compare.scope import few_blocks, rules, scope
from nodegraph_compare.scope import unit_text as units_text
from nodegraph_compare.table.sensitivity import (
    PLAIN,
    apart_by_all_rules,
    change_to,
    equal_by_all_rules,
    other_best,
    tied_with_best,
    without_suspects,
)
from nodegraph_compare.table.verdict import verdict_on
from nodegraph_compare.unused_axes import unused_axes
from nodegraph_tables.style import scale_of, unit_text

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from nodegraph import Label
    from nodegraph_compare.comparison import Comparison
    from nodegraph_compare.question import Question
    from nodegraph_compare.table.summary import Paired, Summary
    from nodegraph_compare.table.verdict import Verdict

_MOST_NOTES = 20
_MOST_TIES = 5
"""Names in a sentence; the table marks all of them."""

_MISSING = (
    "All statistics use only blocks in which every method with any number has all its numbers."
)
_FILLED = (
    "Where a method has no number in a block, that of {} stands; mean, common blocks: over those "
    "that all methods have; mean, worst of block: with the worst value of the block instead."
)
_MOST_BLOCKS = 0.55
"""Share of the blocks in which another method than the best is better for a remark."""


def answers(
    comparison: Comparison, summaries: Sequence[Summary], overall: Summary | None
) -> list[str]:
    """Return the sentences on all groups: a line on each, or on all of them where there are many.

    After them, which axes that means are taken over change nothing for some of the methods.

    Parameters
    ----------
    comparison, summaries
        What is compared, and the summary of each group.
    overall
        Over all groups, where these can be taken together.
    """
    also = [] if overall is None else [_over_groups(comparison, summaries, overall)]
    question = comparison.question
    apart = (*question.within, *question.compared)
    alike = unused_axes(comparison.scores, question.compare).items()
    means = [f"{text}." for axis, text in alike if axis not in apart]
    return [*_of_groups(comparison, summaries), *also, *means]


def _of_groups(comparison: Comparison, summaries: Sequence[Summary]) -> list[str]:
    question = comparison.question
    if len(summaries) > MOST_GROUPS and question.compare and question.better != "none":
        return [
            _counted(summaries, question, comparison.blocks),
            *_narrow_groups(summaries, comparison.blocks),
            *_unsteady_groups(summaries, comparison.blocks),
        ]
    sentences = []
    for same in _alike(summaries[:MOST_GROUPS], comparison):
        start = _start(same, question)
        sentences.append(f"{start}{_means(same, comparison)}{_verdict(same[0], comparison)}.")
        for summary in same:
            sentences += _to_baseline(summary, question)
    rest = len(summaries) - MOST_GROUPS
    return sentences + ([f"{rest} more groups are in the table."] if rest > 0 else [])


def _over_groups(comparison: Comparison, summaries: Sequence[Summary], overall: Summary) -> str:
    best = _best(overall, comparison.question.metric)
    return f"all {len(summaries)} groups: {best}{_verdict(overall, comparison)}."


def notes(
    comparison: Comparison,
    summaries: Sequence[Summary],
    against: Label | None,
    overall: Summary | None,
) -> list[str]:
    """Return the meaning of the numbers of the table, and the data behind them.

    Parameters
    ----------
    comparison, summaries
        What is compared, and the summary of each group.
    against
        The baseline's label, if there is one.
    overall
        Over all groups, where these can be taken together.
    """
    question, fallback = comparison.question, comparison.fallback
    of = "the best" if against is None else str(against)
    ratio = all(summary.ratio for summary in summaries)
    what = "ratio of mean errors" if ratio else "difference of means"
    sentences = [
        f"{block_text(question)} {end_text(question)} {rules(question)}",
        f"{_MISSING if fallback is None else _FILLED.format(fallback)} [low, high] beside a "
        f"mean: its {100 * CONFIDENCE:.0f} % interval over units, not adjusted for the number of "
        "intervals; median: over blocks.",
    ]
    if any(summary.paired is not None for summary in summaries):
        also = (
            f" difference: of means to {of}, its ends those of the ratio, less 1, times that mean."
            if ratio
            else ""
        )
        sentences.append(
            f"{'ratio' if ratio else 'difference'}: {what} to {of}, paired by units, with "
            f"{100 * CONFIDENCE:.0f} % intervals and p (at most {LEVEL:g}: clearly apart) by "
            "Tukey's range with the larger of a pair's own and the pooled standard error, over "
            f"all pairs of a group.{also} g: the mean difference over its standard deviation, "
            "above 0 where worse "
            f"than {of}; wins: units in which it is better; margin: the smallest within which it "
            "is shown to be equal (two one-sided tests at 5 %)."
        )
    if len(summaries) > 1 and any(summary.judged for summary in summaries):
        sentences.append(
            f"p is adjusted within a group: a claim that rests on any of the {len(summaries)} "
            f"groups must multiply it by {len(summaries)}."
        )
    if overall is not None:
        sentences.append(
            "all: of each unit, the geometric mean of its means over the groups; p is of one "
            "comparison, without a factor for several groups."
        )
    for remark in (_few, _typical, _by_mean, _taken, _by_fallback, _doubts, _suspects):
        sentences += _together(summaries, comparison, remark)
    return sentences


def _together(
    summaries: Sequence[Summary],
    comparison: Comparison,
    remark: Callable[[Summary, Comparison], str],
) -> list[str]:
    """Return remarks on groups, the same remark on several once."""
    groups: dict[str, list[str]] = {}
    for summary in summaries:
        if text := remark(summary, comparison):
            name = group_text(summary.group, comparison.question)
            groups.setdefault(text, []).append(name)
    more = len(groups) - _MOST_NOTES
    texts = [
        f"{'' if len(names) == len(summaries) > 1 else start_text('; '.join(names))}{text}."
        for text, names in list(groups.items())[:_MOST_NOTES]
    ]
    return texts + ([f"and so in {more} more groups"] if more > 0 else [])


def _few(summary: Summary, comparison: Comparison) -> str:
    return few_blocks(summary.units, comparison.question)


def _typical(summary: Summary, comparison: Comparison) -> str:
    """Return which method is better in most blocks, where that is not the best one."""
    if summary.best is None or not summary.blocks.any():
        return ""
    first = int(np.nanargmin(summary.rank))
    values = summary.group.values[summary.group.complete]
    better = sign_of(summary.end) * (values[:, [first]] - values[:, summary.bests]) < 0.0
    share = float(better.mean())
    if summary.bests[first] or share < _MOST_BLOCKS:
        return ""
    return (
        f"{_name(summary, first)} is better than {_best_names(summary)} in most "
        f"{comparison.blocks} ({100 * share:.0f} %), so that few large errors decide the mean"
    )


def _by_mean(summary: Summary, comparison: Comparison) -> str:
    """Return which method has the best mean, where that is not the best one."""
    if summary.best is None or (summary.bests & summary.best_by_mean).any():
        return ""
    units = units_text(summary.units, comparison.question)
    return (
        f"{listed(_names(summary, summary.best_by_mean))} has the {EXTREME[summary.end]} mean over "
        f"{units}, and {_best_names(summary)} the best mean ratio, in which units with large "
        "values weigh no more than others; the verdict is by ratios"
    )


def _taken(summary: Summary, comparison: Comparison) -> str:
    return filled(summary.group, comparison.fallback, comparison.blocks)


def _by_fallback(summary: Summary, comparison: Comparison) -> str:
    """Return the methods that are behind only because another's values replace missing ones."""
    names = _names(summary, tied_with_best(summary) & summary.behind)
    if not names:
        return ""
    return (
        f"clearly behind only with {comparison.fallback} in place of missing "
        f"{comparison.blocks}: {listed(names)}"
    )


def _doubts(summary: Summary, comparison: Comparison) -> str:
    """Return which differences rest on normally distributed units."""
    paired = summary.paired
    names = [] if paired is None else _names(summary, paired.doubtful)
    if not names:
        return ""
    return (
        f"{listed(names)}: the t-test alone finds a difference that sign flips do not confirm "
        "(p of flips); it rests on units that are normally distributed"
    )


def _suspects(summary: Summary, comparison: Comparison) -> str:
    """Return notes on the blocks whose truth is suspect, and on the answer without them."""
    other = without_suspects(summary)
    if other is None:
        return ""
    names, more = summary.suspects[:_MOST_NOTES], len(summary.suspects) - _MOST_NOTES
    rest = f"; and {more} more" if more > 0 else ""
    change = change_to(summary, other) or "the answer is the same"
    return f"without suspect {comparison.blocks} {change} ({'; '.join(names)}{rest})"


def _alike(summaries: Sequence[Summary], comparison: Comparison) -> list[list[Summary]]:
    """Return the groups whose sentences differ only in their numbers, together."""
    together: dict[object, list[Summary]] = {}
    for place, summary in enumerate(summaries):
        text = _verdict(summary, comparison)
        key = place if summary.best is None or not summary.judged else text
        best = summary.best is not None and _best(summary, comparison.question.metric)
        together.setdefault((best, key), []).append(summary)
    return list(together.values())


def _means(same: Sequence[Summary], comparison: Comparison) -> str:
    """Return the best mean of a group, or of groups that are alike."""
    summary, metric = same[0], comparison.question.metric
    if not summary.blocks.any():
        return "no block has a number for every method; nothing can be said"
    if not comparison.question.compare:
        return f"the mean {metric} is known ({_numbers(summary, 0, comparison)})"
    if np.count_nonzero(summary.blocks) == 1:
        only = int(np.flatnonzero(summary.blocks)[0])
        numbers = _numbers(summary, only, comparison)
        return f"only {_name(summary, only)} has a mean {metric} ({numbers})"
    if summary.best is None:
        ends = (int(np.nanargmin(summary.mean)), int(np.nanargmax(summary.mean)))
        low, high = (f"{_name(summary, at)} ({_numbers(summary, at, comparison)})" for at in ends)
        return f"the mean {metric} is lowest for {low} and highest for {high}"
    best = _best(summary, metric)
    if len(same) == 1:
        return f"{best} ({_numbers(summary, summary.best, comparison)})"
    means = [float(each.mean[each.best]) for each in same if each.best is not None]
    return f"{best} ({_valued(sorted({min(means), max(means)}), comparison.unit)})"


def _best(summary: Summary, metric: str) -> str:
    """Return which methods are best, and by what: ``near has the lowest mean rmse``."""
    names, several = _best_names(summary), np.count_nonzero(summary.bests) > 1
    if (summary.bests & summary.best_by_mean).any():
        return f"{names} {'share' if several else 'has'} the {EXTREME[summary.end]} mean {metric}"
    return f"{names} {'are' if several else 'is'} best in {metric} by the mean ratio"


def _verdict(summary: Summary, comparison: Comparison) -> str:
    """Return the text after the best mean: its scope, and the methods not behind."""
    question, blocks = comparison.question, comparison.blocks
    if np.count_nonzero(summary.blocks) < 2 or summary.best is None:
        return ""
    verdict = verdict_on(summary, question, blocks)
    if verdict.speech == "nothing":
        return f"; nothing can be said {verdict.scope}: {verdict.caution}"
    texts = _apart(summary, verdict) if summary.judged else []
    if verdict.objection:
        texts = [f"no verdict stands: {verdict.objection}"]
    elif summary.judged and summary.margin is not None and summary.paired is not None:
        texts.append(_equal(summary, summary.paired))
    other = without_suspects(summary)
    change = "" if other is None else other_best(summary, other)
    texts += filter(None, [change and f"without suspect {blocks} {change}", verdict.caution])
    return f" {verdict.scope}" + "".join(f"; {text}" for text in texts)


def _apart(summary: Summary, verdict: Verdict) -> list[str]:
    close, behind = _names(summary, verdict.tied), np.count_nonzero(verdict.behind)
    if not close:
        return ["every other method is clearly behind"] if behind else []
    best = "them" if np.count_nonzero(verdict.best) > 1 else "it"
    rest = f"; the {'other' if behind == 1 else f'other {behind}'} clearly behind"
    return [f"not clearly apart from {best}: {listed(close, _MOST_TIES)}{rest if behind else ''}"]


def _numbers(summary: Summary, place: int, comparison: Comparison) -> str:
    """Return a mean with its interval, and its number of blocks where some are left out."""
    unit = comparison.unit
    text = _valued([float(summary.mean[place])], unit)
    if np.isfinite(summary.low[place]):
        ends = [float(summary.low[place]), float(summary.high[place])]
        interval = _valued(ends, unit if unit == "share" else "")
        # one without width in the digits shown says nothing
        text += f", interval {interval}" if " to " in interval else ""
    used, total = int(summary.blocks[place]), len(summary.group.values)
    return text if used == total else f"{text}, {used} of {total} {comparison.blocks}"


def _equal(summary: Summary, paired: Paired) -> str:
    """Return which methods are practically equal to the reference."""
    names = _names(summary, equal_by_all_rules(summary))
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
        f"{EXTREME[question.better]} mean {question.metric} in {most}{rest}"
        f"{f' {listed(sorted(held))}' if held else ''}; all others are clearly behind in {alone}."
    )


def _narrow_groups(summaries: Sequence[Summary], blocks: str) -> list[str]:
    """Return a note on the groups in which blocks are left out, with an example."""
    narrow = [over for summary in summaries if (over := narrowed(summary.group, blocks))]
    if not narrow:
        return []
    return [
        f"In {len(narrow)} of them {blocks} are left out, because not every method has them "
        f"({narrow[0]})."
    ]


def _unsteady_groups(summaries: Sequence[Summary], blocks: str) -> list[str]:
    """Return a note on the groups in which another rule gives another answer."""
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
    sides = zip(("lower", "higher"), apart_by_all_rules(summary), strict=True)
    named = {side: _names(summary, where) for side, where in sides}
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
    texts = dict.fromkeys(f"{scale_of(unit) * value:.3g}" for value in values)
    return f"{' to '.join(texts)} {unit_text(unit)}".rstrip()


def _best_names(summary: Summary) -> str:
    return listed(_names(summary, summary.bests))


def _names(summary: Summary, where: np.typing.NDArray[np.bool_]) -> list[str]:
    return [_name(summary, place) for place in np.flatnonzero(where).tolist()]


def _name(summary: Summary, place: int) -> str:
    return str(summary.group.methods[place])

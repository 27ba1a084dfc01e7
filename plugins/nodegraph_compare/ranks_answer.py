"""What a ranking says, in sentences."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import listed
from nodegraph_compare.left_out import group_text, narrowed
from nodegraph_compare.statistics import LEVEL

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nodegraph_compare.question import Question
    from nodegraph_compare.ranking import PairTest, Ranking

_MOST_GROUPS = 12
_TESTS = {"nemenyi": "Nemenyi's test", "wilcoxon_holm": "Wilcoxon's test with Holm's correction"}


def answers(found: Sequence[Ranking], question: Question, test: PairTest, blocks: str) -> list[str]:
    """Return a sentence on each group, or one on all where there are many.

    `blocks` is what several blocks are called.
    """
    if len(found) > _MOST_GROUPS:
        return [_counted(found, question)]
    return [answer(one, question, test, blocks) for one in found]


def answer(ranking: Ranking, question: Question, test: PairTest, name: str) -> str:
    """Return who ranks first, whether chance could do that, and who is not apart from the first.

    Where over a quarter of the blocks are left out, that is told too; `name` is what several of
    them are called.
    """
    place = group_text(ranking.group, question)
    start = f"{place}: " if place else ""
    count, blocks = len(ranking.methods), len(ranking.values)
    if not blocks:
        return f"{start}no block has a number for every method; nothing can be ranked."
    first = int(np.argmin(ranking.ranks))
    if count == 1:
        return f"{start}only {ranking.methods[0]} has numbers; there is nothing to rank."
    several = f"{blocks} blocks" if blocks > 1 else "one block"
    several = narrowed(ranking.group, name) or several
    told = (
        f"{start}{ranking.methods[first]} has the lowest mean rank "
        f"({ranking.ranks[first]:.2f} of {count} methods, {several})"
    )
    if count == 2:
        return f"{told}; {_two(ranking)}."
    if blocks == 1:
        return f"{told}; one block says nothing of chance."
    return f"{told}; {_many(ranking, first, test)}."


def chance(p: float) -> str:
    """Return a p for a sentence: ``p = 0.034``, ``p < 0.001``."""
    return "p < 0.001" if p < 0.001 else f"p = {p:.3f}"


def _two(ranking: Ranking) -> str:
    p = float(ranking.pairs.p[0])
    apart = "apart" if p < LEVEL else "not clearly apart"
    return f"the two are {apart} by Wilcoxon's signed-rank test ({chance(p)})"


def _many(ranking: Ranking, first: int, test: PairTest) -> str:
    overall, pairs = ranking.overall, ranking.pairs
    told = f"F = {overall.f:.3g}, {chance(overall.p_f)}; Kendall's W = {overall.w:.2f}"
    if overall.p_f >= LEVEL:
        return f"Friedman's test does not tell the methods apart ({told})"
    others = [
        int(b if a == first else a)
        for a, b, p in zip(pairs.first, pairs.second, pairs.p, strict=True)
        if first in (a, b) and p >= LEVEL
    ]
    close = [str(ranking.methods[one]) for one in sorted(others, key=lambda at: ranking.ranks[at])]
    rest = f"not apart from it: {listed(close)}" if close else "all others are apart from it"
    return f"the methods differ by Friedman's test ({told}); by {_TESTS[test]} {rest}"


def _counted(found: Sequence[Ranking], question: Question) -> str:
    ranked = [one for one in found if len(one.values)]
    wins = Counter(str(one.methods[int(np.argmin(one.ranks))]) for one in ranked).most_common()
    told = listed([f"{name} in {count}" for name, count in wins])
    differ = sum(one.overall.p_f < LEVEL for one in ranked)
    return (
        f"Of {len(found)} groups ({', '.join(question.within)}), the lowest mean rank has {told}; "
        f"in {differ} of them Friedman's test tells the methods apart."
    )

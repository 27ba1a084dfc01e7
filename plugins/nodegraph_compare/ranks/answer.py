"""Sentences on rankings."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import listed
from nodegraph_compare.inference import LEVEL
from nodegraph_compare.left_out import (
    MOST_GROUPS,
    filled_group,
    group_text,
    narrowed_group,
    numberless,
    start_text,
)
from nodegraph_compare.ranks.signed_rank import TEST_NAMES
from nodegraph_compare.verdict import scope_of
from nodegraph_compare.words import caution_text, scope_text
from nodegraph_tables.numbers import chance_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nodegraph_compare.comparison import Comparison
    from nodegraph_compare.question import Question
    from nodegraph_compare.ranks.ranking import PairTest, Ranking


def answers(rankings: Sequence[Ranking], comparison: Comparison, test: PairTest) -> list[str]:
    """Return a sentence on each group, or one on all where there are many.

    Parameters
    ----------
    rankings, comparison
        The ranking of each group, and what is compared.
    test
        Of the pairs.
    """
    if len(rankings) > MOST_GROUPS:
        return [_counted(rankings, comparison.question)]
    sentences = []
    for ranking in rankings:
        sentence = answer(ranking, comparison, test)
        absent = numberless(ranking.group)
        sentences.append(f"{sentence}; {absent}." if absent else f"{sentence}.")
    return sentences


def answer(ranking: Ranking, comparison: Comparison, test: PairTest) -> str:
    """Return which method ranks first, whether by chance, and which are not apart from it.

    Parameters
    ----------
    ranking, comparison
        Of a group, and what is compared.
    test
        Of the pairs.
    """
    question, name = comparison.question, comparison.blocks
    start = start_text(group_text(ranking.group, question))
    count, blocks = len(ranking.methods), int(ranking.group.complete.sum())
    if not blocks:
        return f"{start}no block has a number for every method; nothing can be ranked"
    if count == 1:
        return f"{start}only {ranking.methods[0]} has numbers; there is nothing to rank"
    units = ranking.units
    singular = name.removesuffix("s")
    several = f"{blocks} {name}" if blocks > 1 else f"one {singular}"
    several = narrowed_group(ranking.group, name) or several
    scope = scope_of(units, question, name)
    held = f" {scope_text(scope)}" if units.count else f" within {name}"
    first: list[int] = np.flatnonzero(ranking.first).tolist()
    taken = filled_group(ranking.group, comparison.fallback, name)
    missing = f", {taken}" if taken else ""
    verb = "has" if len(first) == 1 else "share"
    sentence = (
        f"{start}{ranking.first_names} {verb} the lowest mean rank "
        f"({ranking.ranks[first[0]]:.2f} of {count} methods, {several}){held}{missing}"
    )
    few = caution_text(scope)
    if units.speech == "nothing":
        return f"{sentence}; nothing can be said of chance: {few}"
    if units.speech == "described":
        return f"{sentence}; {few}"
    if objection := ranking.objections(name):
        return f"{sentence}; no verdict stands: {objection}{f'; {few}' if few else ''}"
    tested = _two(ranking) if count == 2 else _many(ranking, first, test)
    return f"{sentence}; {tested}{f'; {few}' if few else ''}"


def _two(ranking: Ranking) -> str:
    p = float(ranking.pairs.p[0])
    apart = "apart" if p < LEVEL else "not clearly apart"
    return f"the two are {apart} by Wilcoxon's signed-rank test ({chance_text(p)})"


def _many(ranking: Ranking, first: list[int], test: PairTest) -> str:
    overall, pairs = ranking.overall, ranking.pairs
    numbers = f"F = {overall.f:.3g}, {chance_text(overall.p_f)}; Kendall's W = {overall.w:.2f}"
    if not ranking.differ:
        return f"Friedman's test does not tell the methods apart ({numbers})"
    near = [
        {int(a), int(b)}
        for a, b, apart in zip(pairs.first, pairs.second, ranking.apart, strict=True)
        if not apart
    ]
    alike = {other for pair in near if pair & {*first} for other in pair - {*first}}
    order = sorted(sorted(alike), key=lambda at: ranking.ranks[at])
    close = [str(ranking.methods[place]) for place in order]
    them = "it" if len(first) == 1 else "them"
    rest = (
        f"not apart from {them}: {listed(close)}" if close else f"all others are apart from {them}"
    )
    return f"the methods differ by Friedman's test ({numbers}); by {TEST_NAMES[test]} {rest}"


def _counted(rankings: Sequence[Ranking], question: Question) -> str:
    ranked = [ranking for ranking in rankings if len(ranking.values)]
    firsts = (
        ranking.methods[place] for ranking in ranked for place in np.flatnonzero(ranking.first)
    )
    wins = Counter(str(name) for name in firsts).most_common()
    counts = listed([f"{name} in {count}" for name, count in wins])
    differ = sum(ranking.differ for ranking in ranked)
    against = sum(bool(ranking.objections("")) for ranking in ranked)
    unsteady = f"; in {against} another rule for missing blocks says otherwise" if against else ""
    return (
        f"Of {len(rankings)} groups ({', '.join(question.within)}), the lowest mean rank has "
        f"{counts}; in {differ} of them Friedman's test tells the methods "
        f"apart{unsteady}."
    )

"""The answer of ranks at a glance: a card per group with its first method."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph import listed
from nodegraph_compare.left_out import group_text
from nodegraph_compare.verdict import scope_of
from nodegraph_compare.words import caution_text, scope_text
from nodegraph_tables.lead import Card, Lead, Line, Text, dot, svg
from nodegraph_tables.numbers import chance_text, number_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from nodegraph_compare.question import Question
    from nodegraph_compare.ranks.ranking import Ranking

_MOST_NAMES = 4


def lead_of(rankings: Sequence[Ranking], question: Question, blocks: str) -> Lead:
    """Return the lead: which method ranks first in each group, and which are not apart from it.

    Parameters
    ----------
    rankings, question
        Of the comparison.
    blocks
        What several blocks are called.
    """
    ranked = [each for each in rankings if len(each.values) and len(each.methods) > 1]
    if not ranked:
        return Lead(("There is nothing to rank.",))
    tested = [each for each in ranked if each.differ and not each.objections(blocks)]
    scopes = dict.fromkeys(
        scope_text(scope_of(each.units, question, blocks)) for each in ranked if each.units.count
    )
    held = f"Scope: {next(iter(scopes))}. " if len(scopes) == 1 else ""
    end = "the lowest value" if question.better == "none" else "the best"
    return Lead(
        _sentence(ranked, tested, question),
        tuple(_card(each, question, blocks) for each in ranked),
        f"{held}Mean ranks of {question.metric}: 1 is {end} in every unit.",
    )


def _sentence(ranked: Sequence[Ranking], tested: Sequence[Ranking], question: Question) -> Text:
    if not tested:
        return ("Ranks do not tell the methods apart.",)
    firsts = dict.fromkeys(each.first_names for each in tested)
    where = "" if len(tested) == len(ranked) else f" in {len(tested)} of {len(ranked)} groups"
    if len(firsts) == 1:
        return (
            "",
            next(iter(firsts)),
            f" has the lowest mean rank{where or ' throughout' * (len(ranked) > 1)}.",
        )
    parts: list[str] = [f"It depends on {' and '.join(question.within)}: "]
    for first in firsts:
        groups = [group_text(each.group, question) for each in tested if each.first_names == first]
        joint = "." if first == [*firsts][-1] else "; "
        parts += [first, f" ranks first for {listed(groups, _MOST_NAMES)}{joint}"]
    return tuple(parts)


def _card(ranking: Ranking, question: Question, blocks: str) -> Card:
    title = group_text(ranking.group, question) or question.metric
    first = ranking.first
    value = f"mean rank {ranking.ranks.min():.2f} of {len(ranking.methods)}"
    objection = ranking.objections(blocks)
    if objection or not ranking.differ:
        alike = (
            caution_text(scope_of(ranking.units, question, blocks))
            or "Friedman's test does not tell the methods apart"
        )
        facts = (("Lowest", f"{ranking.first_names}, {value}"), ("Why", objection or alike))
        return Card(title, "no verdict", picture=_picture(ranking, first, first), facts=facts)
    pairs = ranking.pairs
    near = np.zeros(len(first), dtype=bool)
    close = ~ranking.apart & (first[pairs.first] | first[pairs.second])
    near[pairs.first[close]] = near[pairs.second[close]] = True
    names = [
        str(ranking.methods[place])
        for place in np.argsort(ranking.ranks, kind="stable").tolist()
        if near[place] and not first[place]
    ]
    facts = (
        ("Tied", listed(names, _MOST_NAMES) if names else "none"),
        ("Apart", f"{np.count_nonzero(~near & ~first)} methods"),
    )
    p = ranking.overall.p_f if len(first) > 2 else float(pairs.p[0])
    return Card(
        title,
        ranking.first_names,
        value,
        chance_text(p),
        _picture(ranking, first, near),
        facts,
        True,
    )


def _picture(ranking: Ranking, first: NDArray[np.bool_], near: NDArray[np.bool_]) -> str:
    line = Line(1.0, float(len(ranking.methods)))
    dots = [
        dot(
            line.at(float(rank)), 10.0, "best" if best else "tied" if close else "rest",
            f"{name} {number_text(float(rank))}",
        )
        for name, rank, best, close in zip(ranking.methods, ranking.ranks, first, near, strict=True)
    ]  # fmt: skip
    axis = (
        '<line x1="4" x2="236" y1="22" y2="22"/><text x="4" y="36">rank 1</text>'
        f'<text class="end" x="236" y="36">{len(ranking.methods)}</text>'
    )
    return svg(f"mean ranks of {len(ranking.methods)} methods", 40.0, (axis, *reversed(dots)))

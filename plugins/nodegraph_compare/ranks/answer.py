"""The answer of ranks: which method ranks first in each group, and a card per group."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph import listed
from nodegraph_compare.left_out import filled_group, group_text, narrowed_group, numberless
from nodegraph_compare.ranks.signed_rank import TEST_NAMES
from nodegraph_compare.verdict import scope_of
from nodegraph_compare.words import caution_text, scope_text
from nodegraph_tables.answer import Answer, Card, Row, Rows
from nodegraph_tables.line import Line
from nodegraph_tables.numbers import chance_text
from nodegraph_tables.text import HERE, Text, Word, joined, listing, say

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from nodegraph_compare.comparison import Comparison
    from nodegraph_compare.ranks.ranking import PairTest, Ranking
    from nodegraph_tables.answer import Kind

_MOST_NAMES = 4


def answer_of(rankings: Sequence[Ranking], comparison: Comparison, test: PairTest) -> Answer:
    """Return which method ranks first in each group, and which are not apart from it.

    Parameters
    ----------
    rankings, comparison
        The ranking of each group, and what is compared.
    test
        Of the pairs.
    """
    question, blocks = comparison.question, comparison.blocks
    ranked = [each for each in rankings if len(each.values) and len(each.methods) > 1]
    cards = tuple(_card(each, comparison, test) for each in rankings)
    if not ranked:
        return Answer(("There is nothing to rank.",), cards=cards)
    tested = [each for each in ranked if each.differ and not each.objections(blocks)]
    scopes = dict.fromkeys(
        scope_text(scope_of(each.units, question, blocks)) for each in ranked if each.units.count
    )
    held = f"Scope: {next(iter(scopes))}. " if len(scopes) == 1 else ""
    end = "the lowest value" if question.better == "none" else "the best"
    scope = (
        f"{held}Mean ranks of {question.metric}: 1 is {end} in every unit. Dots: a method each; "
        "filled: the first; ringed: may rank as well."
    )
    return Answer(_sentence(ranked, tested, comparison), (scope,), cards)


def _sentence(ranked: Sequence[Ranking], tested: Sequence[Ranking], comparison: Comparison) -> Text:
    question = comparison.question
    if not tested:
        return ("Ranks do not tell the methods apart.",)
    firsts: dict[tuple[int, ...], list[Ranking]] = {}
    for each in tested:
        firsts.setdefault(tuple(np.flatnonzero(each.first).tolist()), []).append(each)
    where = "" if len(tested) == len(ranked) else f" in {len(tested)} of {len(ranked)} groups"
    if len(firsts) == 1:
        (groups,) = firsts.values()
        verb = "has" if len(next(iter(firsts))) == 1 else "share"
        every = where or " throughout" * (len(ranked) > 1)
        return say(f"{HERE} {verb} the lowest mean rank{every}.", _first(groups[0]))
    clauses = [
        say(
            f"{HERE} ranks first for {HERE}",
            _first(groups[0]),
            listed([group_text(each.group, question) for each in groups], _MOST_NAMES),
        )
        for groups in firsts.values()
    ]
    return say(f"It depends on {' and '.join(question.within)}: {HERE}.", joined("; ", clauses))


def _first(ranking: Ranking) -> Text:
    names = [str(ranking.methods[place]) for place in np.flatnonzero(ranking.first)]
    return listing([Word(name, "strong", name) for name in names])


def _card(ranking: Ranking, comparison: Comparison, test: PairTest) -> Card:
    question, blocks = comparison.question, comparison.blocks
    group = ranking.group
    title = (group_text(group, question) or question.metric,)
    more = (
        ("Blocks", narrowed_group(group, blocks)),
        ("Filled", filled_group(group, comparison.fallback, blocks)),
        ("Absent", numberless(group)),
    )
    facts: list[tuple[str, Text]] = [(term, (text,)) for term, text in more if text]
    if not len(ranking.values):
        return Card(title, ("no block has a number for every method",), facts=tuple(facts))
    if len(ranking.methods) < 2:
        only = Word(str(ranking.methods[0]), "method")
        return Card(title, say(f"only {HERE} has numbers", only), facts=tuple(facts))
    number = Word(f"{ranking.ranks.min():.2f}", "number")
    value = say(f"mean rank {HERE} of {len(ranking.methods)}", number)
    objection = ranking.objections(blocks)
    caution = caution_text(scope_of(ranking.units, question, blocks))
    if ranking.units.judged:
        facts.insert(0, ("Test", (_test(ranking, test),)))
    if objection or not ranking.differ:
        why = objection or caution or "Friedman's test does not tell the methods apart"
        facts = [("Why", (why,)), *facts]
        return Card(title, ("no verdict",), rows=_rows(ranking, {}), facts=tuple(facts))
    pairs, first = ranking.pairs, ranking.first
    near = np.zeros(len(first), dtype=bool)
    close = ~ranking.apart & (first[pairs.first] | first[pairs.second])
    near[pairs.first[close]] = near[pairs.second[close]] = True
    kinds: dict[int, Kind] = dict.fromkeys(np.flatnonzero(near).tolist(), "tied")
    kinds |= dict.fromkeys(np.flatnonzero(first).tolist(), "best")
    facts += [("Caution", (caution,))] if caution else []
    rows = _rows(ranking, kinds)
    return Card(title, _first(ranking), value, rows=rows, facts=tuple(facts), kind="best")


def _test(ranking: Ranking, test: PairTest) -> str:
    overall = ranking.overall
    if len(ranking.methods) == 2:
        return f"Wilcoxon's signed ranks, {chance_text(float(ranking.pairs.p[0]))}"
    return (
        f"Friedman's, F = {overall.f:.3g}, {chance_text(overall.p_f)}, Kendall's W = "
        f"{overall.w:.2f}; pairs by {TEST_NAMES[test]}"
    )


def _rows(ranking: Ranking, kinds: Mapping[int, Kind]) -> Rows:
    rows = [
        Row(
            str(ranking.methods[place]),
            float(ranking.ranks[place]),
            kind=kinds.get(place, "rest"),
        )
        for place in np.argsort(ranking.ranks, kind="stable").tolist()
    ]
    return Rows.of(rows, Line(1.0, float(len(ranking.methods))))

"""Mean ranks of methods over blocks, tested, with a critical-difference diagram."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from nodegraph import Across, Label, node
from nodegraph_compare.comparison import prepare
from nodegraph_compare.inference import LEVEL
from nodegraph_compare.left_out import block_text, end_text, left_out
from nodegraph_compare.question import Asked, Question
from nodegraph_compare.ranks.answer import answer_of
from nodegraph_compare.ranks.ranking import PairTest, Ranking, rank_by_rules
from nodegraph_compare.verdict import clusters_name
from nodegraph_compare.words import rules_text
from nodegraph_mocap import Figure, Table
from nodegraph_tables import TableInfo, with_info
from nodegraph_tables.style import CHANCE

if TYPE_CHECKING:
    from collections.abc import Sequence


class Ranked(NamedTuple):
    """Mean ranks, their picture, and the tests."""

    table: Table
    figure: Figure
    pairs: Table
    overall: Table


@node(
    "compare.ranks",
    cite=(
        "demsar2006statistical",
        "friedman1937ranks",
        "iman1980approximations",
        "nemenyi1963distribution",
        "wilcoxon1945individual",
        "holm1979simple",
        "kendall1939problem",
        "kerby2014simple",
    ),
    shares=Asked,
)
def ranks(scores: Across[Table], asked: Asked, *, test: PairTest = "nemenyi") -> Ranked:
    """Rank methods within each independent unit, and test whether their mean ranks differ.

    The units are those of `compare.table`: the clusters, such as actors, by their mean over the
    blocks, or parts of a recording. In every unit the methods are ranked, 1 for the best (the
    lowest value where neither end is better), equal ones sharing the mean of their ranks; values
    that differ by rounding alone, by at most 1e-9 of their size, are equal, as in `compare.table`,
    and so are differences of a pair. Friedman's test asks whether all methods rank alike; its chi2,
    corrected for ties, is given beside Iman and Davenport's F, which is less conservative and
    decides here (Demsar 2006). Then every pair is tested:

    - ``nemenyi``: two methods are apart where their mean ranks differ by the critical difference
      ``q sqrt(k (k + 1) / (12 N))`` or more, q the 95 % quantile of the studentised range of the
      k methods, N the number of units. It depends on which other methods are there.
    - ``wilcoxon_holm``: Wilcoxon's signed-rank test of each pair's differences, with Holm's
      correction over all pairs. It asks about the sizes of the differences, does not depend on
      the other methods, and with k (k - 1) / 2 pairs needs more units.

    Both keep the chance of any false claim at 5 %. Two methods are compared by Wilcoxon's test
    alone. Fewer than five units are not tested. Ranks support the means of `compare.table`, they
    do not replace them: they ask which method is better in more units, however little. Blocks are
    those of `compare.table`: only those that every method has count; what is left out is counted
    in a warning.

    Parameters
    ----------
    scores
        Tables, a row per unit (a gap, a marker, a take).
    test
        Of the pairs: ``nemenyi`` or ``wilcoxon_holm``.

    Returns
    -------
    table
        A row per method, the best first: ``blocks``, ``mean rank`` over units,
        ``mean`` of the metric.
    figure
        Demsar's critical-difference diagram: bars join methods of which no two are apart.
    pairs
        A row per pair: the difference of their mean ranks (``first`` minus ``second``), ``p``
        adjusted for the number of pairs, and ``effect``, the matched-pairs rank-biserial
        correlation (1: the first is better in every unit, 0: as often and as much better as
        worse).
    overall
        A row per combination of `within`: ``chi2``, ``p``, ``F``, ``p of F``, Kendall's ``W``
        (1: every unit ranks alike), ``critical difference`` (at 5 %); NaN for fewer than three
        methods or five units.

    Raises
    ------
    ValueError
        If a name is neither axis nor column or is used twice, or the metric holds no numbers.
    """
    from nodegraph_compare.ranks.figure import draw

    comparison = prepare(scores, asked)
    question, gathered = comparison.question, comparison.filled
    rankings = [
        rank_by_rules(group, comparison.fallback, question.better, test)
        for group in comparison.groups
    ]
    recordings = max((each.units.clusters for each in rankings), default=1)
    rules = rules_text(question, clusters_name(question), recordings)
    first = "the lowest value" if question.better == "none" else "the best"
    info = TableInfo(
        title=f"Mean ranks of {question.metric}{question.by}",
        answer=answer_of(rankings, comparison, test),
        notes=(
            f"{block_text(question)} {end_text(question)} {rules}",
            f"Rank 1 is {first} in a unit, equal values share the mean of their ranks. Only "
            "blocks in which every method with any number has all its numbers count. Level "
            f"{100 * LEVEL:.0f} %.",
            *left_out(scores, question, gathered),
        ),
        labels=(*question.within, question.compare or "method"),
        compared=question.compare or "method",
    )
    return Ranked(
        with_info(_table(rankings, question), info),
        draw(question, rankings, test),
        _pairs(rankings, question),
        _overall(rankings, question),
    )


def _table(rankings: Sequence[Ranking], question: Question) -> Table:
    from pandas import DataFrame

    name = question.compare or "method"
    rows: list[dict[str, Any]] = []
    for ranking in rankings:
        blocks, methods = ranking.values.shape
        means = ranking.values.mean(axis=0) if blocks else np.full(methods, np.nan)
        for place in np.argsort(ranking.ranks, kind="stable").tolist():
            rows.append(
                _labels(ranking, question)
                | {name: ranking.methods[place], "blocks": int(ranking.group.complete.sum())}
                | {"mean rank": ranking.ranks[place], "mean": means[place]}
            )
        rows += [
            _labels(ranking, question)
            | {name: method, "blocks": 0, "mean rank": np.nan, "mean": np.nan}
            for method in ranking.group.methods
            if method not in ranking.methods
        ]
    return DataFrame(rows)


def _pairs(rankings: Sequence[Ranking], question: Question) -> Table:
    from pandas import DataFrame

    rows = []
    for ranking in rankings:
        pairs = ranking.pairs
        apart = ranking.ranks[pairs.first] - ranking.ranks[pairs.second]
        both = zip(pairs.first, pairs.second, apart, pairs.p, pairs.effect, strict=True)
        rows += [
            _labels(ranking, question)
            | {"first": ranking.methods[a], "second": ranking.methods[b]}
            | {"rank difference": difference, "p": p, "effect": effect}
            for a, b, difference, p, effect in both
        ]
    labels = (*question.within, "first", "second")
    return with_info(
        DataFrame(rows),
        TableInfo(
            title=f"Pairs by ranks of {question.metric}{question.by}",
            units={"p": CHANCE},
            labels=labels,
        ),
    )


def _overall(rankings: Sequence[Ranking], question: Question) -> Table:
    from pandas import DataFrame

    rows = []
    for ranking in rankings:
        overall = ranking.overall
        rows.append(
            _labels(ranking, question)
            | {"methods": len(ranking.methods), "units": len(ranking.units.means)}
            | {"chi2": overall.chi2, "p": overall.p, "F": overall.f, "p of F": overall.p_f}
            | {"W": overall.w, "critical difference": overall.critical}
        )
    title = f"Friedman's test of {question.metric}{question.by}"
    units = {"p": CHANCE, "p of F": CHANCE}
    return with_info(DataFrame(rows), TableInfo(title=title, units=units, labels=question.within))


def _labels(ranking: Ranking, question: Question) -> dict[str, Label]:
    return dict(zip(question.within, ranking.group.labels, strict=True))

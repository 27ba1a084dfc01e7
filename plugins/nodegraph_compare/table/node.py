"""The table of a comparison and its figure."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Annotated, NamedTuple

import numpy as np

from nodegraph import Across, ColumnOf, Label, node
from nodegraph_compare.answer import answer_of
from nodegraph_compare.blocks import groups
from nodegraph_compare.comparison import Comparison, prepare
from nodegraph_compare.described import is_described
from nodegraph_compare.left_out import left_out
from nodegraph_compare.overview.build import BlocksOf, cluster_means, metrics_of
from nodegraph_compare.overview.value import Overview
from nodegraph_compare.question import (
    Asked,
    Equivalent,
    Names,
    OneLabel,
    Question,
    check_numbers,
    suited_margin,
)
from nodegraph_compare.recordings import recordings_of
from nodegraph_compare.suspects import suspects
from nodegraph_compare.table.judge import by_rules, over_groups, variations, verdict_of
from nodegraph_compare.table.means import blocks_text, implied, means_table
from nodegraph_compare.table.notes import notes
from nodegraph_compare.table.summary import by_ratio, summarise
from nodegraph_compare.unused_axes import unused_axes
from nodegraph_compare.verdict import Verdicts, clusters_name
from nodegraph_compare.words import number_name
from nodegraph_mocap import Figure, Table
from nodegraph_tables import info_of, with_info

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from nodegraph import Declared


_SHARES = (
    "refused: share of combinations that were refused or failed; left missing: share of rows "
    "without a number."
)


class Compared(NamedTuple):
    """A comparison: its numbers, its picture, and its verdicts with the blocks behind them."""

    table: Table
    figure: Figure
    overview: Overview


@node(
    "compare.table",
    cite=(
        "tukey1953problem",
        "miller1974jackknife",
        "schuirmann1987comparison",
        "bakirov2005student",
        "ibragimov2010robust",
        "hedges1981distribution",
    ),
    shares=Asked,
)
def table(
    scores: Across[Table],
    asked: Asked,
    *,
    baseline: OneLabel = None,
    equivalent: Equivalent | None = None,
    rows: Names = (),
    columns: Names = (),
    beside: Annotated[tuple[str, ...], ColumnOf("scores")] = (),
) -> Compared:
    """Compare methods by one number: means over independent units, with one verdict.

    Every row of the gathered tables carries the labels of its combination. What is paired is the
    block: the rows of a block are averaged first (for the metric ``rmse``, the result is the mean
    over blocks of the rows' rmse, not the rmse over all samples). A block in which a method has a
    row without a finite number counts as lacking for that method. Only blocks that every method
    has are used; the others are dropped, counted in a warning and in the answer. A method without
    any number in a group does not take part in it. An axis hides a column of the same name.

    What is independent is the cluster, such as an actor. With ``M[c, m]`` the mean of method m
    over the blocks of cluster c, methods are compared by ``y = ln M``, every cluster weighing the
    same: ``exp(mean(d))`` with d the difference of two methods is the ratio of their mean errors
    for a typical cluster, and the number of a method is ``exp(mean(y))``, the mean error of a
    typical cluster. Where a mean of some method is 0 or a value below 0, y is M, and numbers are
    arithmetic means. The number of a method depends on no other, but for blocks that are left out
    because another lacks them. A method is clearly behind the best where ``p <= 0.05`` by the
    floored Tukey rule (of two methods the paired t-test) in steps: what is clearly behind is set
    aside, and the rest is judged again by itself, until nothing falls. Of equal methods, any is
    called behind in at most about 5 % of studies. Three or four clusters are described, without p
    and verdict; five to seven are provisional.

    One or two clusters say nothing about further ones: numbers are means over the blocks of these
    recordings, and claims are about them. Three or more repetitions (axes of `blocks` along which
    the same data are treated again) tell what further ones would say. Segments tell what the next
    minutes of the recordings would: ten where a recording is 100 times as long as a block and twice
    the time over which it is correlated, six from 36 times on. They need columns ``start`` and
    ``frames``, and tables that say what recording they are of (`TableInfo.take`). In place of the
    y of a unit stands the jackknife's ``B ln M - (B - 1) ln M'``, with M the mean over all blocks
    of the recording and M' that without one of its B parts, centred at ``ln M``.

    What differs by rounding alone (1e-9 of the size of a block's values, of a thousandth of what is
    usual at least) is equal, and stands as that of the first method.

    Parameters
    ----------
    scores
        Tables, a row per unit (a gap, a marker, a take).
    baseline
        A label of `compare`: methods are compared to it in place of the best.
    equivalent
        Within which methods count as practically equal: a ratio, such as 1.1, or a difference
        with the metric's unit, such as ``0.05 mm``. Declare it before you see results.
    rows
        Axes, or columns, whose labels stand down the side of a table of means; those not in
        `within` are taken as if they were. The last one in `rows` or `columns` is compared by
        default.
    columns
        Axes, or columns, whose labels stand along its top. What neither names stands in the rows
        (in the columns, if only rows are named). Without both, every mean has a row.
    beside
        Further columns of numbers of which a report shows the best method's means with those of
        the metric, without a verdict: what it does besides.

    Returns
    -------
    table
        A row per combination of `within` and `compare`, the best mean of a group first (in the
        order of the labels where neither end is better): ``blocks`` used; ``mean``, the number that
        is compared, with ``low`` and ``high``, Student's 95 % interval of y over the units, as far
        as a mean can be there (of shares that all lie within 0 to 1, and of a unit ``of 100``);
        ``arithmetic mean`` over clusters, in the CSV file alone; ``median`` over blocks; ``ratio``
        to the best, or the baseline, with the ends of its interval, and ``difference`` of the
        means, its ends those of the ratio, less 1, times the mean that it is to; ``p``, of the step
        in which a method was set aside, or of the last, and at least that of those set aside
        before; from six units on ``p of flips`` of the units' signs, not adjusted; ``g``, Hedges'
        standardised difference, above 0 where
        worse; ``margin``, the smallest within which the method is shown to be equal by two
        one-sided tests; ``wins``, in how many of the units it is better. Where there are any,
        ``refused`` (share of the combinations that were refused or failed) and ``left missing``
        (share of the rows without a number); with `fallback`, the means by the two other rules,
        if any differs; and what methods declare, where they differ: ``adapted`` (not as
        published), ``looks ahead`` (frames, or the whole take) and ``meets ends`` (of gaps, or
        by a setting that varies along an axis).
        Several groups of the same clusters have rows over all of them besides, which lack the
        labels of `within` (a reader sees ``all``): with Y the logarithm of a cluster's mean,
        averaged over groups, methods are compared as within a group. A claim that rests on any one
        of G groups multiplies its p by G.
        With `rows` or `columns` a reader sees means with their intervals alone, laid out so;
        methods are in the order of the graph where each group has all; no row is over all groups.
        Its answer has a line per group: which mean is best, over what, and which methods are not
        certain to be worse. Its notes list what that rests on: what was left out or filled in,
        where few large errors decide, and what it is without blocks whose truth is suspect: those
        with a reason in a column ``suspect`` of the scores, and, unless all data are synthetic,
        those in which even the smallest error is an outlier (on a log scale, more than 5 robust
        standard deviations above the median). The best mean of each group is marked.
    figure
        Means and intervals; an asterisk marks methods that are not as published, a ring those
        that look at the whole take, where methods differ.

    Raises
    ------
    ValueError
        If a name is neither axis nor column or is used twice, the metric holds no numbers,
        clusters share their data, the baseline is not among the compared labels, or the margin
        does not suit the metric; the message lists what there is.
    """
    from nodegraph_compare.table.figure import draw

    named = (*rows, *columns)
    compare, within = implied(scores, asked.compare, asked.within, named, asked.blocks)
    comparison = prepare(scores, replace(asked, compare=compare, within=within))
    question, gathered = comparison.question, comparison.groups
    for name in beside:
        check_numbers(scores, name, "beside")
    against = comparison.baseline(baseline)
    doubted = suspects(scores, question, gathered)
    doubtful = np.concatenate([*(each.rows for each in doubted), np.empty(0, dtype=np.intp)])
    plain = (
        {group.labels: group for group in groups(scores, question, doubtful)}
        if len(doubtful)
        else {}
    )
    ratio = by_ratio([*gathered, *plain.values(), *comparison.filled], question.better)
    margin = None
    if equivalent is not None:
        margin = suited_margin(equivalent, question, comparison.unit, ratio=ratio)
    summarised = partial(
        summarise, end=question.better, ratio=ratio, against=against, margin=margin
    )
    every = [
        by_rules(
            group,
            plain.get(group.labels) if each.names else None,
            comparison.fallback,
            summarised,
        )
        for group, each in zip(gathered, doubted, strict=True)
    ]
    metrics = metrics_of(comparison, beside, ratio=ratio)
    blocks_of = BlocksOf(comparison, metrics)
    blocks_behind = tuple(
        blocks_of.of(rules["main"].group, rules["main"].units, each)
        for rules, each in zip(every, doubted, strict=True)
    )
    declared = {
        label: each
        for label, each in scores.methods.get(question.compare or "", {}).items()
        if label in comparison.methods
    }
    # names that all stand down the side leave a row per mean
    count = len((*question.within, *question.compared))
    layout = (rows, columns) if columns or 0 < len(rows) < count else ((), ())
    overall = None if any(layout) else over_groups(every)
    verdicts = Verdicts(
        metric=metrics[0],
        beside=metrics[1 : 1 + len(beside)],
        compare=question.compare or "",
        is_sequence=comparison.is_sequence,
        within=question.within,
        blocks=comparison.blocks,
        units=clusters_name(question),
        methods=comparison.methods,
        baseline=against,
        fallback=comparison.fallback,
        margin=margin,
        adapted=_places(comparison, declared, lambda each: "adapted" in each),
        ahead=_places(comparison, declared, lambda each: each.get("lookahead", 0) is None),
        recordings=recordings_of(scores),
        axis_units=tuple(scores.units.get(axis, "") for axis in question.within),
        variations=variations(every, comparison, declared),
        groups=tuple(
            verdict_of(
                rules,
                comparison,
                suspects=each.names,
                beside={
                    metric.name: cluster_means(behind, metric)
                    for metric in metrics[1 : 1 + len(beside)]
                },
            )
            for rules, each, behind in zip(every, doubted, blocks_behind, strict=True)
        ),
        overall=None if overall is None else verdict_of(overall, comparison),
    )
    means = means_table(verdicts, declared, layout)
    info = info_of(means)
    cells: list[str] = []
    if any(layout):
        cells = [f"{_cell_text(means, question)} {blocks_text(verdicts.groups)}"]
    elif not {"refused", "left missing"}.isdisjoint(means):
        cells = [_SHARES]
    averaged = [
        f"{text}."
        for axis, text in unused_axes(scores, question.compare).items()
        if axis not in (*question.within, *question.compared)
    ]
    answer = answer_of(verdicts)
    # the cards of a comparison with a better end are those of its overview
    of_table = answer if is_described(verdicts) else answer.in_words
    info = replace(
        info,
        title=f"{number_name(verdicts)}{question.by}",
        answer=replace(of_table, more=(*of_table.more, *averaged)),
        notes=(
            *notes(verdicts, question),
            *cells,
            *(
                f"{label}: adapted {each['adapted']}"
                for label, each in declared.items()
                if "adapted" in each
            ),
            *left_out(scores, question, [rules["main"].group for rules in every]),
        ),
    )
    return Compared(
        with_info(means, info),
        draw(verdicts),
        Overview(
            verdicts=verdicts,
            answer=answer,
            metrics=metrics,
            columns=blocks_of.columns,
            blocks=blocks_behind,
        ),
    )


def _places(
    comparison: Comparison, declared: Mapping[Label, Declared], applies: Callable[[Declared], bool]
) -> tuple[int, ...]:
    return tuple(
        at
        for at, method in enumerate(comparison.methods)
        if method in declared and applies(declared[method])
    )


def _cell_text(means: Table, question: Question) -> str:
    best = "" if question.better == "none" else "; the best of a group is marked"
    apart = "; \N{DAGGER} clearly apart from the best, or from the baseline"
    return f"A cell holds the mean and its interval [low, high]{best}{apart * ('p' in means)}."

"""The table of a comparison and its figure."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, NamedTuple

from pydantic import Field

from nodegraph import Across, Label, node
from nodegraph_compare.blocks import groups
from nodegraph_compare.bootstrap import Bootstrap
from nodegraph_compare.labels import compared_looks, named_label
from nodegraph_compare.left_out import left_out
from nodegraph_compare.question import (
    Better,
    Names,
    OneColumn,
    OneLabel,
    OneName,
    Question,
    ask,
    blocks_name,
    unit_of,
)
from nodegraph_compare.statistics import LEVEL, Test
from nodegraph_compare.table.answer import answers, notes
from nodegraph_compare.table.layout import (
    PAIRED,
    Layout,
    blocks_text,
    completed,
    implied,
    long_table,
    wide_table,
)
from nodegraph_compare.table.summary import Summary, summarise
from nodegraph_mocap import Figure, Table
from nodegraph_tables import info_of, with_info
from nodegraph_tables.info import Part
from nodegraph_tables.style import unit_text

if TYPE_CHECKING:
    from collections.abc import Sequence


_PARTS: tuple[Part, ...] = ("low", "high", "p")
_SHARES = (
    "refused: share of combinations that were refused or failed; left missing: share of rows "
    "without a number."
)


class Compared(NamedTuple):
    """A comparison: its numbers and its picture."""

    table: Table
    figure: Figure


@node(
    "compare.table",
    cite=(
        "efron1979bootstrap",
        "hall1988bootstrap",
        "tukey1949comparing",
        "wilcoxon1945individual",
        "holm1979simple",
    ),
)
def table(
    scores: Across[Table],
    *,
    metric: OneColumn = None,
    compare: OneName = None,
    within: Names = (),
    blocks: Names = (),
    better: Better = "declared",
    baseline: OneLabel = None,
    test: Test = "wilcoxon",
    rows: Names = (),
    columns: Names = (),
    seed: Annotated[int, Field(ge=0)] = 0,
) -> Compared:
    """Compare methods by one number: means over paired blocks, with intervals.

    Every row of the gathered tables carries the labels of its combination. The unit of statistics
    is the block: the rows of a block are averaged first (for the metric ``rmse``, the result is
    the mean over blocks of the rows' rmse, not the rmse over all samples). A block in which a
    method has a row without a finite number counts as lacking for that method. Statistics are
    paired: within a group, only blocks that every method has are used; the others are dropped,
    counted in a warning. A method without any number in a group does not take part in
    it. An axis hides a column of the same name.

    What differs by rounding alone is equal. Of values in a block that are at most 1e-9 of their
    size apart all stand, here and in the table, as that of the first method; the size of a small
    one is a thousandth of what is usual (the median over blocks of the largest value), so that
    1e-31 equals 0 beside 30. Means are equal as far apart, and so are the differences that are
    tested, as measured by the values that they are differences of. All other values count and
    are shown as they are.

    Parameters
    ----------
    scores
        Tables, a row per unit (a gap, a marker, a take).
    metric
        The column of numbers to compare. Default: the first column of floats; columns of whole
        numbers, such as indices and lengths, are never taken by default.
    compare
        The axis, or column, whose labels are compared. Default: the last gathered axis that is
        in `rows` or `columns`, or else not in `within` or `blocks`.
    within
        Axes, or columns: each combination of their labels is compared by itself.
    blocks
        Axes, or columns, whose combinations are the paired blocks. Default: every gathered axis
        that is not compared or in `within`, and the first column of the tables where it
        identifies the unit of a row, that is, where it holds no floats and is not called ``frame``.
        An axis named nowhere is averaged over within each block.
    better
        Which end of the metric is the better one: ``lower``, ``higher``, or ``none`` (a lag is
        best at zero). ``declared``: as the scores declare it, where they do not, ``lower``.
    baseline
        A label of `compare`: adds paired differences to it.
    test
        Of the differences to the baseline, two-sided, with Holm's correction over the methods of
        a group: ``wilcoxon`` (signed ranks), ``t`` (paired), ``sign`` (exact), or ``none``.
    rows
        Axes, or columns, whose labels stand down the side of a table of means; those not in
        `within` are taken as if they were.
    columns
        Axes, or columns, whose labels stand along its top. What neither names stands in the rows
        (in the columns, if only rows are named). Without both, every mean has a row.
    seed
        Of the bootstrap.

    Returns
    -------
    table
        A row per combination of `within` and `compare`, the best mean of a group first (in the
        order of the labels where neither end is better): ``blocks`` used, ``mean``, ``rms`` (root
        mean square: for the metric ``rmse`` and gaps of one length, the rmse over all samples),
        ``median`` and ``sd`` over blocks, ``low`` and ``high`` (95 % studentised bootstrap
        interval of the mean, 2000 resamples; for twenty blocks it covers the mean in 93 to 95 %
        of studies, the more skewed the scores the fewer), ``refused`` (share of the combinations
        that were refused or failed), ``left missing`` (share of the rows without a number).
        With a baseline: ``difference`` (mean of method minus baseline), ``difference low`` and
        ``difference high`` (its paired interval, of the same kind), ``p`` and ``better in``
        (share of blocks in which the method is strictly better). ``sd`` is NaN with fewer than
        two blocks, an interval with fewer than three.
        With `rows` or `columns`: the means only, with ``low`` and ``high`` (and ``p``) of each
        column in columns of their own, which a reader of the report sees in one cell.
        Its answer has a sentence per group: which mean is best, and which methods are
        not clearly behind it (Tukey's range of the paired differences, so that of equal methods
        any is called behind in about 5 % of studies of ten blocks or more), and over how many
        blocks, and because of which methods, where more than a quarter are left out. Its notes
        list what was left out, and the best mean of each group is marked.
    figure
        Means and intervals.

    Raises
    ------
    ValueError
        If a name is neither axis nor column or is used twice, the metric holds no numbers, or
        the baseline is not among the compared labels; the message lists what there is.
    """
    from nodegraph_compare.table.figure import draw

    layout = Layout(rows, columns)
    compare, within = implied(scores, compare, within, layout, blocks)
    question = ask(
        scores, metric=metric, compare=compare, within=within, blocks=blocks, better=better
    )
    gathered = groups(scores, question)
    look = compared_looks(scores, question, gathered)
    against = named_label(tuple(look), baseline)
    bootstrap = Bootstrap(seed)
    summaries = [
        summarise(group, question.better, bootstrap, against=against, test=test)
        for group in gathered
    ]
    unit = unit_of(scores, question.metric)
    layout = completed(layout, question)
    means = _laid_out(
        summaries, question, layout, tuple(look), unit, _unwanted(question, against, test)
    )
    info = info_of(means)
    sentences = answers(summaries, question, unit, against, test, blocks_name(scores, question))
    info = replace(
        info,
        answer=tuple(sentences),
        notes=(
            *notes(question, seed, against, test),
            *info.notes,
            *left_out(scores, question, gathered),
        ),
    )
    return Compared(with_info(means, info), draw(question, summaries, look, unit))


def _laid_out(
    summaries: Sequence[Summary],
    question: Question,
    layout: Layout,
    order: Sequence[Label],
    unit: str,
    unwanted: Sequence[str],
) -> Table:
    by = f" by {question.compare}" if question.compare else ""
    within = f" within {', '.join(question.within)}" if question.within else ""
    if not layout.columns:
        means = long_table(summaries, question, unit, unwanted)
        title, note = f"{question.metric}{by}{within}", _SHARES
    else:
        parts = [part for part in _PARTS if part not in unwanted]
        means = wide_table(summaries, question, layout, order, parts)
        in_unit = f" ({unit_text(unit)})" if unit else ""
        title = f"Mean {question.metric}{in_unit}{by}{within}"
        note = f"{_cell_text(question, parts)} {blocks_text(summaries)}"
    return with_info(means, replace(info_of(means), title=title, notes=(note,)))


def _cell_text(question: Question, parts: Sequence[str]) -> str:
    best = "" if question.better == "none" else "; the best of a group is marked"
    apart = f"; \N{DAGGER} differs from the baseline (p < {LEVEL:g})" if "p" in parts else ""
    return f"A cell holds the mean and its interval [low, high]{best}{apart}."


def _unwanted(question: Question, against: Label | None, test: Test) -> tuple[str, ...]:
    """Return the columns of differences that would hold nothing."""
    if against is None:
        return PAIRED
    unwanted = ("p",) if test == "none" else ()
    return (*unwanted, "better in") if question.better == "none" else unwanted

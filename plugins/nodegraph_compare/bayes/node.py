"""Probabilities that a method is better, practically equal, or worse."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from nodegraph import Across, Refusal, listed, node
from nodegraph_compare.bayes.beliefs import CLEAR, SIDES, Beliefs, beliefs_by_rules
from nodegraph_compare.comparison import prepare
from nodegraph_compare.inference import FEWEST_JUDGED
from nodegraph_compare.left_out import (
    MOST_GROUPS,
    block_text,
    end_text,
    filled_group,
    group_text,
    left_out,
    narrowed_group,
    start_text,
)
from nodegraph_compare.question import Asked, Equivalent, OneLabel, suited_margin
from nodegraph_compare.table.summary import by_ratio
from nodegraph_compare.verdict import clusters_name, scope_of
from nodegraph_compare.words import caution_text, scope_text
from nodegraph_mocap import Figure, Table, figure_text
from nodegraph_tables import Answer, TableInfo, with_info
from nodegraph_tables.axes import plain
from nodegraph_tables.style import BEST, BLACK, CHANCE, LINE, REST

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nodegraph_compare.comparison import Comparison
    from nodegraph_compare.question import Margin, Question

_MOST_PANELS = 12


@dataclass(frozen=True, kw_only=True)
class Believing(Asked):
    """The settings that say what is compared, where one method is to be better.

    Attributes
    ----------
    better
        Which end of the metric is the better one: ``lower`` or ``higher``. ``declared``: as the
        scores declare it, else ``lower``.
    """

    better: Literal["declared", "lower", "higher"] = "declared"


class Believed(NamedTuple):
    """Probabilities and their picture."""

    table: Table
    figure: Figure


@node("compare.bayes", cite=("corani2017statistical", "gelman2006prior"), shares=Believing)
def bayes(
    scores: Across[Table],
    asked: Believing,
    *,
    baseline: OneLabel = None,
    equivalent: Equivalent = 1.1,
) -> Believed:
    """How probable it is that a method is better, practically equal, or worse than another.

    With d the differences of two methods in C clusters, of logarithms of their mean errors as in
    `compare.table`: ``d_c ~ N(mu, tau^2 + v)``, mu flat, tau half-Cauchy with the sd of d as its
    scale (Gelman 2006). The variance ``v = s^2 mean(1 / n_c)`` of a cluster's own mean, of n_c
    blocks, is pooled over clusters: where errors are skewed, a cluster's own variance goes with
    its mean, and models with one of its own find equality that is not there. Of ratios, s^2 is
    the variance within clusters of ``x_i / M_i - x_j / M_j``, with x the value of a block and M
    the cluster's mean. After Corani et al. (2017), who give each cluster its own variance.

    The probabilities are those of mu below, within, and above the margin, and of a further
    cluster, whose difference varies by tau^2 more. They are not adjusted for the number of
    methods: hold what one of many shows against `compare.table`.

    Parameters
    ----------
    scores
        Tables, a row per unit (a gap, a marker, a take).
    baseline
        A label of `compare` that the others are compared to. Default: the best of each group.
    equivalent
        Within which methods count as practically equal: a ratio, such as 1.1, or a difference
        with the metric's unit, such as ``0.05 mm``.

    Returns
    -------
    table
        A row per combination of `within` and other method: ``blocks``, ``better``,
        ``equivalent`` and ``worse``, and the same for a further cluster.
    figure
        The probabilities as bars.

    Raises
    ------
    ValueError
        If a name is neither axis nor column or is used twice, neither end of the metric is the
        better one, or the margin does not suit the metric.
    Refusal
        If no group has five clusters.
    """
    comparison = prepare(scores, asked)
    question, gathered = comparison.question, comparison.filled
    if question.better == "none":
        raise ValueError(f"{question.metric} has no better end; give `better`")
    against = comparison.baseline(baseline)
    ratio = by_ratio([*gathered, *comparison.groups], question.better)
    margin = suited_margin(equivalent, question, comparison.unit, ratio=ratio)
    known = [
        belief
        for group in comparison.groups
        if (belief := beliefs_by_rules(group, comparison.fallback, question, against, margin))
        is not None
    ]
    if not known:
        of = clusters_name(question) if question.clusters else "clusters, such as actors"
        most = max((len(np.unique(group.cluster)) for group in gathered), default=0)
        raise Refusal(
            f"needs two methods in {FEWEST_JUDGED} {of}; "
            f"{f'there are {most}' if question.clusters else 'all is of one recording'}"
        )
    return Believed(
        _table(known, comparison, margin, left_out(scores, question, gathered)),
        _draw(known, question, margin),
    )


def _table(
    known: Sequence[Beliefs], comparison: Comparison, margin: Margin, lost: Sequence[str]
) -> Table:
    from pandas import DataFrame

    question = comparison.question
    name = question.compare or "method"
    further = [f"new {clusters_name(question).removesuffix('s')} {side}" for side in SIDES]
    frame = DataFrame(
        [
            dict(zip(question.within, belief.group.labels, strict=True))
            | {name: belief.group.methods[place], "blocks": int(belief.summary.blocks[place])}
            | dict(zip(SIDES, belief.mean[:, at].tolist(), strict=True))
            | dict(zip(further, belief.new[:, at].tolist(), strict=True))
            for belief in known
            for at, place in enumerate(belief.places)
        ]
    )
    within = f" within {', '.join(question.within)}" if question.within else ""
    info = TableInfo(
        title=f"Probabilities for {question.metric} by {name}{within}",
        answer=_answer(known, comparison, margin),
        notes=(
            f"{block_text(question)} {end_text(question)} The independent units are "
            f"{clusters_name(question)}, which weigh equally.",
            f"Probabilities that the mean over {clusters_name(question)}, and that a further one, "
            f"is better, within {margin} of the reference, or worse; undecided where none reaches "
            f"{CLEAR}. Not adjusted for the number of methods.",
            *lost,
        ),
        units=dict.fromkeys((*SIDES, *further), CHANCE),
        labels=(*question.within, name),
    )
    return with_info(frame, info)


def _answer(known: Sequence[Beliefs], comparison: Comparison, margin: Margin) -> Answer:
    """Return how many methods are clearly better, equivalent or worse, and a line per group."""
    question = comparison.question
    counts = Counter(side or "undecided" for belief in known for side in belief.agreed)
    total = counts.total()
    texts = [f"{counts[side]} {side}" for side in (*SIDES, "undecided") if counts[side]]
    several = f" in {len(known)} groups" if len(known) > 1 else ""
    sentence = (
        f"Of {total} comparison{'s' * (total > 1)}{several}, with a margin of {margin}: "
        f"{', '.join(texts)}."
    )
    scopes = dict.fromkeys(
        scope_text(scope_of(belief.summary.units, question, comparison.blocks)) for belief in known
    )
    return Answer(
        (sentence,),
        (f"Scope: {'; '.join(scopes)}.",),
        more=tuple(f"{_line(belief, comparison, margin)}." for belief in known[:MOST_GROUPS]),
    )


def _line(belief: Beliefs, comparison: Comparison, margin: Margin) -> str:
    question, blocks = comparison.question, comparison.blocks
    group = belief.group
    sides: dict[str, list[str]] = {side: [] for side in (*SIDES, "undecided")}
    for at, place in enumerate(belief.places):
        largest = int(np.argmax(belief.mean[:, at]))
        text = f"{SIDES[largest]}: {belief.mean[largest, at]:.2f}"
        if belief.clear[at] != belief.agreed[at]:
            text += f", only with {comparison.fallback} in place of missing {blocks}"
        sides[belief.agreed[at] or "undecided"].append(f"{group.methods[place]} ({text})")
    texts = [f"{side}: {listed(names)}" for side, names in sides.items() if names]
    over, taken = narrowed_group(group, blocks), filled_group(group, comparison.fallback, blocks)
    scope = scope_of(belief.summary.units, question, blocks)
    few = caution_text(scope)
    return (
        f"{start_text(group_text(group, question))}against {group.methods[belief.reference]}, with "
        f"a margin of {margin}, the mean {question.metric} {scope_text(scope)}"
        f"{f' ({over})' if over else ''}{f', {taken}' if taken else ''} is "
        f"{'; '.join(texts)}{f'; {few}' if few else ''}"
    )


def _draw(known: Sequence[Beliefs], question: Question, margin: Margin) -> Figure:
    """Return the figure: a panel per group, at most twelve, and a bar per method.

    The wide bar is the mean over clusters, the narrow one below it a further cluster.

    Parameters
    ----------
    known
        The probabilities of each group.
    question
        What is compared.
    margin
        Within which methods count as equal.
    """
    from matplotlib.figure import Figure as Drawing

    panels = known[:_MOST_PANELS]
    counts = [len(belief.places) for belief in panels]
    height = 0.34 * sum(counts) + 0.55 * len(panels) + 0.7
    figure = Drawing(figsize=(7.0, height), layout="constrained")
    axes = figure.subplots(len(panels), 1, height_ratios=counts, squeeze=False).ravel()
    names = ("better", f"within {margin}", "worse")
    for axis, belief in zip(axes, panels, strict=True):
        rows = np.arange(len(belief.places), dtype=float)
        for offset, size, chances in ((-0.1, 0.5, belief.mean), (0.29, 0.2, belief.new)):
            left = np.zeros(len(rows))
            for name, colour, share in zip(names, (BEST, LINE, REST), chances, strict=True):
                label = figure_text(name) if size == 0.5 else None
                axis.barh(rows + offset, share, size, left=left, color=colour, label=label)
                left += share
        methods = [figure_text(belief.group.methods[place]) for place in belief.places]
        axis.set_yticks(rows, methods)
        axis.invert_yaxis()
        axis.set_xlim(0, 1)
        plain(axis, grid="x")
        axis.tick_params(axis="y", labelcolor=BLACK)
        against = f"against {belief.group.methods[belief.reference]}"
        title = ", ".join(filter(None, [group_text(belief.group, question), against]))
        axis.set_title(figure_text(title), fontsize=10, loc="left")
    axes[-1].set_xlabel("probability; narrow bars: of a further unit")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right upper", frameon=False)
    if len(known) > len(panels):
        figure.supxlabel(f"{len(known) - len(panels)} more groups are not drawn", fontsize=8)
    return figure

"""The answer of a comparison without a better end: the mean of each label, side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.left_out import group_text
from nodegraph_compare.scope import scope
from nodegraph_tables.lead import MOST_CARDS, Card, Lead
from nodegraph_tables.numbers import number_text, shares_text, span_text
from nodegraph_tables.style import unit_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nodegraph_compare.question import Question
    from nodegraph_compare.table.summary import Summary
    from nodegraph_tables import BetterEnd

_MOST_GROUPS = 4


def is_described(end: BetterEnd, methods: int, groups: int) -> bool:
    """Whether a comparison has the lead of this module: of few labels without a better end."""
    return end == "none" and 1 < methods <= MOST_CARDS and 0 < groups <= _MOST_GROUPS


def lead_of(
    summaries: Sequence[Summary], question: Question, unit: str, blocks: str
) -> Lead | None:
    """Return the lead of a few groups of a few labels; None for other comparisons.

    Parameters
    ----------
    summaries, question
        Of the comparison.
    unit
        Of the metric.
    blocks
        What several blocks are called.
    """
    labels = list(dict.fromkeys(each for s in summaries for each in s.group.methods))
    if not is_described(question.better, len(labels), len(summaries)):
        return None
    first = summaries[0]
    held = f"Scope: {scope(first.units, question, blocks)}." if first.units.count > 1 else ""
    # the only row of a label is not a mean
    is_mean = any(len(s.group.rows) > len(s.group.methods) for s in summaries)
    metric = f"Mean {question.metric}" if is_mean else question.metric.capitalize()
    if len(summaries) == 1:
        return _of_one(first, metric, unit, held)
    spans = [[_mean(summary, label) for summary in summaries] for label in labels]
    cards = tuple(
        Card(
            str(label), _span(values, unit),
            facts=tuple(
                (group_text(summary.group, question), _span([value], unit))
                for summary, value in zip(summaries, values, strict=True)
            ),
        )
        for label, values in zip(labels, spans, strict=True)
    )  # fmt: skip
    most = max(range(len(labels)), key=lambda place: np.nansum(spans[place]))
    rest = [value for place, values in enumerate(spans) if place != most for value in values]
    others = f"the {len(labels) - 1} others" if len(labels) > 2 else "the other"
    return Lead(
        (
            f"{metric} in {len(summaries)} groups ({', '.join(question.within)}) is ",
            cards[most].headline,
            f" for {labels[most]}, and {_span(rest, unit)} for {others}.",
        ),
        cards,
        held,
    )  # fmt: skip


def _of_one(summary: Summary, metric: str, unit: str, held: str) -> Lead | None:
    """Return the lead of a single group, with the intervals of its means."""
    known = np.flatnonzero(np.isfinite(summary.mean)).tolist()
    if len(known) < 2:
        return None
    labels = [str(summary.group.methods[place]) for place in known]
    values = [float(summary.mean[place]) for place in known]
    # what is left of a number by rounding is none
    largest = max(map(abs, values))
    values = [0.0 if abs(each) < 1e-12 * largest else each for each in values]
    is_share = unit == "share"
    texts = [_span([each], unit) if is_share else number_text(each) for each in values]
    cards = tuple(
        Card(label, _span([value], unit), _interval(summary, place, unit if is_share else ""))
        for label, value, place in zip(labels, values, known, strict=True)
    )
    in_unit = f" in {unit_text(unit)}" if unit and not is_share else ""
    steps = np.sign(np.diff(values))
    verb = " falls from " if (steps < 0).all() else " rises from " if (steps > 0).all() else ": "
    rest = [f"{text} ({label})" for text, label in zip(texts[1:], labels[1:], strict=True)]
    to = ", " if verb == ": " else " to "
    return Lead(
        (f"{metric}{in_unit}{verb}", texts[0], f" ({labels[0]}){to}{_listed(rest)}."),
        cards,
        held,
    )


def _span(values: Sequence[float], unit: str) -> str:
    ends = [min(values), max(values)]
    return shares_text(ends) if unit == "share" else span_text(ends, unit)


def _mean(summary: Summary, label: object) -> float:
    methods = summary.group.methods
    return float(summary.mean[methods.index(label)]) if label in methods else float("nan")


def _listed(texts: Sequence[str]) -> str:
    *first, last = texts
    return f"{', '.join(first)} and {last}" if first else last


def _interval(summary: Summary, place: int, unit: str) -> str:
    low, high = float(summary.low[place]), float(summary.high[place])
    return f"95 %: {_span([low, high], unit)}" if low < high else ""

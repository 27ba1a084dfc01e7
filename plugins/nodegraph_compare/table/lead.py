"""The answer of a comparison without a better end: the mean of each label, side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.scope import scope
from nodegraph_tables.lead import MOST_CARDS, Card, Lead, number_text
from nodegraph_tables.style import unit_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nodegraph_compare.question import Question
    from nodegraph_compare.table.summary import Summary


def lead_of(
    summaries: Sequence[Summary], question: Question, unit: str, blocks: str
) -> Lead | None:
    """Return the lead of a single group of a few labels; None for other comparisons.

    Parameters
    ----------
    summaries, question
        Of the comparison.
    unit
        Of the metric.
    blocks
        What several blocks are called.
    """
    if question.better != "none" or len(summaries) != 1:
        return None
    (summary,) = summaries
    known = np.flatnonzero(np.isfinite(summary.mean)).tolist()
    if not 1 < len(known) <= MOST_CARDS:
        return None
    labels = [str(summary.group.methods[place]) for place in known]
    values = [float(summary.mean[place]) for place in known]
    # what is left of a number by rounding is none
    largest = max(map(abs, values))
    texts = [number_text(0.0 if abs(each) < 1e-12 * largest else each) for each in values]
    cards = tuple(
        Card(label, text, _interval(summary, place))
        for label, text, place in zip(labels, texts, known, strict=True)
    )
    in_unit = f" in {unit_text(unit)}" if unit else ""
    held = f"Scope: {scope(summary.units, question, blocks)}. " if summary.units.count > 1 else ""
    steps = np.sign(np.diff(values))
    verb = " falls from " if (steps < 0).all() else " rises from " if (steps > 0).all() else ": "
    rest = [f"{text} ({label})" for text, label in zip(texts[1:], labels[1:], strict=True)]
    to = ", " if verb == ": " else " to "
    return Lead(
        (
            f"Mean {question.metric}{in_unit}{verb}", texts[0],
            f" ({labels[0]}){to}{_listed(rest)}.",
        ),
        cards,
        held.strip(),
    )  # fmt: skip


def _listed(texts: Sequence[str]) -> str:
    *first, last = texts
    return f"{', '.join(first)} and {last}" if first else last


def _interval(summary: Summary, place: int) -> str:
    low, high = float(summary.low[place]), float(summary.high[place])
    return f"95 %: {number_text(low)} to {number_text(high)}" if low < high else ""

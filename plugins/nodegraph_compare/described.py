"""The answer of a comparison without a better end: the mean of each label, side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.cards import cards_of
from nodegraph_tables.answer import MOST_CARDS, Answer
from nodegraph_tables.numbers import ends_text, number_text, without_rounding
from nodegraph_tables.style import unit_text
from nodegraph_tables.text import HERE, Word, listing, say

if TYPE_CHECKING:
    from nodegraph_compare.verdict import Verdict, Verdicts

_MOST_GROUPS = 4


def is_described(verdicts: Verdicts) -> bool:
    """Whether a comparison has the answer of this module: of few labels without a better end."""
    few = 1 < len(verdicts.methods) <= MOST_CARDS and 0 < len(verdicts.groups) <= _MOST_GROUPS
    several = any(len(group.known) > 1 for group in verdicts.groups)
    return verdicts.metric.better == "none" and few and several


def described(verdicts: Verdicts) -> Answer:
    """Return the answer of a few groups of a few labels."""
    groups, unit = verdicts.groups, verdicts.metric.unit
    labels = [str(label) for label in verdicts.methods]
    name, is_mean = verdicts.metric.name, any(group.of_blocks > 1 for group in groups)
    metric = f"Mean {name}" if is_mean else name.capitalize()
    if len(groups) == 1:
        return _of_one(verdicts, groups[0], metric)
    spans = [[float(group.mean[place]) for group in groups] for place in range(len(labels))]
    most = max(range(len(labels)), key=lambda place: np.nansum(spans[place]))
    rest = [value for place, values in enumerate(spans) if place != most for value in values]
    others = f"the {len(labels) - 1} others" if len(labels) > 2 else "the other"
    sentence = say(
        f"{metric} in {len(groups)} groups ({', '.join(verdicts.within)}) is {HERE} for {HERE}, "
        f"and {HERE} for {others}.",
        Word(ends_text(spans[most], unit), "number"),
        Word(labels[most], "method"),
        Word(ends_text(rest, unit), "number"),
    )
    return Answer(sentence, cards=cards_of(verdicts))


def _of_one(verdicts: Verdicts, group: Verdict, metric: str) -> Answer:
    """Return the answer of a single group, with the intervals of its means."""
    known, unit = group.known, verdicts.metric.unit
    labels = [str(verdicts.methods[place]) for place in known]
    values = without_rounding([float(group.mean[place]) for place in known])
    is_share = unit == "share"
    texts = [ends_text([each], unit) if is_share else number_text(each) for each in values]
    in_unit = f" in {unit_text(unit)}" if unit and not is_share else ""
    steps = np.sign(np.diff(values))
    verb = " falls from " if (steps < 0).all() else " rises from " if (steps > 0).all() else ": "
    numbers = [Word(text, "number") for text in texts]
    items = [
        say(f"{HERE} ({HERE})", number, Word(label, "method"))
        for number, label in zip(numbers, labels, strict=True)
    ]
    to = ", " if verb == ": " else " to "
    sentence = say(f"{metric}{in_unit}{verb}{HERE}{to}{HERE}.", items[0], listing(items[1:]))
    return Answer(sentence, cards=cards_of(verdicts))

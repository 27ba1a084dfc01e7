"""The start of every comparison of gathered tables: question, blocks, labels and baseline."""

from __future__ import annotations

import re
import warnings
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import nearest
from nodegraph_compare.blocks import groups, label_order
from nodegraph_compare.question import ask, blocks_name, unit_of
from nodegraph_tables import info_of
from nodegraph_tables.style import SHARE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nodegraph import Across, Label
    from nodegraph_compare.blocks import Group
    from nodegraph_compare.question import Asked, Question
    from nodegraph_mocap import Table

_OF_SO_MANY = re.compile(r"of ([\d,]+)")
"""A unit that says the whole: ``of 100,000 links``."""


@dataclass(frozen=True, eq=False)
class Comparison:
    """Gathered tables with the question that is put to them.

    Attributes
    ----------
    scores : Across of Table
    question : Question
    groups : tuple of Group
        As they were scored.
    methods : tuple of labels
        All that are compared, in their order.
    fallback : label or None
        The method whose value stands where another has none.
    """

    scores: Across[Table]
    question: Question
    groups: tuple[Group, ...]
    methods: tuple[Label, ...]
    fallback: Label | None

    @cached_property
    def filled(self) -> tuple[Group, ...]:
        """The groups with the fallback's values where another method has none."""
        if self.fallback is None:
            return self.groups
        return tuple(group.filled(self.fallback) for group in self.groups)

    @cached_property
    def is_sequence(self) -> bool:
        """Whether methods follow one another, such as the steps of a chain."""
        return self.question.compare in info_of(self.scores.values()[0]).sequences

    @cached_property
    def unit(self) -> str:
        """Unit of the metric; empty if it has none."""
        return unit_of(self.scores, self.question.metric)

    @cached_property
    def limits(self) -> tuple[float, float]:
        """What a mean lies within: of so many, 0 to these; 0 to 1 of shares that all do."""
        if whole := _OF_SO_MANY.match(self.unit):
            return 0.0, float(whole[1].replace(",", ""))
        values = np.concatenate([group.values.ravel() for group in self.groups] or [np.empty(0)])
        values = values[np.isfinite(values)]
        is_bound = self.unit == SHARE and bool(((values >= 0.0) & (values <= 1.0)).all())
        return (0.0, 1.0) if is_bound else (-np.inf, np.inf)

    @cached_property
    def blocks(self) -> str:
        """The plural noun for blocks."""
        return blocks_name(self.scores, self.question)

    def baseline(self, name: str | None) -> Label | None:
        """Return the label that a setting names."""
        return _named_label(self.methods, name, "baseline")


def prepare(scores: Across[Table], asked: Asked) -> Comparison:
    """Return the comparison that the settings of a node ask for; see `ask`.

    Called by a node itself, so that a warning of a fallback that is left out is the node's.

    Raises
    ------
    ValueError
        As `ask` does, and if the fallback is not a label that is compared.
    """
    question = ask(scores, asked)
    if question.alike.warning:
        warnings.warn(question.alike.warning, stacklevel=4)
    gathered = groups(scores, question)
    methods = _compared_labels(scores, question, gathered)
    return Comparison(scores, question, gathered, methods, fallback_label(methods, asked.fallback))


def _compared_labels(
    scores: Across[object], question: Question, gathered: Sequence[Group]
) -> tuple[Label, ...]:
    """Return all compared labels in their order: an axis's, else as the groups have them."""
    if question.compare in scores.axes:
        return label_order(scores, question.compare)
    return tuple(dict.fromkeys(label for group in gathered for label in group.methods))


def fallback_label(order: Sequence[Label], name: str | None) -> Label | None:
    """Return the label whose values stand for missing ones, or None, with a warning, if it is out.

    A graph names it for all methods of a family, and a command may run a few of these.
    """
    if name is not None and name not in map(str, order):
        warnings.warn(
            f"the fallback {name!r} is not among those compared: blocks that a method lacks are "
            "left out",
            stacklevel=5,
        )
        return None
    return _named_label(order, name, "fallback")


def _named_label(order: Sequence[Label], name: str | None, what: str) -> Label | None:
    """Return the label that a setting names; a text that no label has is a ValueError."""
    if name is None:
        return None
    for label in order:
        if str(label) == name:
            return label
    raise ValueError(f"no {what} {name!r}; {nearest(name, order, what='compared are')}")

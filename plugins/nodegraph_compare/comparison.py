"""The first steps of every comparison of gathered tables: what is asked, of which blocks."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from nodegraph_compare.blocks import groups
from nodegraph_compare.labels import compared_labels, fallback_label, named_label
from nodegraph_compare.question import ask, blocks_name, unit_of

if TYPE_CHECKING:
    from nodegraph import Across, Label
    from nodegraph_compare.blocks import Group
    from nodegraph_compare.question import Better, Question
    from nodegraph_mocap import Table


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
    def unit(self) -> str:
        """Of the metric; empty if it has none."""
        return unit_of(self.scores, self.question.metric)

    @cached_property
    def blocks(self) -> str:
        """What several blocks are called."""
        return blocks_name(self.scores, self.question)

    def baseline(self, name: str | None) -> Label | None:
        """Return the label that a setting names."""
        return named_label(self.methods, name)


def prepare(
    scores: Across[Table],
    *,
    metric: str | None,
    compare: str | None,
    within: tuple[str, ...],
    blocks: tuple[str, ...],
    clusters: tuple[str, ...],
    better: Better = "declared",
    fallback: str | None = None,
) -> Comparison:
    """Return the comparison that the settings of a node ask for; see `ask`.

    Called by a node itself, so that a warning of a fallback that is left out is the node's.

    Raises
    ------
    ValueError
        As `ask` does, and if the fallback is not a label that is compared.
    """
    question = ask(
        scores,
        metric=metric,
        compare=compare,
        within=within,
        blocks=blocks,
        clusters=clusters,
        better=better,
    )
    gathered = groups(scores, question)
    methods = compared_labels(scores, question, gathered)
    return Comparison(scores, question, gathered, methods, fallback_label(methods, fallback))

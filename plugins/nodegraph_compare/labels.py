"""The compared labels: their order, and the baseline among them."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

from nodegraph import nearest
from nodegraph_compare.blocks import label_order

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nodegraph import Across, Label
    from nodegraph_compare.blocks import Group
    from nodegraph_compare.question import Question


def compared_labels(
    scores: Across[object], question: Question, groups: Sequence[Group]
) -> tuple[Label, ...]:
    """Return all compared labels in their order: an axis's, else as the groups have them.

    Parameters
    ----------
    scores
        The gathered tables.
    question
        Of the comparison.
    found
        The groups of the tables.
    """
    if question.compare in scores.axes:
        return label_order(scores, question.compare)
    return tuple(dict.fromkeys(label for group in groups for label in group.methods))


def named_label(order: Sequence[Label], name: str | None, what: str = "baseline") -> Label | None:
    """Return the label that a setting names, such as the baseline.

    Raises
    ------
    ValueError
        If none has that text.
    """
    if name is None:
        return None
    for label in order:
        if str(label) == name:
            return label
    raise ValueError(f"no {what} {name!r}; {nearest(name, order, what='compared are')}")


def fallback_label(order: Sequence[Label], name: str | None) -> Label | None:
    """Return the label whose values stand for missing ones, or None, with a warning, if it is out.

    A graph names it for all methods of a family, and a command may run a few of these.
    """
    if name is not None and name not in map(str, order):
        warnings.warn(
            f"the fallback {name!r} is not among those compared: blocks that a method lacks are "
            "left out",
            stacklevel=4,
        )
        return None
    return named_label(order, name, "fallback")

"""The order of the labels of a gathered axis."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any

from nodegraph import nearest
from nodegraph_tables.style import looks

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from nodegraph import Across, Label
    from nodegraph_compare.blocks import Group
    from nodegraph_compare.question import Question
    from nodegraph_tables.style import Look


def label_order(scores: Across[Any], axis: str) -> tuple[Label, ...]:
    """Return the labels of a gathered axis in the order in which the graph lists them.

    The values along the axis, with all other labels fixed, are in that order; where some of them
    are absent, a label takes its place behind the one that it follows elsewhere. Labels without
    any value come last; labels that were only ever skipped are left out.
    """
    order: list[Label] = []
    for sequence in _sequences(scores, axis):
        if not set(order).issuperset(sequence):
            _merge(order, sequence)
    wanting = (one.labels.get(axis, "") for one in scores.absent if one.kind != "skipped")
    return tuple(dict.fromkeys([*order, *wanting]))


def compared_labels(
    scores: Across[Any], question: Question, found: Sequence[Group]
) -> tuple[Label, ...]:
    """Return all compared labels in their order: an axis's, else as the groups have them.

    Parameters
    ----------
    scores
        The gathered tables.
    question
        Of which the compared labels are asked for.
    found
        The groups of the tables.
    """
    if question.compare in scores.axes:
        return label_order(scores, question.compare)
    return tuple(dict.fromkeys(label for one in found for label in one.methods))


def compared_looks(
    scores: Across[Any], question: Question, found: Sequence[Group]
) -> dict[Label, Look]:
    """Return how each compared label appears, in the order of `compared_labels`.

    Looks are dealt to all labels that the graph has on that axis: a method that is compared here
    looks as it does in every other figure, whichever others stand beside it.

    Parameters
    ----------
    scores
        The gathered tables.
    question
        Of which the compared labels are asked for.
    found
        The groups of the tables.
    """
    order = compared_labels(scores, question, found)
    every = scores.labels(question.compare) if question.compare in scores.axes else ()
    dealt = looks((*order, *every))
    return {label: dealt[str(label)] for label in order}


def named_label(order: Sequence[Label], baseline: str | None) -> Label | None:
    """Return the label that a baseline names.

    Raises
    ------
    ValueError
        If none has that text.
    """
    if baseline is None:
        return None
    for label in order:
        if str(label) == baseline:
            return label
    raise ValueError(f"no baseline {baseline!r}; {nearest(baseline, order, what='compared are')}")


def _sequences(scores: Across[Any], axis: str) -> Iterable[list[Label]]:
    found: defaultdict[tuple[Label, ...], list[Label]] = defaultdict(list)
    others = [other for other in scores.axes if other != axis]
    for labels, _ in scores:
        found[tuple(labels.get(other, "") for other in others)].append(labels.get(axis, ""))
    return found.values()


def _merge(order: list[Label], sequence: list[Label]) -> None:
    place = len(order) if set(order).isdisjoint(sequence) else 0
    for label in sequence:
        if label in order:
            place = order.index(label) + 1
        else:
            order.insert(place, label)
            place += 1

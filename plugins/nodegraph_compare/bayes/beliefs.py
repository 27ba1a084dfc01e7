"""Probabilities that the methods of a group are better, equivalent, or worse."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.inference import posterior
from nodegraph_compare.question import sign_of
from nodegraph_compare.table.summary import summarise

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph import Label
    from nodegraph_compare.blocks import Group
    from nodegraph_compare.question import Margin, Question
    from nodegraph_compare.table.summary import Summary

SIDES = ("better", "equivalent", "worse")
CLEAR = 0.95
"""From this probability on, a method is called better, equivalent or worse."""


@dataclass(frozen=True)
class Beliefs:
    """Probabilities of one group, against one of its methods.

    Attributes
    ----------
    summary : Summary
    reference : int
    places : tuple of int
        The other methods that have numbers.
    mean, new : (3, len(places)) arrays of float64
        That the mean over clusters, and that a further cluster, is better, equivalent, or worse.
    by_rule : tuple of Beliefs or None
        Of the same methods by the other rules for missing blocks; None where these have too few
        clusters.
    """

    summary: Summary
    reference: int
    places: tuple[int, ...]
    mean: NDArray[np.float64]
    new: NDArray[np.float64]
    by_rule: tuple[Beliefs | None, ...] = ()

    @property
    def clear(self) -> tuple[str, ...]:
        """The clear side of each method; empty where there is none."""
        largest = np.argmax(self.mean, axis=0)
        chance = self.mean.max(axis=0)
        return tuple(
            SIDES[side] if p >= CLEAR else "" for side, p in zip(largest, chance, strict=True)
        )

    @property
    def agreed(self) -> tuple[str, ...]:
        """The side of each method that is clear by every rule for missing blocks."""
        others = [("",) * len(self.places) if each is None else each.clear for each in self.by_rule]
        return tuple(
            side if all(other == side for other in rest) else ""
            for side, *rest in zip(self.clear, *others, strict=True)
        )

    @property
    def group(self) -> Group:
        """The compared number."""
        return self.summary.group


def beliefs_by_rules(
    group: Group,
    fallback: Label | None,
    question: Question,
    against: Label | None,
    margin: Margin,
) -> Beliefs | None:
    """Return the probabilities of a group with a fallback, those by the other rules beside them.

    Parameters
    ----------
    group
        As it was scored.
    fallback
        The method whose value stands where another has none.
    question, against, margin
        See `beliefs`.
    """
    if fallback not in group.methods or group.complete.all():
        return beliefs(group, question, against, margin)
    belief = beliefs(group.filled(fallback), question, against, margin)
    if belief is None:
        return None
    reference = group.methods[belief.reference]
    others = (group, group.with_worst(question.better))
    return replace(
        belief,
        by_rule=tuple(beliefs(other, question, reference, margin) for other in others),
    )


def beliefs(
    group: Group, question: Question, against: Label | None, margin: Margin
) -> Beliefs | None:
    """Return the probabilities of a group; None where it has too few clusters or methods.

    Parameters
    ----------
    group, question
        What is compared.
    against
        The baseline's label; None for the best of the group.
    margin
        Within which methods count as equal.
    """
    ratio = margin.ratio
    summary = summarise(group, question.better, ratio=ratio, against=against)
    reference = summary.best if against is None else summary.against
    usable = np.flatnonzero(group.usable)
    if summary.units.kind != "clusters" or not summary.judged or reference not in usable:
        return None
    y = sign_of(question.better) * summary.units.numbers(ratio)
    size = np.log(margin.size) if ratio else margin.size
    at = int(np.flatnonzero(usable == reference)[0])
    others = [place for place in range(len(usable)) if place != at]
    d = (y - y[:, [at]]).T
    variance = _variance(group, summary, at, ratio=ratio)
    mean, new = (
        np.array([posterior(d[other], variance[other], size, new=further) for other in others]).T
        for further in (False, True)
    )
    return Beliefs(summary, int(usable[at]), tuple(usable[others].tolist()), mean, new)


def _variance(group: Group, summary: Summary, at: int, *, ratio: bool) -> NDArray[np.float64]:
    """Return (K,) the variance of a cluster's mean difference, pooled over clusters."""
    kept = group.complete
    values = group.values[kept][:, group.usable]
    _, cluster = np.unique(group.cluster[kept], return_inverse=True)
    means = summary.units.means[cluster]
    relative = values / means if ratio else values - means
    within = relative - relative[:, [at]]
    blocks = np.bincount(cluster)
    freedom = len(values) - len(blocks)
    if not freedom:  # a block in each: all variance is between clusters
        return np.zeros(values.shape[1])
    return np.asarray(np.square(within).sum(axis=0) / freedom * (1 / blocks).mean())

"""Probabilities that the methods of a group are better, equivalent, or worse."""

from __future__ import annotations

from dataclasses import dataclass
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
    """

    summary: Summary
    reference: int
    places: tuple[int, ...]
    mean: NDArray[np.float64]
    new: NDArray[np.float64]

    @property
    def group(self) -> Group:
        """What is compared."""
        return self.summary.group


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

"""The markers that move most."""

from __future__ import annotations

import warnings

import numpy as np

from nodegraph import node
from nodegraph_mocap import Selection
from nodegraph_select.features import features_of
from nodegraph_select.pairs import membership, pairs_of
from nodegraph_select.ranking import Wanted, by_variance, first_pairs, pairs_chosen


@node("select.variance", shares=Wanted)
def variance(wanted: Wanted) -> Selection:
    """Choose the markers that move most, each with its partner.

    A marker's variance is the mean squared distance from its mean position. From the largest
    down, each marker is chosen, and the other one of its pair with it, until there are k. What
    moves alike is chosen again and again: this is what methods that avoid it are compared with.
    Once all that move are chosen, the rest follow by name, with a warning.

    Head motion must have been removed. Does not depend on the axes.

    Returns
    -------
    Selection
        The markers chosen, in the order of the recording; all pairs; and a row per pair that was
        chosen, the first one first: `markers` so far, `variance` in mm^2 of its marker that
        moves more.
    """
    recording, count = wanted.recording, wanted.count()
    features, pairs = features_of(recording), pairs_of(recording, stacklevel=4)
    order = by_variance(features.variances)
    numbers = membership(pairs, features.markers)[order]
    selection = first_pairs(recording, pairs, numbers, count, features.variances[order], "variance")
    _warn_still(len(np.unique(numbers[features.variances[order] > 0.0])), pairs_chosen(selection))
    return selection


def _warn_still(moving: int, chosen: int) -> None:
    if chosen > moving:
        warnings.warn(
            f"only {moving} of the {chosen} pairs chosen move; the others are the first by name",
            stacklevel=4,
        )

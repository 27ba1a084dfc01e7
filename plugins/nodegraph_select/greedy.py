"""At each step the marker that explains most of what is left of all the others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph import node
from nodegraph_mocap import Selection
from nodegraph_select.features import Features, features_of
from nodegraph_select.pairs import membership, pairs_of
from nodegraph_select.ranking import Wanted, by_variance, first_pairs, warn_spanned

if TYPE_CHECKING:
    from numpy.typing import NDArray

_NOTHING = 1e-12
"""Share of all variance below which a gain is rounding."""
_TIE = 1e-9
"""Relative difference from the largest gain within which a gain counts as equal."""


@node("select.greedy", cite="farahat2013", shares=Wanted)
def greedy(wanted: Wanted) -> Selection:
    """Choose markers by greedy column subset selection (Farahat et al.).

    The columns of X are the features, three coordinates per marker over the take, each less its
    mean. With S the columns of the markers chosen and ``P_S`` the projection on their span, each
    step chooses the marker whose three columns, added to S, make ``|X - P_S X|^2`` smallest, that
    is, from which a linear regression predicts most of what is not yet predicted; the first by
    name of equals. Its partner is chosen with it, until there are k. Farahat et al. add a column
    at a time; here a marker has its three at once. Once nothing is left to predict, the rest
    follow by their variance, with a warning.

    Head motion must have been removed. Does not depend on the axes.

    Returns
    -------
    Selection
        The markers chosen, in the order of the recording; all pairs; and a row per pair that was
        chosen, the first one first: `markers` so far, `unexplained`, the share
        ``|X - P_S X|^2 / |X|^2`` that is left after it.
    """
    recording, count = wanted.recording, wanted.count()
    features, pairs = features_of(recording), pairs_of(recording, stacklevel=4)
    pair = membership(pairs, features.markers)
    ranked, left = _ranked(features, pair)
    order = np.concatenate([ranked, pair[by_variance(features.variances)]])
    left = np.concatenate([left, np.zeros(len(pair))])
    selection = first_pairs(recording, pairs, order, count, left, "unexplained")
    warn_spanned(len(ranked), selection)
    return selection


def _ranked(
    features: Features, pair: NDArray[np.intp]
) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Return pairs in the order of choice, and what each leaves, until nothing is left.

    Parameters
    ----------
    features
        Features of M markers.
    pair : (M,) array of int
        The pair of each marker.
    """
    rest = features.values.T @ features.values
    whole = np.trace(rest)
    nothing = max(_NOTHING * whole, len(features.values) * features.rounding**2)
    ranked, left = [], []
    while np.trace(rest) > nothing:
        gain = _gains(rest, nothing)
        best = int(np.flatnonzero(gain >= gain.max() * (1.0 - _TIE))[0])
        if gain[best] <= 0.0:
            break
        chosen = np.flatnonzero(np.repeat(pair == pair[best], 3))
        rest = _without(rest, chosen, nothing)
        ranked.append(pair[best])
        left.append(max(float(np.trace(rest) / whole), 0.0))
    return np.array(ranked, dtype=np.intp), np.array(left)


def _gains(rest: NDArray[np.float64], nothing: float) -> NDArray[np.float64]:
    """Return, for each marker, how much of all features its three would explain."""
    markers = np.arange(len(rest) // 3)
    own = rest.reshape(len(markers), 3, len(markers), 3)[markers, :, markers]
    reach = (rest @ rest).reshape(len(markers), 3, len(markers), 3)[markers, :, markers]
    squares, vectors = np.linalg.eigh(own)
    along = np.einsum("mij,mik,mkj->mj", vectors, reach, vectors)
    return np.asarray(
        np.divide(along, squares, out=np.zeros_like(along), where=squares > nothing).sum(axis=1)
    )


def _without(
    rest: NDArray[np.float64], chosen: NDArray[np.intp], nothing: float
) -> NDArray[np.float64]:
    """Return the products of what the chosen features do not explain."""
    squares, vectors = np.linalg.eigh(rest[np.ix_(chosen, chosen)])
    some = squares > nothing
    known = rest[:, chosen] @ (vectors[:, some] / np.sqrt(squares[some]))
    left = rest - known @ known.T
    left[chosen] = 0.0
    left[:, chosen] = 0.0
    return np.asarray(left)

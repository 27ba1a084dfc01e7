"""Features far from what the earlier ones span: QR with column pivoting."""

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


@node("select.qr", cite=("businger_golub1965", "manohar2018"), shares=Wanted)
def qr(wanted: Wanted) -> Selection:
    """Choose markers by QR with column pivoting (Businger & Golub; Manohar et al.).

    The columns of X are the features, three coordinates per marker over the take, each less its
    mean. The pivots of ``X P = Q R`` are taken in turn: each is the feature that is farthest,
    ``|R_ii|``, from the space that the earlier ones span. A feature chooses its marker, and the
    marker its partner, until there are k. Manohar et al. pivot the leading principal components,
    which gives as many features as components; X gives an order of all that move by themselves.
    Once what is chosen determines all the others, the rest follow by their variance, with a
    warning.

    Head motion must have been removed. It depends on the axes, because features are coordinates.

    Returns
    -------
    Selection
        The markers chosen, in the order of the recording; all pairs; and a row per pair that was
        chosen, the first one first: `markers` so far, `residual` in mm, the distance
        ``|R_ii| / sqrt(T)`` of the feature that chose it.
    """
    recording, count = wanted.recording, wanted.count()
    features, pairs = features_of(recording), pairs_of(recording, stacklevel=4)
    pivots, residual = _pivots(features)
    order = np.concatenate([pivots // 3, by_variance(features.variances)])
    numbers = membership(pairs, features.markers)[order]
    residual = np.concatenate([residual, np.zeros(len(features.markers))])
    selection = first_pairs(recording, pairs, numbers, count, residual, "residual")
    warn_spanned(len(np.unique(numbers[: len(pivots)])), selection)
    return selection


def _pivots(features: Features) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Return features in the order of pivoting and their distances, without those of none."""
    from scipy.linalg import qr as decompose

    upper, order = decompose(features.values, mode="r", pivoting=True)
    distance = np.abs(np.diag(upper)) / np.sqrt(len(features.values))
    rank = int(np.count_nonzero(distance > features.rounding))
    return np.asarray(order[:rank], dtype=np.intp), distance[:rank]

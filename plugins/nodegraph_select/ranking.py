"""The first pairs of an order, as many as it takes for a number of markers."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Refusal
from nodegraph_mocap import Selection, Trajectories
from nodegraph_select.checks import check_whole
from nodegraph_select.pairs import Pairs, in_order, sizes

if TYPE_CHECKING:
    from numpy.typing import NDArray


def check_count(recording: Trajectories, k: int) -> None:
    """Refuse to choose more markers than there are.

    Raises
    ------
    Refusal
        If k is more.
    ValueError
        If it is no number of markers.
    """
    check_whole("k", k, 1)
    if k > len(recording.markers):
        raise Refusal(f"k = {k} markers cannot be chosen of {len(recording.markers)}")


def first_pairs(
    recording: Trajectories,
    pairs: Pairs,
    order: NDArray[np.intp],
    k: int,
    values: NDArray[np.float64] | None = None,
    column: str = "",
) -> Selection:
    """Return the first pairs of an order that have at least k markers together.

    Parameters
    ----------
    recording
        Whose markers they are.
    pairs
        P of them.
    order : (N,) array of int
        Numbers of pairs, the best first, each at least once; the first place counts.
    k
        Number of markers, at most as many as there are.
    values : (N,) array of float64, or None
        What put each place of the order where it is.
    column
        What the history calls these values, where there are any.
    """
    first = np.sort(np.unique(order, return_index=True)[1])
    markers = np.cumsum(sizes(pairs)[order[first]])
    taken = first[: 1 + int(np.searchsorted(markers, k))]
    history = None
    if values is not None:
        history = np.stack([markers[: len(taken)].astype(np.float64), values[taken]], axis=1)
    return Selection(
        chosen=in_order(recording, [pairs[number] for number in order[taken]]),
        pairs=pairs,
        columns=("markers", column) if column else (),
        history=history,
    )


def by_variance(variances: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return the numbers of markers, the largest variance first, of equals the first."""
    return np.argsort(-variances, kind="stable")


def pairs_chosen(selection: Selection) -> int:
    """Return how many of a selection's pairs are chosen."""
    chosen = set(selection.chosen)
    return sum(pair[0] in chosen for pair in selection.pairs)


def warn_spanned(spanning: int, selection: Selection) -> None:
    """Warn when fewer pairs than were chosen determine the motion of all."""
    chosen = pairs_chosen(selection)
    if chosen > spanning:
        warnings.warn(
            f"{spanning} of the {chosen} pairs chosen determine all markers' motion; the others "
            "are those of largest variance",
            stacklevel=3,
        )

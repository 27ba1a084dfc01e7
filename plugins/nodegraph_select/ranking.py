"""The first pairs of an order, as many as it takes for a number of markers."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Refusal
from nodegraph_mocap import Selection, Trajectories
from nodegraph_select.checks import check_whole
from nodegraph_select.pairs import Pairs, in_order, sizes

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Count:
    """The number of markers to choose.

    Attributes
    ----------
    markers : int
    exact : bool
        Whether a pair that would exceed the number is passed over; else it is the last one.
    """

    markers: int
    exact: bool


def count_of(recording: Trajectories, k: int | None, like: Selection | None) -> Count:
    """Return how many markers a setting, or another selection, asks for.

    Raises
    ------
    Refusal
        If there are fewer.
    ValueError
        If there is neither or both, or the setting is not a number of markers.
    """
    if (k is None) == (like is None):
        raise ValueError(f"give k or a selection `like`, got {'neither' if k is None else 'both'}")
    count = Count(len(like.chosen), exact=True) if k is None and like else Count(k or 0, False)
    check_whole("k", count.markers, 1)
    if count.markers > len(recording.markers):
        raise Refusal(f"k = {count.markers} markers cannot be chosen of {len(recording.markers)}")
    return count


def first_pairs(
    recording: Trajectories,
    pairs: Pairs,
    order: NDArray[np.intp],
    count: Count,
    values: NDArray[np.float64] | None = None,
    column: str = "",
) -> Selection:
    """Return the first pairs of an order that together have a number of markers.

    Parameters
    ----------
    recording
        Whose markers they are.
    pairs
        P of them.
    order : (N,) array of int
        Numbers of pairs, the best first, each at least once; the first place counts.
    count
        How many markers, at most as many as there are.
    values : (N,) array of float64, or None
        What put each place of the order where it is.
    column
        What the history calls these values, where there are any.
    """
    first = np.sort(np.unique(order, return_index=True)[1])
    taken = first[_taken(sizes(pairs)[order[first]], count)]
    history = None
    if values is not None:
        markers = np.cumsum(sizes(pairs)[order[taken]])
        history = np.stack([markers.astype(np.float64), values[taken]], axis=1)
    return Selection(
        chosen=in_order(recording, [pairs[number] for number in order[taken]]),
        pairs=pairs,
        columns=("markers", column) if column else (),
        history=history,
    )


def _taken(markers: NDArray[np.intp], count: Count) -> list[int]:
    """Return the places of the pairs that are taken, given how many markers each has."""
    places, free = [], count.markers
    for place, size in enumerate(markers.tolist()):
        if free > 0 and (size <= free or not count.exact):
            places.append(place)
            free -= size
    return places


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

"""The first pairs of an order, as many as it takes for a number of markers."""

from __future__ import annotations

import warnings
from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

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


@dataclass(frozen=True)
class Wanted:
    """A recording and how many of its markers are to be chosen.

    Attributes
    ----------
    recording
        Trajectories with every sample, head motion removed; pairs are those of its marker set,
        a marker that is in none is alone, with a warning unless it is on the midline.
    like
        Another selection: as many markers are chosen as it has, a pair that would exceed them
        being passed over; one fewer where only pairs are left. In place of `k`.
    k
        Number of markers; one more where the last pair exceeds it, as pairs stay whole.

    Raises
    ------
    Refusal
        If the recording has fewer than k markers, samples are missing, there are fewer than two
        frames, or nothing moves by more than rounding.
    ValueError
        If the marker set puts a marker into two pairs, a setting is out of range, or there is
        neither or both of `k` and `like`.
    """

    recording: Trajectories
    like: Selection | None = None
    _: KW_ONLY
    k: Annotated[int, Field(ge=1)] | None = None

    def count(self) -> Count:
        """Return how many markers are asked for.

        Raises
        ------
        Refusal
            If there are fewer.
        ValueError
            If there is neither or both, or the setting is not a number of markers.
        """
        k, like, markers = self.k, self.like, self.recording.markers
        if (k is None) == (like is None):
            given = "neither" if k is None else "both"
            raise ValueError(f"give k or a selection `like`, got {given}")
        count = Count(len(like.chosen), exact=True) if k is None and like else Count(k or 0, False)
        check_whole("k", count.markers, 1)
        if count.markers > len(markers):
            raise Refusal(f"k = {count.markers} markers cannot be chosen of {len(markers)}")
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
        The numbers by which the order was made.
    column
        The name of these values in the history, where there are any.
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
            stacklevel=4,
        )

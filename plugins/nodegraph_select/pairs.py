"""Pairs of markers that are chosen or left together."""

from __future__ import annotations

import warnings
from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import listed

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from nodegraph_mocap import Trajectories

Pairs = tuple[tuple[str, ...], ...]
_MOST_NAMES = 6


def pairs_of(recording: Trajectories, *, stacklevel: int = 3) -> Pairs:
    """Return the recording's markers as pairs, left and right, and singletons.

    Pairs are those of its marker set, in that order; then come the markers of the midline, then
    any others, each alone. A warning lists which markers are alone without being on the midline.

    Raises
    ------
    ValueError
        If the marker set puts a marker into two pairs, or into a pair and on the midline.
    """
    known = set(recording.markers)
    marker_set = recording.marker_set
    pairs: list[tuple[str, ...]] = [
        pair for pair in (marker_set.pairs if marker_set else ()) if known.issuperset(pair)
    ]
    midline = [name for name in (marker_set.midline if marker_set else ()) if name in known]
    pairs += [(name,) for name in dict.fromkeys(midline)]
    _check_once(name for pair in pairs for name in pair)
    placed = {name for pair in pairs for name in pair}
    alone = [name for name in recording.markers if name not in placed]
    _warn(recording, alone, stacklevel + 1)
    return (*pairs, *((name,) for name in alone))


def membership(pairs: Pairs, markers: Sequence[str]) -> NDArray[np.intp]:
    """Return, for each of the markers, the number of its pair."""
    number = {name: index for index, pair in enumerate(pairs) for name in pair}
    return np.array([number[name] for name in markers], dtype=np.intp)


def sizes(pairs: Pairs) -> NDArray[np.intp]:
    """Return how many markers each pair has."""
    return np.array([len(pair) for pair in pairs], dtype=np.intp)


def in_order(recording: Trajectories, chosen: Iterable[tuple[str, ...]]) -> tuple[str, ...]:
    """Return the markers of the chosen pairs in the order of the recording."""
    names = {name for pair in chosen for name in pair}
    return tuple(name for name in recording.markers if name in names)


def _check_once(names: Iterable[str]) -> None:
    repeated = sorted(name for name, count in Counter(names).items() if count > 1)
    if repeated:
        raise ValueError(
            f"marker set: {', '.join(repeated)}: in more than one pair, or in a pair and on the "
            "midline"
        )


def _warn(recording: Trajectories, alone: list[str], stacklevel: int) -> None:
    if not alone:
        return
    if recording.marker_set is None:
        why = "the recording has no marker set, which would say what is a pair"
    else:
        why = "the marker set has them in no pair with another marker, nor on the midline"
    warnings.warn(
        f"{len(alone)} of {len(recording.markers)} markers are chosen or left each by itself: "
        f"{why}: {listed(alone, _MOST_NAMES)}",
        stacklevel=stacklevel,
    )

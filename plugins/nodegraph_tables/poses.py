"""Poses of the recording behind a table, by which takes of one person are recognized."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Value

if TYPE_CHECKING:
    from numpy.typing import NDArray

_FRAMES, _MARKERS, _DECIMALS = 32, 16, 3
_FEWEST = 6
"""Markers below which many faces are alike."""


@dataclass(frozen=True)
class Poses(Value):
    """A few frames of a recording, of a few of its markers.

    Attributes
    ----------
    markers : tuple of str
        All of the recording's, in alphabetical order.
    positions : bytes
        float32, (32 frames at most, 16 markers at most, 3), mm: spread evenly over the frames and
        over `markers`. NaN where missing; empty where what is scored has none, as weights. They are
        whole micrometres, so that the rounding of another processor does not show.
    frames : int
        Number of frames of the recording.
    rate : float
        Hz.
    """

    markers: tuple[str, ...]
    positions: bytes
    frames: int
    rate: float

    def distances(self) -> NDArray[np.float64]:
        """Return (F, P) mm between the markers of each pair, which no motion of a head changes."""
        kept = min(len(self.markers), _MARKERS)
        places = np.frombuffer(self.positions, np.float32).reshape(-1, kept, 3).astype(np.float64)
        first, second = np.array(list(combinations(range(kept), 2))).reshape(-1, 2).T
        return np.asarray(np.linalg.norm(places[:, first] - places[:, second], axis=2))


def poses_of(markers: tuple[str, ...], positions: NDArray[np.float64], rate: float) -> Poses:
    """Return the poses of a recording.

    Parameters
    ----------
    markers
        M names.
    positions
        (T, M, 3) mm, NaN where missing.
    rate
        Hz.
    """
    order = np.argsort(np.array(markers, dtype=object), kind="stable")
    kept = order[_spread(len(markers), _MARKERS)]
    few = positions[_spread(len(positions), _FRAMES)[:, None], kept].round(_DECIMALS)
    few += 0.0  # -0 is 0
    return Poses(tuple(sorted(markers)), few.astype(np.float32).tobytes(), len(positions), rate)


def difference(first: Poses, second: Poses) -> float:
    """Return by how much the most similar poses of two recordings differ.

    The root mean square difference of the distances between markers, mm, over the pairs that both
    poses have, for the two poses, one of each, for which it is lowest: people come back to their
    neutral. Infinite for other markers, fewer than six, or poses with less than half of the pairs.
    """
    if first.markers != second.markers or len(first.markers) < _FEWEST:
        return np.inf
    ours, theirs = first.distances(), second.distances()
    here, there = (np.isfinite(each).astype(np.float64) for each in (ours, theirs))
    ours, theirs = np.nan_to_num(ours), np.nan_to_num(theirs)
    count = here @ there.T
    # from the middle, where the squares lose fewer digits
    middle = ours.sum() / max(here.sum(), 1.0)
    ours, theirs = (ours - middle) * here, (theirs - middle) * there
    squares = ours**2 @ there.T + here @ (theirs**2).T - 2.0 * ours @ theirs.T
    known = 2 * count >= ours.shape[1]
    mean = np.maximum(squares[known], 0.0) / count[known]
    return float(np.sqrt(mean.min(initial=np.inf)))


def _spread(count: int, most: int) -> NDArray[np.intp]:
    """Return up to `most` of `count` places, evenly spread."""
    return np.linspace(0, max(count - 1, 0), min(count, most)).round().astype(np.intp)

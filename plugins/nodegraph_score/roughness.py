"""The unevenness of a marker's movement from frame to frame, a row per marker."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np

from nodegraph import Columns, node
from nodegraph_mocap import Table, Trajectories
from nodegraph_score.notes import with_notes
from nodegraph_tables import BetterEnd, TableInfo

if TYPE_CHECKING:
    from numpy.typing import NDArray

UNITS = {"vectors": "count", "roughness": "mm^2/frame^2"}
BETTER: dict[str, BetterEnd] = {"vectors": "none", "roughness": "none"}
_MARKERS = 8
"""Number of markers at a time: the differences of all take several times as much memory."""


@node("score.roughness", cite="zhang_scattered")
def roughness(recording: Trajectories) -> Annotated[Table, Columns("marker", *UNITS)]:
    """Variance of each marker's steps from frame to frame (Table 1 of Zhang et al.).

    The "variance of the vectors grouped using two neighbors": with ``D[i] = Q[i+1] - Q[i]``
    wherever both frames are present, measured or not,
    ``roughness = mean(|D[i] - mean(D)|^2)``, the population variance summed over the three
    coordinates:

    ========= ============================================================================
    marker    its name
    vectors   how many steps D it has
    roughness mm^2 per frame^2
    ========= ============================================================================

    A marker with fewer than two steps has no roughness: NaN, counted in a warning and in the
    table's notes. Lower is smoother and by itself no better: a marker that is held still scores
    0. Show it beside an error to the truth, as `score.smoothness` has it. Steps grow as frames
    get fewer: compare at one rate.

    Parameters
    ----------
    recording
        Trajectories, with or without gaps.

    Returns
    -------
    Table
        As above, in the order of the markers.

    Raises
    ------
    ValueError
        If a sum of squares is beyond all numbers.
    """
    from pandas import DataFrame

    with np.errstate(over="raise"):
        try:
            count = -(-len(recording.markers) // _MARKERS) or 1
            pieces = np.array_split(recording.positions, count, axis=1)
            blocks = [_variances(piece) for piece in pieces]
        except FloatingPointError:
            raise ValueError("steps are too large to be squared") from None
    vectors, variance = (np.concatenate(parts) for parts in zip(*blocks, strict=True))
    columns = {"vectors": vectors, "roughness": variance}
    table = DataFrame({"marker": np.array(recording.markers, dtype=object), **columns})
    notes = _notes(vectors)
    info = TableInfo("Roughness", units=UNITS, better=BETTER)
    return with_notes(table, notes, info, of=recording)


def _variances(
    positions: NDArray[np.float64],
) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Return, per marker, the number of steps and their variance; NaN where there are under two."""
    steps = np.diff(positions, axis=0)
    known = np.isfinite(steps[..., 0])
    vectors = np.count_nonzero(known, axis=0)
    some = np.maximum(vectors, 1)[:, None]
    mean = np.sum(steps, axis=0, where=known[..., None]) / some
    apart = np.where(known[..., None], steps - mean, 0.0)
    variance = np.sum(np.square(apart) / some, axis=(0, 2))
    return vectors, np.where(vectors > 1, variance, np.nan)


def _notes(vectors: NDArray[np.intp]) -> list[str]:
    few = np.count_nonzero(vectors < 2)
    if not few:
        return []
    return [f"{few} of {len(vectors)} markers have fewer than two steps and no roughness"]

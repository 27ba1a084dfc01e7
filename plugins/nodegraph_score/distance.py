"""The distance of markers from where they should be, a row per frame."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np

from nodegraph import Columns, Truth, listed, node
from nodegraph_mocap import Table, Trajectories
from nodegraph_score.notes import with_notes
from nodegraph_tables import BetterEnd, TableInfo

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

UNITS = {
    "frame": "frame",
    "markers": "markers",
    "missing": "markers",
    "sum of squares": "mm^2",
    "rms": "mm",
    "mean": "mm",
    "max": "mm",
}
BETTER: dict[str, BetterEnd] = {"frame": "none", "markers": "higher"}
_FRAMES = 4096
"""Number of frames that are compared at a time."""


@node("score.distance")
def distance(
    estimate: Trajectories,
    reference: Truth[Trajectories],
    *,
    unit: Literal["mm", "none"] = "mm",
) -> Annotated[Table, Columns(*UNITS, "farthest")]:
    """Distance between two recordings, a row per frame.

    With ``d[m]`` the Euclidean distance between marker m of the estimate and marker m of the
    reference, over the n markers that both have in the frame:

    ============== ======================================================================
    frame          its index
    markers        how many markers are compared, n
    missing        how many of the markers that both recordings name are not, as one of them
                   lacks the sample
    sum of squares mm^2, S = sum of ``d[m]^2``: the squared Procrustes distance where the
                   estimate is aligned to the reference
    rms            mm, ``sqrt(S / n)``
    mean           mm, mean of ``d[m]``
    max            mm, largest ``d[m]``
    farthest       name of the marker that is so far off, the first of equals; empty where n = 0
    ============== ======================================================================

    Markers are matched by name, never by column. Those that only one of the two has are left
    out, counted and named in a warning and in the table's notes. A reference of one frame is
    compared with every frame of the estimate. In a frame in which nothing can be compared the
    numbers are NaN; as a sum over fewer markers is smaller, compare `rms` and not the sum
    where samples are missing.

    Parameters
    ----------
    estimate
        T frames.
    reference
        T frames, or one.
    unit
        The unit of coordinates: ``none`` for shapes that were scaled to one size.

    Raises
    ------
    ValueError
        If frame counts differ and the reference has more than one frame, no marker is in both, or
        a sum of squares is beyond all numbers.
    """
    if reference.frames not in (1, estimate.frames):
        raise ValueError(
            f"estimate has {estimate.frames} frames, the reference {reference.frames}: it must "
            "have as many, or one"
        )
    shared = tuple(name for name in estimate.markers if name in set(reference.markers))
    if not shared:
        raise ValueError(
            f"no marker is in both: estimate has {listed(estimate.markers)}, reference "
            f"{listed(reference.markers)}"
        )
    with np.errstate(over="raise"):
        try:
            apart = _apart(estimate, reference, shared)
            table = _table(apart, shared)
        except FloatingPointError:
            raise ValueError("distances are too large to be squared") from None
    notes = [*left_out(estimate, reference), *lacking(table, "markers", "frames")]
    units = {name: of for name, of in UNITS.items() if unit == "mm" or "mm" not in of}
    info = TableInfo("Distances", units=units, better=BETTER)
    return with_notes(table, notes, info, of=reference)


def _apart(
    estimate: Trajectories, reference: Trajectories, markers: tuple[str, ...]
) -> NDArray[np.float64]:
    """Return the distances of markers, frames x markers, without copies of hours of recordings."""
    mine = [estimate.markers.index(name) for name in markers]
    other = [reference.markers.index(name) for name in markers]
    apart = np.empty((len(markers), estimate.frames)).T
    for start in range(0, estimate.frames, _FRAMES):
        piece = slice(start, start + _FRAMES)
        to = reference.positions[piece if reference.frames > 1 else slice(None)]
        apart[piece] = np.linalg.norm(estimate.positions[piece][:, mine] - to[:, other], axis=2)
    return apart


def _table(apart: NDArray[np.float64], markers: tuple[str, ...]) -> Table:
    from pandas import DataFrame

    known = np.isfinite(apart)
    count = known.sum(axis=1)
    some = count > 0
    squared = np.where(
        some, np.square(apart, where=known, out=np.zeros_like(apart)).sum(axis=1), np.nan
    )
    sums = np.where(known, apart, 0.0).sum(axis=1)
    largest = np.where(known, apart, -1.0).argmax(axis=1)
    names = np.array([*markers, ""], dtype=object)
    return DataFrame(
        {
            "frame": np.arange(len(apart)),
            "markers": count,
            "missing": len(markers) - count,
            "sum of squares": squared,
            "rms": np.sqrt(squared / np.maximum(count, 1)),
            "mean": np.where(some, sums / np.maximum(count, 1), np.nan),
            "max": apart[np.arange(len(apart)), largest],
            "farthest": names[np.where(some, largest, -1)],
        }
    )


def left_out(
    estimate: Trajectories, reference: Trajectories, chosen: Iterable[str] = ()
) -> list[str]:
    """Return notes on markers that only one of the two has, but for some that were chosen."""
    notes = []
    for what, recording, other in (
        ("estimate", estimate, reference),
        ("reference", reference, estimate),
    ):
        absent = {*other.markers, *chosen}
        alone = [name for name in recording.markers if name not in absent]
        if alone:
            notes.append(f"{len(alone)} markers only the {what} has are left out: {listed(alone)}")
    return notes


def lacking(table: Table, compared: str, rows: str) -> list[str]:
    """Return a note on missing samples, if any; a column counts those that are compared."""
    missing, there = int(table["missing"].sum()), int(table[compared].sum())
    if not missing:
        return []
    empty = int((table[compared] == 0).sum())
    without = f"; {empty} of {len(table)} {rows} have none at all" if empty else ""
    return [f"{missing} of {missing + there} samples are missing and not compared{without}"]

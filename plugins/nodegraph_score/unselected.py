"""The error with which the selected markers predict the others, a row per marker not selected."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np

from nodegraph import Columns, Truth, listed, node
from nodegraph_mocap import Selection, Table, Trajectories
from nodegraph_score.distance import lacking, left_out
from nodegraph_score.notes import with_notes
from nodegraph_tables import TableInfo

if TYPE_CHECKING:
    from numpy.typing import NDArray

UNITS = {
    "markers": "markers",
    "frames": "frames",
    "missing": "frames",
    "rms": "mm",
    "mean": "mm",
    "max": "mm",
    "farthest": "frame",
}


@node("score.unselected")
def unselected(
    estimate: Trajectories, reference: Truth[Trajectories], selection: Selection
) -> Annotated[Table, Columns("marker", *UNITS)]:
    """Errors at the markers that a selection leaves out, a row per marker.

    The estimate is what the selected markers make of the whole face: for instance the recording
    that `blendshapes.pose` makes of the weights that `solve.weights` found from what
    `markers.keep` kept. At the selected markers it is near what it was made from; whether they
    suffice shows at the others. With ``d[t]`` the Euclidean distance between a marker in the
    estimate and in the reference in frame t, over the n frames in which both have it:

    ======== ============================================================================
    marker   its name
    markers  how many markers are selected
    frames   how many frames are compared, n
    missing  in how many frames the estimate or the reference lacks the sample
    rms      mm, ``sqrt(sum(d[t]^2) / n)``
    mean     mm, mean of ``d[t]``
    max      mm, largest ``d[t]``
    farthest the frame of this, the first of equals; -1 where n = 0
    ======== ============================================================================

    Markers are matched by name, never by column; those that only one of the two recordings has
    are left out, counted and named in a warning and in the table's notes. Where nothing can be
    compared the errors are NaN. Where every marker is selected there is no row, and a warning.
    In a curve over `markers`, a selection is a point, and its rows are repeats:
    `compare.curve` with ``x: markers, blocks: [marker]``.

    Parameters
    ----------
    estimate
        T frames of the whole face, as made from the selected markers.
    reference
        The same frames, as measured and aligned like the estimate.
    selection
        The markers from which the estimate was made.

    Returns
    -------
    Table
        As above, in the order of the reference's markers.

    Raises
    ------
    ValueError
        If frame counts differ, a selected marker is not in the reference, or no marker is in
        both recordings.
    """
    _check(estimate, reference, selection)
    scored = [name for name in reference.markers if name not in selection.chosen]
    shared = [name for name in scored if name in estimate.markers]
    apart = np.linalg.norm(
        estimate.keep(shared).positions - reference.keep(shared).positions, axis=2
    )
    table = _table(apart, shared, len(selection.chosen))
    notes = left_out(estimate, reference, selection.chosen)
    if not set(reference.markers) - set(selection.chosen):
        notes.append(f"all {len(reference.markers)} markers are selected, none is left to score")
    notes += lacking(table, "frames", "markers")
    info = TableInfo("Errors at unselected markers", units=UNITS)
    return with_notes(table, notes, info, of=reference)


def _check(estimate: Trajectories, reference: Trajectories, selection: Selection) -> None:
    if estimate.frames != reference.frames:
        raise ValueError(
            f"estimate has {estimate.frames} frames, the reference {reference.frames}: they must "
            "be of the same take"
        )
    unknown = [name for name in selection.chosen if name not in reference.markers]
    if unknown:
        raise ValueError(
            f"selected, but not in the reference: {listed(unknown)}; it has "
            f"{listed(reference.markers)}"
        )
    if not set(estimate.markers) & set(reference.markers):
        raise ValueError(
            f"no marker is in both: estimate has {listed(estimate.markers)}, reference "
            f"{listed(reference.markers)}"
        )


def _table(apart: NDArray[np.float64], markers: list[str], selected: int) -> Table:
    from pandas import DataFrame

    known = np.isfinite(apart)
    count = known.sum(axis=0)
    some = count > 0
    share = known / np.maximum(count, 1)
    present = np.where(known, apart, 0.0)
    # without any frame there is no largest one either
    farthest = np.where(known, apart, -1.0).argmax(axis=0) if len(apart) else np.zeros_like(count)
    return DataFrame(
        {
            "marker": np.array(markers, dtype=object),
            "markers": np.full(len(markers), selected),
            "frames": count,
            "missing": len(apart) - count,
            "rms": np.where(some, np.sqrt((share * present**2).sum(axis=0)), np.nan),
            "mean": np.where(some, (share * present).sum(axis=0), np.nan),
            "max": np.where(some, present.max(axis=0, initial=0.0), np.nan),
            "farthest": np.where(some, farthest, -1),
        }
    )

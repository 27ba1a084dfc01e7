"""The quality of tracks, a row per marker."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np

from nodegraph import Columns, Truth, node
from nodegraph_mocap import Table, Trajectories
from nodegraph_score.notes import with_notes
from nodegraph_tables import BetterEnd, TableInfo

if TYPE_CHECKING:
    from numpy.typing import NDArray

UNITS = {
    "samples": "frames",
    "links": "links",
    "wrong": "of 100,000 links",
    "right": "share",
    "switches": "count",
    "tracked": "share",
    "fragments": "count",
}
BETTER: dict[str, BetterEnd] = {
    "samples": "none",
    "links": "none",
    "right": "higher",
    "tracked": "higher",
}


@node("score.tracking", cite="bernardin2008")
def tracking(
    estimate: Trajectories, truth: Truth[Trajectories]
) -> Annotated[Table, Columns("marker", *UNITS)]:
    """Score of tracks against the markers that they should follow, a row per true marker.

    A marker's sample is tracked where a track has the very same position in that frame: a
    tracker gives the points as they came. A link joins two successive tracked samples of a
    marker, with or without frames between them. Identity switches are those of the CLEAR MOT
    metrics (Bernardin & Stiefelhagen, 2008); switches and fragments are counted as py-motmetrics
    counts ``num_switches`` and ``num_fragmentations``:

    ========= ============================================================================
    marker    its name
    samples   its present samples
    links     its links
    wrong     how many of 100,000 links have their two samples in two tracks; lower is better
    right     share of its links whose two samples are in the same track, ``1 - wrong / 100,000``
    switches  how often a tracked sample is in another track than the marker's last tracked
              one: its wrong links
    tracked   share of its present samples that a track has
    fragments how often it goes from tracked to present but not tracked, and is tracked
              again later
    ========= ============================================================================

    A sample that was dropped from the points counts as one that no track has: it lowers
    `tracked` and raises `fragments` for every tracker alike, and leaves the others. Compare
    trackers by `wrong`: few `switches` may also come from tracks that are lost. Where there is
    nothing to divide by, the value is NaN. Names are not compared.

    Parameters
    ----------
    estimate
        Tracks, T frames.
    truth
        The markers, T frames.

    Returns
    -------
    Table
        As above, in the order of the truth's markers.

    Raises
    ------
    ValueError
        If frame counts differ.
    """
    from pandas import DataFrame

    if estimate.frames != truth.frames:
        raise ValueError(f"estimate has {estimate.frames} frames, the truth has {truth.frames}")
    track = _tracks(estimate, truth)
    rows = [_row(track[truth.present[:, column], column]) for column in range(len(truth.markers))]
    table = DataFrame(rows, columns=list(UNITS))
    table.insert(0, "marker", np.array(truth.markers, dtype=object))
    info = TableInfo("Tracks", units=UNITS, better=BETTER)
    return with_notes(table, _notes(estimate, track), info, of=truth)


def _tracks(estimate: Trajectories, truth: Trajectories) -> NDArray[np.intp]:
    """Return which track has each sample of the truth, (T, M); -1 where none has."""
    mine, theirs = np.nonzero(truth.present), np.nonzero(estimate.present)
    owner = dict(zip(_samples(estimate, theirs), theirs[1].tolist(), strict=True))
    track = np.full(truth.origin.shape, -1)
    track[mine] = [owner.get(sample, -1) for sample in _samples(truth, mine)]
    return track


def _samples(recording: Trajectories, where: tuple[NDArray[np.intp], ...]) -> list[bytes]:
    """Return frame and position of samples as bytes, which are equal where the numbers are."""
    rows = np.column_stack([where[0], recording.positions[where]]) + 0.0  # -0 is 0
    samples: list[bytes] = rows.view(f"V{rows.itemsize * rows.shape[1]}").ravel().tolist()
    return samples


def _row(track: NDArray[np.intp]) -> tuple[float, ...]:
    """Return a marker's values; `track` is, for each present sample, the track that has it."""
    has = track >= 0
    followed = track[has]
    links = max(len(followed) - 1, 0)
    switches = int(np.count_nonzero(followed[1:] != followed[:-1]))
    lost = int(np.count_nonzero(has[:-1] & ~has[1:]))
    # The last loss is not a fragment where no track finds the marker again.
    final = int(has.any() and not has[-1])
    return (
        len(track),
        links,
        100_000.0 * switches / links if links else np.nan,
        1.0 - switches / links if links else np.nan,
        switches,
        float(has.mean()) if len(track) else np.nan,
        lost - final,
    )


def _notes(estimate: Trajectories, track: NDArray[np.intp]) -> list[str]:
    extra = np.count_nonzero(estimate.present) - np.count_nonzero(track >= 0)
    if extra <= 0:
        return []
    return [
        f"{extra} of {np.count_nonzero(estimate.present)} samples in tracks are not samples of the "
        "truth: ghosts, or moved points"
    ]

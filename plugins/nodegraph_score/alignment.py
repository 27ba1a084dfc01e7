"""Principal components of a recording as the movement of the head, or that of the face."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import Across, Refusal, Truth, node
from nodegraph_mocap import HeadMotion, Table, Trajectories
from nodegraph_score.alignment_answer import FACE, HEAD, answer_of, left_out
from nodegraph_score.components import (
    Components,
    Movement,
    by_chance,
    explained,
    movement,
    principal,
)
from nodegraph_score.notes import with_notes
from nodegraph_score.pose import NAMES, carried, check_proper, left_over, pose
from nodegraph_tables import TableInfo

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from nodegraph import Label

UNITS = {"share": "share", "sd": "mm", "head motion": "share", "in all": "share"}
CHANCE = 95.0
"""Percentile of what foreign head motion explains."""

HALF = 0.5
"""Share of a component above which it is called head motion."""

_DECIMALS = 9
COLUMNS = (
    "component", "share", "sd", "head motion", "finds", "in all", "R", "by chance",
    "correlation", "with",
)  # fmt: skip


@node("score.alignment", cite="krzanowski2000")
def alignment(
    recordings: Across[Trajectories],
    head_motion: Truth[HeadMotion],
    removed: Across[HeadMotion] | None = None,
    *,
    components: Annotated[int, Field(ge=1)] = 5,
) -> Table:
    """Say what PCA finds in recordings, head motion or the face: a row per principal component.

    PCA is that of the covariance of the 3 M coordinates, over the complete frames. A column for
    each gathered axis says which recording it is; with u the scores of a component:

    =========== ==========================================================================
    component   its rank; PCA finds 1 first
    share       of the variance of the recording that it has
    sd          mm, standard deviation of u
    head motion share of it that head motion makes, ``cov(u, h) / var(u)``, with h the scores of
                the mean face carried along by the head motion that is in the recording; the
                rest, to 1, is the face's. Below 0 where the two work against each other
    finds       ``head motion`` where that is more than 1/2, else ``face``
    in all      share of the variance of the whole recording that head motion makes, all
                components together; the same in every row of a recording. Less is better
    R           multiple correlation of u with six numbers per frame: the rotation vector (turn
                about x, y and z, from the mean rotation) and the translation (shift)
    by chance   R of head motion that does not belong to it: the 95th percentile over the same
                motion shifted in time, around the end, by a tenth of the take and more
    correlation of u with the one of the six with which it is largest, without its sign
    with        which one that is
    =========== ==========================================================================

    R says what goes with the head, not what the head makes: somebody who nods with every word
    has an R near 1 however well the head is held still. In a short take six slow curves also
    explain much of any other slow curve: compare R with `by chance`. Where the head does not
    move, or there are so few frames that six numbers explain anything, R and the three columns
    behind it say nothing, and there is a warning.

    Frames that lack a sample are left out; they, and recordings that cannot be judged, are
    counted in a warning and in the table's notes.

    Parameters
    ----------
    recordings
        T frames, aligned or not; a set of scans is a recording of one frame per scan.
    head_motion
        T frames: where the head was when it was recorded, as it is known, or as an alignment
        found it: then that alignment is taken for the truth.
    removed
        T frames: what an alignment has taken out of each recording, its `head_motion`, with the
        same labels. Left open: all recordings are as they were captured.
    components
        Upper limit for each recording; fewer where fewer have variance.

    Returns
    -------
    Table
        As above; its answer says what the components are.

    Raises
    ------
    Refusal
        If no recording has two complete frames in which something moves.
    ValueError
        If frame counts differ, a recording has not one `removed`, a rotation is a mirror image,
        or an axis is named like a column.
    """
    from pandas import concat

    _check(recordings, head_motion)
    numbers = pose(head_motion)
    parts: list[Table] = []
    notes: list[str] = []
    for (labels, recording), name in zip(recordings, recordings.names(), strict=True):
        there = left_over(head_motion, _removed(name, labels, recording, removed))
        complete = np.asarray(recording.present.all(axis=1))
        pca = principal(recording.positions[complete])
        moved = movement(numbers[complete])
        notes += [f"{name}: {note}" if name else note for note in left_out(recording, pca, moved)]
        if len(pca.sd):
            head = carried(recording.positions[complete], there[complete])
            parts.append(_table(labels, pca, moved, pca.part_of(head), components))
    if not parts:
        raise Refusal("; ".join(notes) or "there is no recording")
    info = TableInfo("What PCA finds", answer_of(parts, recordings.axes), units=UNITS)
    table = concat(parts, ignore_index=True)
    return with_notes(table, notes, info, of=recordings.values()[0])


def _removed(
    name: str,
    labels: Mapping[str, Label],
    recording: Trajectories,
    removed: Across[HeadMotion] | None,
) -> HeadMotion:
    """Return the motion that was taken out of a recording; a still head's without any."""
    if removed is None:
        return HeadMotion.still(recording.frames)
    matches = [
        motion
        for at, motion in removed
        if all(labels.get(axis, at[axis]) == at[axis] for axis in at)
    ]
    of = f"recording {name}" if name else "the recording"
    if len(matches) != 1:
        raise ValueError(f"{of} has {len(matches)} head motions that were removed, not one")
    if matches[0].frames != recording.frames:
        raise ValueError(
            f"{of} has {recording.frames} frames, the head motion removed {matches[0].frames}"
        )
    check_proper(f"removed of {of}", matches[0])
    return matches[0]


def _table(
    labels: Mapping[str, Label],
    pca: Components,
    moved: Movement,
    head: NDArray[np.float64],
    components: int,
) -> Table:
    """Return the rows of one recording."""
    from pandas import DataFrame

    kept = slice(min(components, len(pca.sd)))
    shares = pca.shares
    columns = {
        "component": np.arange(1, 1 + len(shares[kept])),
        "share": shares[kept],
        "sd": pca.sd[kept],
        "head motion": _rounded(head[kept]),
        "finds": np.where(head[kept] > HALF, HEAD, FACE).astype(object),
        "in all": float(_rounded(shares @ head)),
        **_related(pca.scores[:, kept], moved),
    }
    rows = len(shares[kept])
    return DataFrame({axis: [label] * rows for axis, label in labels.items()} | columns)


def _rounded(shares: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return shares without rounding errors, which would be shown as if they were small shares."""
    return np.asarray(np.round(shares, _DECIMALS) + 0.0)


def _related(scores: NDArray[np.float64], moved: Movement) -> dict[str, object]:
    """Return how (n, K) scores go with the head."""
    if not moved.conclusive:
        return dict.fromkeys(("R", "by chance", "correlation"), np.nan) | {"with": ""}
    single = np.abs(moved.curves.T @ scores)
    chance = np.percentile(by_chance(scores, moved), CHANCE, axis=0)
    return {
        "R": np.sqrt(explained(scores, moved)),
        "by chance": np.sqrt(chance),
        "correlation": np.minimum(single.max(axis=0), 1.0),
        "with": np.array(NAMES, dtype=object)[moved.columns[single.argmax(axis=0)]],
    }


def _check(recordings: Across[Trajectories], head_motion: HeadMotion) -> None:
    for recording, name in zip(recordings.values(), recordings.names(), strict=True):
        if recording.frames != head_motion.frames:
            what = f"recording {name}" if name else "the recording"
            raise ValueError(
                f"{what} has {recording.frames} frames, the head motion {head_motion.frames}"
            )
    taken = [axis for axis in recordings.axes if axis in COLUMNS]
    if taken:
        raise ValueError(
            f"an axis cannot be called {', '.join(taken)}, as a column of the table is"
        )

"""Unlabelled points made from a recording, whose truth is known."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, NamedTuple

import numpy as np
from pydantic import Field

from nodegraph import Truth, Unit, node
from nodegraph_mocap import Detections, Trajectories
from nodegraph_mocap.random_numbers import Seed, random_for
from nodegraph_mocap.truth import truth_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

GHOST_MARGIN = 0.1
"""Room for ghosts on each side of the box around a frame's points, as a share of its size."""


class Scattered(NamedTuple):
    """Points without names, and whose they were.

    Attributes
    ----------
    detections : Detections
        The points that were kept, and ghosts, in random order within each frame.
    truth : Trajectories
        The recording that errors are measured to: the truth that was put in, else the recording as
        it came.
    """

    detections: Detections
    truth: Truth[Trajectories]


@node("points.scatter")
def scatter(
    recording: Trajectories,
    truth: Truth[Trajectories] | None = None,
    *,
    dropout: Annotated[float, Field(ge=0.0, lt=1.0), Unit("share")] = 0.0,
    ghosts: Annotated[float, Field(ge=0.0), Unit("share")] = 0.0,
    seed: Seed = 0,
) -> Scattered:
    """Take the names off a recording's points, drop some, add ghosts, shuffle each frame.

    Dropped samples are drawn among all present ones; their number is exact to one. Ghosts are
    spread over the frames that have a point, uniformly in time and, within a frame, uniformly
    in the box around its points, grown by a tenth of its size on each side. Which samples are
    dropped, the order and the ghosts are drawn from separate streams of the seed: another share
    of one does not change the others, and with a larger share what was dropped stays dropped.

    Parameters
    ----------
    recording
        Trajectories, with or without gaps.
    truth
        The recording that errors are measured to, the same frames and markers without noise;
        `recording` itself if left open. It has no influence on what is dropped or added.
    dropout
        Share of the present samples that are dropped.
    ghosts
        Ghosts per present sample of the recording: 0.01 adds one where there are a hundred.
    seed
        Same seed and recording, same points. A list, such as ``[$trial, $recording]`` in a
        graph, is another seed for each recording.

    Raises
    ------
    ValueError
        If the frames, rate or markers of `truth` are not those of the recording.
    """
    frame, marker = np.nonzero(recording.present)
    kept = np.ones(len(frame), dtype=np.bool_)
    kept[random_for("dropout", seed).permutation(len(frame))[: round(dropout * len(frame))]] = False
    points = recording.positions[frame[kept], marker[kept]]
    when, where = _ghosts(recording, round(ghosts * len(frame)), random_for("ghosts", seed))
    return Scattered(
        _shuffled(
            np.concatenate([frame[kept], when]),
            np.concatenate([points, where]),
            recording,
            random_for("order", seed),
        ),
        truth_of(recording, truth),
    )


def _ghosts(
    recording: Trajectories, count: int, random: np.random.Generator
) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Return the frame, (count,), and the place, (count, 3), of each ghost."""
    seen = np.flatnonzero(recording.present.any(axis=1))
    if not count:
        return np.empty(0, dtype=np.intp), np.empty((0, 3))
    drawn = random.random((count, 4))
    frame = seen[(drawn[:, 0] * len(seen)).astype(np.intp)]
    low = np.nanmin(recording.positions[frame], axis=1)
    high = np.nanmax(recording.positions[frame], axis=1)
    return frame, low + (high - low) * (drawn[:, 1:] * (1.0 + 2.0 * GHOST_MARGIN) - GHOST_MARGIN)


def _shuffled(
    frame: NDArray[np.intp],
    points: NDArray[np.float64],
    recording: Trajectories,
    random: np.random.Generator,
) -> Detections:
    order = np.lexsort((random.random(len(frame)), frame))
    counts = np.bincount(frame, minlength=recording.frames)
    return Detections(
        points=points[order],
        offsets=np.concatenate([[0], np.cumsum(counts)]),
        rate=recording.rate,
    )

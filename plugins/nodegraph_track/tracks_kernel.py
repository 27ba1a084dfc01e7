"""Open tracks from frame to frame, compiled: import this module only when a tracker runs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Integers = NDArray[np.intp]


@kernel("owner")
def next_tracks(
    tracks: Any,
    predicted: Floats,
    of_track: Integers,
    points: Floats,
    frame: int,
    patience: int,
    shortest: int,
    is_known: bool,
    owner: Integers,
) -> tuple[Integers, Floats, Floats, Floats, Floats, Integers, Integers, int]:
    """Return the open tracks after a frame, and write the owner of each point.

    Parameters
    ----------
    tracks
        See `nodegraph_track.follow.OpenTracks`.
    predicted : (A, 3) array of float64
    of_track : (A,) array of int
        See `nodegraph_track.follow.Links`.
    points : (P, 3) array of float64
    frame, patience, shortest
        Number of the frame, and the tracker's settings; see `nodegraph_track.follow.follow`.
    is_known
        Whether no point opens another track.
    owner : (P,) array of int
        Written: the name of the track that has each point, -1 for none.
    """
    of_point = _inverse(of_track, len(points))
    most = len(of_track) + (0 if is_known else len(points))
    name, seen, length = np.empty(most, np.int64), np.empty(most, np.int64), np.ones(most, np.int64)
    place, last, jump = np.empty((most, 3)), np.empty((most, 3)), np.zeros((most, 3))
    steps, size, opened = np.zeros((most, 3, 3)), 0, tracks.opened
    for row in range(len(of_track)):
        absent = frame - tracks.seen[row]
        if of_track[row] < 0 and (absent > patience or tracks.length[row] < shortest):
            continue
        linked = of_track[row] >= 0
        name[size], length[size] = tracks.name[row], tracks.length[row] + linked
        seen[size] = frame if linked else tracks.seen[row]
        for axis in range(3):
            if linked:
                here = points[of_track[row], axis]
                place[size, axis], last[size, axis] = here, here
                jump[size, axis] = here - tracks.last[row, axis]
                steps[size, 0, axis] = jump[size, axis] / absent
            else:
                place[size, axis] = predicted[row, axis]
                last[size, axis] = tracks.last[row, axis]
                jump[size, axis] = tracks.jump[row, axis]
                steps[size, 0, axis] = tracks.steps[row, 0, axis]
            for step in range(1, 3):
                steps[size, step, axis] = tracks.steps[row, step - linked, axis]
        size += 1
    for column in range(len(points)):
        if of_point[column] >= 0 or is_known:
            owner[column] = tracks.name[of_point[column]] if of_point[column] >= 0 else -1
            continue
        owner[column] = name[size] = opened
        seen[size], opened = frame, opened + 1
        for axis in range(3):
            place[size, axis] = last[size, axis] = points[column, axis]
        size += 1
    return (
        name[:size],
        place[:size],
        last[:size],
        jump[:size],
        steps[:size],
        seen[:size],
        length[:size],
        opened,
    )


@kernel(no_cpython_wrapper=True)
def _inverse(of_track: Integers, points: int) -> Integers:
    """Return the track of each point, -1 for none."""
    of_point = np.full(points, -1)
    for row in range(len(of_track)):
        if of_track[row] >= 0:
            of_point[of_track[row]] = row
    return of_point


@kernel()
def in_order(points: Floats) -> Floats:
    """Return the points of a frame by x, then y, then z, as they often are already."""
    result = points.copy()
    for row in range(1, len(result)):
        x, y, z = result[row]
        free = row
        while free > 0 and (
            result[free - 1, 0] > x
            or (
                result[free - 1, 0] == x
                and (
                    result[free - 1, 1] > y
                    or (result[free - 1, 1] == y and result[free - 1, 2] > z)
                )
            )
        ):
            for axis in range(3):
                result[free, axis] = result[free - 1, axis]
            free -= 1
        result[free, 0], result[free, 1], result[free, 2] = x, y, z
    return result


@kernel("positions", "origin")
def place(
    points: Floats, owner: Integers, positions: Floats, origin: NDArray[np.uint8], measured: int
) -> None:
    """Write points where their owners are, and that they are measured."""
    for column in range(len(points)):
        row = owner[column]
        if row >= 0:
            origin[row] = measured
            for axis in range(3):
                positions[row, axis] = points[column, axis]

"""Open tracks from frame to frame, compiled: import this module only when a tracker runs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Integers = NDArray[np.intp]

compiled = kernel()


@compiled
def next_tracks(
    tracks: Any,
    links: Any,
    points: Floats,
    frame: int,
    patience: int,
    shortest: int,
    owner: Integers,
) -> tuple[Integers, Floats, Floats, Floats, Floats, Integers, Integers, int]:
    """Return the open tracks after a frame, and write the owner of each point.

    Parameters
    ----------
    tracks, links
        See `nodegraph_track.follow.OpenTracks` and `Links`.
    points : (P, 3) array of float64
    frame, patience, shortest
        Which frame it is; see `nodegraph_track.follow.follow`.
    owner : (P,) array of int
        Written: the name of the track that has each point.
    """
    taken, of_point = _both_ways(links, len(tracks.name), len(points))
    most = len(taken) + len(points) - len(links.track)
    name, seen, length = np.empty(most, np.int64), np.empty(most, np.int64), np.ones(most, np.int64)
    place, last, jump = np.empty((most, 3)), np.empty((most, 3)), np.zeros((most, 3))
    steps, size, opened = np.zeros((most, 3, 3)), 0, tracks.opened
    for row in range(len(taken)):
        absent = frame - tracks.seen[row]
        if taken[row] < 0 and (absent > patience or tracks.length[row] < shortest):
            continue
        linked = taken[row] >= 0
        name[size], length[size] = tracks.name[row], tracks.length[row] + linked
        seen[size] = frame if linked else tracks.seen[row]
        for axis in range(3):
            if linked:
                here = points[taken[row], axis]
                place[size, axis], last[size, axis] = here, here
                jump[size, axis] = here - tracks.last[row, axis]
                steps[size, 0, axis] = jump[size, axis] / absent
            else:
                place[size, axis] = links.predicted[row, axis]
                last[size, axis] = tracks.last[row, axis]
                jump[size, axis] = tracks.jump[row, axis]
                steps[size, 0, axis] = tracks.steps[row, 0, axis]
            for step in range(1, 3):
                steps[size, step, axis] = tracks.steps[row, step - linked, axis]
        size += 1
    for column in range(len(points)):
        owner[column] = opened if of_point[column] < 0 else tracks.name[of_point[column]]
        if of_point[column] < 0:
            name[size], seen[size], opened = opened, frame, opened + 1
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


@compiled
def _both_ways(links: Any, tracks: int, points: int) -> tuple[Integers, Integers]:
    """Return the point of each track, and the track of each point; -1 for none."""
    taken, of_point = np.full(tracks, -1), np.full(points, -1)
    for link in range(len(links.track)):
        taken[links.track[link]] = links.point[link]
        of_point[links.point[link]] = links.track[link]
    return taken, of_point

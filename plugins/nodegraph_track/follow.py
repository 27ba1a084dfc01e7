"""What the trackers share: open tracks, carried from frame to frame.

A track is opened by a point that no track takes. A method predicts where the open tracks are in
a frame and links them to the frame's points. A track that gets none stays open for `patience`
frames, and is linked again when a point falls into its gate; but one that has fewer than
`shortest` points yet ends at once, so that a ghost does not lie in wait for a marker. Tracks
that end with fewer than `shortest` points are dropped as ghosts.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple, Protocol

import numpy as np
from pydantic import Field

from nodegraph import Refusal, Unit
from nodegraph_mocap import Detections, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

Gate = Annotated[float, Field(gt=0.0), Unit("mm")] | None
Patience = Annotated[int, Field(ge=0), Unit("frames")]
Shortest = Annotated[int, Field(ge=1), Unit("frames")]


def lookahead(settings: Mapping[str, Any]) -> int | None:
    """Return the look-ahead of a tracker: what makes a point a ghost lies ahead of it."""
    # a gate that is not set is made from points of the whole take
    return None if settings["gate"] is None else int(settings["shortest"]) - 1


class OpenTracks(NamedTuple):
    """The tracks that may take a point of the next frame, in the order of their names.

    Attributes
    ----------
    name : (A,) array of int
    place : (A, 3) array of float64
        Where the track is thought to be in the frame before; its point, if it had one there.
    last : (A, 3) array of float64
        Its last point.
    jump : (A, 3) array of float64
        mm from its last point but one to its last point; 0 where it has one only.
    steps : (A, 3, 3) array of float64
        mm per frame between its last points, the last step first; 0 where it has fewer points.
    seen : (A,) array of int
        The frame of its last point.
    length : (A,) array of int
        How many points it has.
    opened : int
        How many tracks there have been, open or not: the name of the next one.
    """

    name: NDArray[np.intp]
    place: NDArray[np.float64]
    last: NDArray[np.float64]
    jump: NDArray[np.float64]
    steps: NDArray[np.float64]
    seen: NDArray[np.intp]
    length: NDArray[np.intp]
    opened: int

    def led_by_velocity(self, frame: int, fade: float) -> NDArray[np.float64]:
        """Return where velocity leads each track in a frame, (A, 3).

        The velocity is the median of the last three steps, coordinate by coordinate: one point
        gone astray does not change it. It is multiplied by `fade` for every frame without a point.
        """
        from nodegraph_track import motion_kernel

        absent = frame - 1 - self.seen
        carried = motion_kernel.carried_by_velocity(self.place, self.steps, absent, fade)
        return np.asarray(carried)


NO_TRACKS = OpenTracks(
    np.empty(0, np.intp),
    np.empty((0, 3)),
    np.empty((0, 3)),
    np.empty((0, 3)),
    np.empty((0, 3, 3)),
    np.empty(0, np.intp),
    np.empty(0, np.intp),
    0,
)


class Links(NamedTuple):
    """What a method says of one frame.

    Attributes
    ----------
    predicted : (A, 3) array of float64
        Where each open track is, if it gets no point.
    track, point : (L,) arrays of int
        Which open track takes which point of the frame; none twice.
    """

    predicted: NDArray[np.float64]
    track: NDArray[np.intp]
    point: NDArray[np.intp]


class Method(Protocol):
    """Links the open tracks to a frame's points, (P, 3) in the order of x, within a gate in mm."""

    def __call__(
        self, tracks: OpenTracks, points: NDArray[np.float64], frame: int, gate: float
    ) -> Links:
        """Return the links."""


def follow(
    detections: Detections, method: Method, *, gate: float | None, patience: int, shortest: int
) -> Trajectories:
    """Follow points through time by a method, and warn of what is dropped; called by a node.

    Parameters
    ----------
    detections
        Unlabelled points.
    method
        How a frame's points are linked to the open tracks.
    gate
        Millimetres; None: `default_gate`.
    patience
        Frames that a track stays open without a point.
    shortest
        Tracks of fewer points are dropped; never more than the take has frames.

    Returns
    -------
    Trajectories
        Tracks ``t000``, ``t001``, ... in the order of their first points; those of one frame by
        x, then y, then z.

    Raises
    ------
    Refusal
        If there is no point at all.
    """
    if not len(detections.points):
        raise Refusal("needs at least one point; no frame has any")
    shortest = min(shortest, detections.frames)
    offsets, frame = (
        detections.offsets,
        np.repeat(np.arange(detections.frames), np.diff(detections.offsets)),
    )
    # In an order of their own, so that nothing hangs on the order in which they came, and by x
    # first, by which the links are searched.
    points = detections.points[_order(detections.points, frame)]
    width = default_gate(points, offsets) if gate is None else gate
    owner = _owners(points, offsets, method, width, patience, shortest)
    return _trajectories(points, frame, owner, detections, shortest)


def default_gate(points: NDArray[np.float64], offsets: NDArray[np.int64]) -> float:
    """Return half the median distance from a point to the nearest one of the same frame.

    A point nearer than that to where a marker is expected is likelier the marker's own than its
    neighbour's. Up to 200 frames are looked at, evenly spread over the take. Infinite where no
    frame has two points in different places: there is nothing to confuse.

    Parameters
    ----------
    points : (N, 3) array of float64
        Frame after frame, those of a frame in the order of x.
    offsets : (T + 1,) array of int
        The points of frame t are ``points[offsets[t]:offsets[t + 1]]``.
    """
    from nodegraph_track import linking_kernel

    chosen = np.unique(np.linspace(0, len(offsets) - 2, 200).astype(np.intp))
    apart = linking_kernel.spaces(points, offsets, chosen)
    apart = apart[apart > 0]
    return float(np.median(apart)) / 2.0 if len(apart) else np.inf


def _order(points: NDArray[np.float64], frame: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the order by frame, then x, y, z; y and z are looked at only where x is equal."""
    # Complex numbers are sorted by their real part, then the other: faster than two sorts.
    order = np.argsort(frame + 1j * points[:, 0])
    equal = (np.diff(points[order, 0]) == 0) & (np.diff(frame) == 0)
    return np.lexsort((*points.T[::-1], frame)) if equal.any() else order


def _owners(
    points: NDArray[np.float64],
    offsets: NDArray[np.int64],
    method: Method,
    gate: float,
    patience: int,
    shortest: int,
) -> NDArray[np.intp]:
    """Return the number of each point's track, (N,)."""
    from nodegraph_track import tracks_kernel

    owner, tracks = np.empty(len(points), dtype=np.intp), NO_TRACKS
    for frame in range(len(offsets) - 1):
        begin, end = offsets[frame], offsets[frame + 1]
        here, mine = points[begin:end], owner[begin:end]
        links = method(tracks, here, frame, gate)
        state = tracks_kernel.next_tracks(tracks, links, here, frame, patience, shortest, mine)
        tracks = OpenTracks(*state)
    return owner


def _trajectories(
    points: NDArray[np.float64],
    frame: NDArray[np.intp],
    owner: NDArray[np.intp],
    detections: Detections,
    shortest: int,
) -> Trajectories:
    counts = np.bincount(owner)
    long = counts >= shortest
    if not long.all():
        warnings.warn(
            f"{np.count_nonzero(~long)} of {len(long)} tracks have fewer than {shortest} points "
            f"and were dropped as ghosts, {counts[~long].sum()} of {len(points)} points in all",
            stacklevel=4,
        )
    kept, column = long[owner], np.cumsum(long) - 1
    positions = np.full((detections.frames, np.count_nonzero(long), 3), np.nan)
    positions[frame[kept], column[owner[kept]]] = points[kept]
    names = tuple(f"t{index:03d}" for index in range(positions.shape[1]))
    return Trajectories(positions=positions, markers=names, rate=detections.rate)

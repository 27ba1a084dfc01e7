"""What the trackers share: open tracks, carried from frame to frame.

A track is opened by a point that no track takes. A method predicts where the open tracks are in
a frame and links them to the frame's points. A track that gets none stays open for `patience`
frames, and is linked again when a point falls into its gate; but one that has fewer than
`shortest` points yet ends at once, so that a ghost does not lie in wait for a marker. Tracks
that end with fewer than `shortest` points are dropped as ghosts.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Protocol

import numpy as np
from pydantic import Field

from nodegraph import Refusal, Unit
from nodegraph_mocap import Detections, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

Gate = Annotated[float, Field(gt=0.0), Unit("mm")] | None
Patience = Annotated[int, Field(ge=0), Unit("frames")]
Shortest = Annotated[int, Field(ge=1), Unit("frames")]


@dataclass(frozen=True)
class OpenTracks:
    """The tracks that may take a point of the next frame, in the order of their names.

    Attributes
    ----------
    name : (A,) array of int
    place : (A, 3) array of float64
        Where the track is thought to be in the frame before; its point, if it had one there.
    last : (A, 3) array of float64
        Its last point.
    steps : (A, 3, 3) array of float64
        mm per frame between its last points, the last step first; 0 where it has fewer points.
    seen : (A,) array of int
        The frame of its last point.
    count : (A,) array of int
        How many points it has.
    """

    name: NDArray[np.intp]
    place: NDArray[np.float64]
    last: NDArray[np.float64]
    steps: NDArray[np.float64]
    seen: NDArray[np.intp]
    count: NDArray[np.intp]

    @property
    def velocity(self) -> NDArray[np.float64]:
        """(A, 3), the median of the last three steps: one point gone astray does not change it."""
        from nodegraph_track import linking_kernel

        return np.asarray(linking_kernel.median_steps(self.steps))

    @staticmethod
    def born(names: NDArray[np.intp], points: NDArray[np.float64], frame: int) -> OpenTracks:
        """Return new tracks, one per point of a frame."""
        size = len(points)
        return OpenTracks(
            names,
            points,
            points,
            np.zeros((size, 3, 3)),
            np.full(size, frame),
            np.ones(size, np.intp),
        )

    def moved(self, links: Links, points: NDArray[np.float64], frame: int) -> OpenTracks:
        """Return the tracks after a frame."""
        from nodegraph_track import linking_kernel

        state = links.predicted, self.last, self.steps, self.seen, self.count
        here = points[links.point]
        return OpenTracks(self.name, *linking_kernel.carried(*state, links.track, here, frame))

    def where(self, chosen: NDArray[np.bool_]) -> OpenTracks:
        """Return some of the tracks."""
        return self if chosen.all() else OpenTracks(*(part[chosen] for part in self._parts()))

    def and_also(self, others: OpenTracks) -> OpenTracks:
        """Return the tracks and others behind them."""
        pairs = zip(self._parts(), others._parts(), strict=True)
        return OpenTracks(*(np.concatenate(pair) for pair in pairs))

    def _parts(self) -> tuple[NDArray[Any], ...]:
        return self.name, self.place, self.last, self.steps, self.seen, self.count


@dataclass(frozen=True)
class Links:
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
    frame = np.repeat(np.arange(detections.frames), np.diff(detections.offsets))
    # In an order of their own, so that nothing hangs on the order in which they came, and by x
    # first, by which the links are searched.
    points = detections.points[_order(detections.points, frame)]
    width = default_gate(detections) if gate is None else gate
    owner = _owners(points, detections.offsets, method, width, patience, shortest)
    return _trajectories(points, frame, owner, detections, shortest)


def default_gate(detections: Detections) -> float:
    """Return half the median distance from a point to the nearest one of the same frame.

    A point nearer than that to where a marker is expected is likelier the marker's own than its
    neighbour's. Up to 200 frames are looked at, evenly spread over the take. Infinite where no
    frame has two points in different places: there is nothing to confuse.
    """
    from scipy.spatial import KDTree

    chosen = np.unique(np.linspace(0, detections.frames - 1, 200).astype(np.intp))
    found = [np.empty(0)]
    for frame in chosen:
        points = detections.points[detections.offsets[frame] : detections.offsets[frame + 1]]
        if len(points) > 1:
            found.append(np.asarray(KDTree(points).query(points, k=2)[0])[:, 1])
    apart = np.concatenate(found)
    apart = apart[apart > 0]
    return float(np.median(apart)) / 2.0 if len(apart) else np.inf


def _order(points: NDArray[np.float64], frame: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the order by frame, then x, y, z; y and z are looked at only where x is equal."""
    order = np.lexsort((points[:, 0], frame))
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
    owner = np.empty(len(points), dtype=np.intp)
    tracks, opened = OpenTracks.born(np.empty(0, np.intp), np.empty((0, 3)), 0), 0
    for frame in range(len(offsets) - 1):
        begin, end = offsets[frame], offsets[frame + 1]
        here, mine = points[begin:end], owner[begin:end]
        links = method(tracks, here, frame, gate)
        mine[:] = -1
        mine[links.point] = tracks.name[links.track]
        tracks = tracks.moved(links, here, frame)
        absent = frame - tracks.seen
        tracks = tracks.where((absent == 0) | ((absent <= patience) & (tracks.count >= shortest)))
        new = np.flatnonzero(mine < 0)
        if len(new):
            mine[new] = np.arange(opened, opened + len(new))
            tracks = tracks.and_also(OpenTracks.born(mine[new], here[new], frame))
            opened += len(new)
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

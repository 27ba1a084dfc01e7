"""Shared by the trackers: open tracks, carried from frame to frame.

A track is opened by a point that no track takes. A method predicts where the open tracks are in
a frame and links them to the frame's points. A track that gets none stays open for `patience`
frames, and is linked again when a point falls into its gate; but one that has fewer than
`shortest` points yet ends at once, so that a ghost does not lie in wait for a marker. Tracks
that end with fewer than `shortest` points are dropped as ghosts.

With a reference, the tracks are its markers: they are open from the first frame to the last, from
where the reference has them, and no point opens another. So a stream can be followed, too.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Mapping
from dataclasses import KW_ONLY, dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple, Protocol

import numpy as np
from pydantic import Field

from nodegraph import Refusal, StateForm, Unit, listed
from nodegraph_mocap import Detections, MarkerFrame, Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class TrackingInput:
    """Points to follow, and the settings of every tracker.

    Attributes
    ----------
    detections
        Unlabelled points.
    reference
        A recording whose markers are to be followed, from where they are in its first frame that
        has all of them: `patience` and `shortest` then play no part, and points of no marker are
        left out, counted in a warning. None: tracks are opened by points.
    gate
        How far from where it is expected a track finds a point. None: half the median distance
        from a point to the nearest one of the same frame, in 200 frames of the take.
    patience
        How many frames a track stays open without a point.
    shortest
        Tracks of fewer points are dropped as ghosts, and counted in a warning. Never more than
        the take has frames.

    Returns
    -------
    Trajectories
        The tracks; every sample is a point of that frame, and no point is used twice.
    """

    detections: Detections
    reference: Trajectories | None = None
    _: KW_ONLY
    gate: Annotated[float, Field(gt=0.0), Unit("mm")] | None = None
    patience: Annotated[int, Field(ge=0), Unit("frames")] = 60
    shortest: Annotated[int, Field(ge=1), Unit("frames")] = 3


_MISSING, _MEASURED = int(Origin.MISSING), int(Origin.MEASURED)


def lookahead(settings: Mapping[str, Any]) -> int | None:
    """Return the look-ahead of a tracker: later frames decide whether a point is a ghost."""
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
        from nodegraph_track import linking_kernel

        absent = frame - 1 - self.seen
        carried = linking_kernel.carried_by_velocity(self.place, self.steps, absent, fade)
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
    """The links that a method makes in one frame.

    Attributes
    ----------
    predicted : (A, 3) array of float64
        Where each open track is, if it gets no point.
    point : (A,) array of int
        The point of the frame that each open track takes, none twice; -1 for none.
    """

    predicted: NDArray[np.float64]
    point: NDArray[np.intp]


class LinkMethod(Protocol):
    """Links the open tracks to a frame's points, (P, 3) in the order of x, within a gate in mm."""

    def __call__(
        self, tracks: OpenTracks, points: NDArray[np.float64], frame: int, gate: float
    ) -> Links:
        """Return the links."""


def follow(given: TrackingInput, method: LinkMethod) -> Trajectories:
    """Follow points through time by a method, and warn of what is dropped; called by a node.

    Parameters
    ----------
    given
        The points and the settings of the node.
    method
        How a frame's points are linked to the open tracks.

    Returns
    -------
    Trajectories
        Tracks ``t000``, ``t001``, ... in the order of their first points; those of one frame by
        x, then y, then z; or the markers of the reference.

    Raises
    ------
    Refusal
        If there is no point at all, or no frame of the reference has all its markers.
    """
    detections, reference = given.detections, given.reference
    if not len(detections.points):
        raise Refusal("needs at least one point; no frame has any")
    shortest = min(given.shortest, detections.frames)
    offsets, frame = (
        detections.offsets,
        np.repeat(np.arange(detections.frames), np.diff(detections.offsets)),
    )
    # In an order of their own, so that nothing hangs on the order in which they came, and by x
    # first, by which the links are searched.
    points = detections.points[_order(detections.points, frame)]
    width = default_gate(points, offsets) if given.gate is None else given.gate
    if reference is None:
        tracker = _Tracker(method, width, given.patience, shortest)
    else:
        tracker = _Tracker.of(reference, method, width)
    owner = np.empty(len(points), dtype=np.intp)
    for begin, end in pairwise(offsets):
        tracker.link(points[begin:end], owner[begin:end])
    if reference is not None:
        return _known_trajectories(points, frame, owner, detections, reference)
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


class _Tracker:
    """The open tracks, carried from frame to frame.

    Parameters
    ----------
    method, gate, patience, shortest
        As for `follow` and `TrackingInput`.
    tracks
        Tracks that are open before the first frame: if there are any, there will be no others.
    """

    def __init__(
        self,
        method: LinkMethod,
        gate: float,
        patience: int,
        shortest: int,
        tracks: OpenTracks = NO_TRACKS,
    ) -> None:
        self._method, self._gate = method, gate
        self._patience, self._shortest = patience, shortest
        self._tracks = tracks
        self._is_known = len(tracks.name) > 0
        self._frame = 0

    @staticmethod
    def of(reference: Trajectories, method: LinkMethod, gate: float) -> _Tracker:
        """Return one that follows the markers of a reference, however long they are not seen."""
        return _Tracker(method, gate, np.iinfo(np.int64).max, 0, _tracks_of(reference))

    def link(self, points: NDArray[np.float64], owner: NDArray[np.intp]) -> None:
        """Link the next frame's points, (P, 3) in the order of x.

        Parameters
        ----------
        points
        owner
            (P,), written: the name of the track that has each point, -1 for none.
        """
        from nodegraph_track import tracks_kernel

        predicted, of_track = self._method(self._tracks, points, self._frame, self._gate)
        limits = self._patience, self._shortest, self._is_known
        state = tracks_kernel.next_tracks(
            self._tracks, predicted, of_track, points, self._frame, *limits, owner
        )
        self._tracks = OpenTracks(*state)
        self._frame += 1


def _tracks_of(reference: Trajectories) -> OpenTracks:
    """Return a track for each marker of a reference.

    Raises
    ------
    Refusal
        If no frame has all of them.
    """
    counts = reference.present.sum(axis=1)
    fullest = int(counts.argmax()) if reference.frames else 0
    if not reference.frames or counts[fullest] < len(reference.markers):
        lacking = [
            name
            for column, name in enumerate(reference.markers)
            if not reference.frames or not reference.present[fullest, column]
        ]
        raise Refusal(
            f"needs a reference with a frame that has all {len(reference.markers)} markers; the "
            f"fullest, frame {fullest}, lacks {listed(lacking)}"
        )
    place = np.ascontiguousarray(reference.positions[fullest])
    count = len(place)
    return OpenTracks(
        name=np.arange(count),
        place=place,
        last=place,
        jump=np.zeros((count, 3)),
        steps=np.zeros((count, 3, 3)),
        seen=np.full(count, -1),
        length=np.ones(count, dtype=np.intp),
        opened=count,
    )


def _known_trajectories(
    points: NDArray[np.float64],
    frame: NDArray[np.intp],
    owner: NDArray[np.intp],
    detections: Detections,
    reference: Trajectories,
) -> Trajectories:
    kept = owner >= 0
    if not kept.all():
        warnings.warn(
            f"{np.count_nonzero(~kept)} of {len(kept)} points are none of the reference's markers "
            "and were left out",
            stacklevel=5,
        )
    positions = np.full((detections.frames, len(reference.markers), 3), np.nan)
    positions[frame[kept], owner[kept]] = points[kept]
    return Trajectories(
        positions=positions,
        markers=reference.markers,
        rate=detections.rate,
        marker_set=reference.marker_set,
    )


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
            stacklevel=5,
        )
    kept, column = long[owner], np.cumsum(long) - 1
    positions = np.full((detections.frames, np.count_nonzero(long), 3), np.nan)
    positions[frame[kept], column[owner[kept]]] = points[kept]
    names = tuple(f"t{index:03d}" for index in range(positions.shape[1]))
    return Trajectories(positions=positions, markers=names, rate=detections.rate)


def live_form(method: Callable[..., LinkMethod]) -> StateForm:
    """Return how a tracker follows the markers of a reference frame by frame.

    Parameters
    ----------
    method
        ``method(**settings)`` returns how a frame's points are linked; `gate`, `patience` and
        `shortest` are not among them.
    """

    def state(
        detections: Detections,
        reference: Trajectories | None = None,
        *,
        gate: float,
        patience: int,
        shortest: int,
        **settings: object,
    ) -> _Stream:
        if reference is None:
            raise Refusal(
                "frame by frame, it needs a reference: without it, the take says which tracks "
                "there are"
            )
        return _Stream(detections, reference, _Tracker.of(reference, method(**settings), gate))

    return StateForm(state, lookahead=lambda settings: None if settings["gate"] is None else 0)


class _Stream:
    """The markers of a reference, followed frame by frame."""

    def __init__(self, detections: Detections, reference: Trajectories, tracker: _Tracker) -> None:
        self._tracker = tracker
        self.header = Trajectories(
            positions=np.empty((0, len(reference.markers), 3)),
            markers=reference.markers,
            rate=detections.rate,
            marker_set=reference.marker_set,
        )
        count = len(reference.markers)
        self._nowhere = np.full((count, 3), np.nan)
        self._missing = np.full(count, _MISSING, dtype=np.uint8)

    def push(self, points: NDArray[np.float64]) -> MarkerFrame:
        from nodegraph_track import tracks_kernel

        points = tracks_kernel.in_order(points)
        owner = np.empty(len(points), dtype=np.intp)
        self._tracker.link(points, owner)
        positions, origin = self._nowhere.copy(), self._missing.copy()
        tracks_kernel.place(points, owner, positions, origin, _MEASURED)
        return MarkerFrame(positions, origin)

    def drain(self) -> Iterable[MarkerFrame]:
        return ()

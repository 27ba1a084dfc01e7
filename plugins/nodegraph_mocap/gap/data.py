"""The packed data of a block's view: one marker around a gap, as every method has it.

Arrays are whole steps in two bytes each (in one byte for the face), as base64 text; a missing
sample is the least number there is. Each array has a step of its own, so that a method that
strays far does not coarsen the others.
"""

from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from nodegraph_mocap.face_layout import edges_of
from nodegraph_mocap.frame_ranges import runs_of
from nodegraph_mocap.recording import Mask, Trajectories
from nodegraph_mocap.suspect import impulses
from nodegraph_mocap.view import AUTO, frontal

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import DTypeLike, NDArray

    from nodegraph_mocap.view import Projection

_Scalar = TypeVar("_Scalar", bound=np.generic)

FEWEST_AROUND = 10
"""Frames on each side of a gap; as many as the gap has, if these are more."""

AROUND = 30
"""Frames on each side of a single frame, where the block is not a gap."""

MOST_FRAMES = 400
"""Frames in a view; of a longer gap every second, third, ... frame is shown."""

MOST_POSES = 30
"""Frames in which the whole face is there; a view moves it evenly from one to the next."""

_VIEW_FRAMES = 60
"""Frames, evenly spaced over the take, that say where the front is."""

_NEAR = np.cos(np.radians(30))
_DIRECTIONS = (("to the side", "to the side"), ("up", "down"), ("to the front", "to the back"))


@dataclass(frozen=True)
class _Scored:
    """The values that the scores of a block read.

    Attributes
    ----------
    estimates : dict of method to Trajectories
        At least one.
    truth : Trajectories or None
    mask : Mask or None
    judged : str
        The mask's port: ``hidden``, ``impulses``.
    """

    estimates: dict[str, Trajectories]
    truth: Trajectories | None
    mask: Mask | None
    judged: str

    @property
    def base(self) -> Trajectories:
        """The truth, else the first estimate: it has the markers and the face."""
        return self.truth or next(iter(self.estimates.values()))

    def positions(self, marker: str) -> dict[str, NDArray[np.float64]]:
        """Return (T, 3) of a marker for each method that has it."""
        every = {
            method: _positions(recording, marker, self.truth)
            for method, recording in self.estimates.items()
        }
        return {method: positions for method, positions in every.items() if positions is not None}


@dataclass(frozen=True)
class _Place:
    """The marker of a block, and the frames that a view of it shows.

    Attributes
    ----------
    marker : str
    frames : range
    at : int
        The frame at which the view opens.
    reason : str
        Why these frames, where the block itself names none.
    """

    marker: str
    frames: range
    at: int
    reason: str = ""

    def of(self, values: NDArray[_Scalar]) -> NDArray[_Scalar]:
        """Return the frames of an array (T, ...) that the view shows."""
        return values[self.frames.start : self.frames.stop : self.frames.step]


def pack(
    block: Mapping[str, object], inputs: Mapping[str, Mapping[str, object]]
) -> dict[str, object] | None:
    """Return what the view of a block shows, as data for JSON.

    The frames are those of the gap with as many again on each side, at least 10; of a block that
    is not a gap those around the frame in which a method errs most, or, without a truth, in which
    methods differ most.

    Parameters
    ----------
    block
        ``marker``, ``start`` and ``frames`` say where a gap lies, or ``gap`` which run of the mask
        it is, counted by first frame, then marker. A block without them is a marker, or a take.
    inputs
        For each method what its score had read, by port: the first recording is the estimate, a
        second one the truth, a mask the samples that are judged.

    Returns
    -------
    dict or None
        None where no method has a marker of the block.
    """
    scored = _scored(inputs)
    if scored is None:
        return None
    place = _gap(block, scored) or _largest_error(block, scored)
    if place is None:
        return None
    estimates = {method: place.of(each) for method, each in scored.positions(place.marker).items()}
    return _packed(place, estimates, scored) if estimates else None


def integers(values: NDArray[np.float64], kind: DTypeLike = np.int16) -> dict[str, object]:
    """Return numbers as whole steps in base64, little-endian; NaN is the least integer."""
    limits = np.iinfo(np.dtype(kind))
    missing = np.isnan(values)
    known = np.where(missing, 0.0, values)
    step = float(np.abs(known).max(initial=0.0)) / limits.max or 1.0
    whole = np.where(missing, limits.min, np.rint(known / step))
    little = whole.astype(np.dtype(kind).newbyteorder("<"))
    return {"step": step, "data": base64.b64encode(little.tobytes()).decode()}


def _scored(inputs: Mapping[str, Mapping[str, object]]) -> _Scored | None:
    estimates: dict[str, Trajectories] = {}
    truth, mask, judged = None, None, ""
    for method, ports in inputs.items():
        recordings = [value for value in ports.values() if isinstance(value, Trajectories)]
        if recordings and recordings[0].frames:
            estimates[str(method)] = recordings[0]
        truth = next(iter(recordings[1:]), truth)
        masks = [(port, value) for port, value in ports.items() if isinstance(value, Mask)]
        judged, mask = next(iter(masks), (judged, mask))
    return _Scored(estimates, truth, mask, judged) if estimates else None


def _positions(
    recording: Trajectories, marker: str, truth: Trajectories | None
) -> NDArray[np.float64] | None:
    """Return (T, 3) of a marker; of a track without names, the one that has it most often."""
    if marker in recording.markers:
        return recording.positions[:, recording.markers.index(marker)]
    if truth is None or marker not in truth.markers:
        return None
    true = truth.positions[:, truth.markers.index(marker)]
    # few samples have one coordinate in common, and of these alone the others are compared
    frames, tracks = np.nonzero(recording.positions[:, :, 0] == true[:, np.newaxis, 0])
    same = (recording.positions[frames, tracks] == true[frames]).all(axis=1)
    common = np.bincount(tracks[same], minlength=len(recording.markers))
    if not common.any():
        return None
    return recording.positions[:, int(np.argmax(common))]


def _gap(block: Mapping[str, Any], scored: _Scored) -> _Place | None:
    """Return the marker of a block that is a gap, and the frames around it."""
    marker = block.get("marker")
    if marker in scored.base.markers and {"start", "frames"} <= block.keys():
        return _around(str(marker), int(block["start"]), int(block["frames"]), scored)
    if scored.mask is None or "gap" not in block:
        return None
    gaps = runs_of(scored.mask.hidden).by_start()
    number = int(block["gap"])
    if not 0 <= number < len(gaps.start):
        return None
    marker, first, stop = (int(column[number]) for column in gaps)
    return _around(scored.mask.markers[marker], first, stop - first, scored)


def _around(marker: str, first: int, length: int, scored: _Scored) -> _Place:
    around = max(length, FEWEST_AROUND)
    frames = range(max(first - around, 0), min(first + length + around, scored.base.frames))
    step = max(1, -(-len(frames) // MOST_FRAMES))
    return _Place(marker, frames[::step], at=first + length // 2)


def _largest_error(block: Mapping[str, object], scored: _Scored) -> _Place | None:
    """Return the sample of a block in which a method is farthest from the truth."""
    base, marker = scored.base, block.get("marker")
    farthest: list[tuple[float, int, str]] = []
    for name in (str(marker),) if marker in base.markers else base.markers:
        middle = base.positions[:, base.markers.index(name)]
        errors = [each - middle for each in scored.positions(name).values()]
        if errors:
            squares = [np.einsum("ti,ti->t", error, error) for error in errors]
            largest = np.fmax.reduce(squares, initial=-1.0)  # where no method has the marker
            frame = int(np.argmax(largest))
            farthest.append((float(largest[frame]), frame, name))
    if not farthest:
        return None
    error, frame, name = max(farthest, key=lambda sample: sample[0])
    what = "a method errs most" if scored.truth else "methods differ most"
    reason = f"{what} in frame {frame}" if error > 0 else ""
    at = frame if reason else base.frames // 2
    return _Place(name, range(max(at - AROUND, 0), min(at + AROUND + 1, base.frames)), at, reason)


def _packed(
    place: _Place, estimates: dict[str, NDArray[np.float64]], scored: _Scored
) -> dict[str, object]:
    base, frames = scored.base, place.frames
    positions = base.positions[:, base.markers.index(place.marker)]
    truth = place.of(positions) if scored.truth else None
    every = np.stack(list(estimates.values()))
    same = (every == every[0]) | (np.isnan(every) & np.isnan(every[0]))
    apart = ~same.all(axis=(0, 2))
    common = np.where(apart[:, np.newaxis], np.nan, every[0])
    centre = _middle(every[0] if truth is None else truth, common, every)
    suspects = np.flatnonzero(place.of(impulses(positions[:, np.newaxis])[:, 0]))
    view = _view(base)
    return {
        "marker": place.marker,
        "start": frames.start,
        "every": frames.step,
        "frames": len(frames),
        "at": (place.at - frames.start) // frames.step,
        "reason": place.reason,
        "rate": base.rate,
        "unit": "mm",
        "judged": {"name": scored.judged, "runs": _runs(_judged(place, scored))},
        "suspects": suspects.tolist() if scored.truth else [],
        "axes": _axes(view),
        "right": view.right.tolist(),
        "up": view.up.tolist(),
        "centre": centre.tolist(),
        "truth": None if truth is None else integers(truth - centre),
        "common": integers(common - centre),
        "apart": _runs(apart),
        "estimates": [
            {"method": method, **integers(positions[apart] - centre)}
            for method, positions in estimates.items()
        ],
        "face": _face(place, base, centre),
    }


def _middle(*choices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the median of the first choice that has a position."""
    for positions in choices:
        known = positions[np.isfinite(positions).all(axis=-1)]
        if len(known):
            return np.asarray(np.median(known, axis=0))
    return np.zeros(3)


def _judged(place: _Place, scored: _Scored) -> NDArray[np.bool_]:
    if scored.mask is None or place.marker not in scored.mask.markers:
        return np.zeros(len(place.frames), dtype=np.bool_)
    return place.of(scored.mask.hidden[:, scored.mask.markers.index(place.marker)])


def _runs(flags: NDArray[np.bool_]) -> list[list[int]]:
    """Return the first and the last place of each run of True."""
    _, start, stop = runs_of(flags)
    return [[int(first), int(last) - 1] for first, last in zip(start, stop, strict=True)]


def _view(base: Trajectories) -> Projection:
    """Return from where the face of a take is seen."""
    return frontal(base[:: max(1, base.frames // _VIEW_FRAMES)], AUTO)


def _axes(view: Projection) -> list[str]:
    """Return where x, y and z lead, empty for an axis that is askew."""
    directions = np.stack([view.right, view.up, np.cross(view.right, view.up)])
    words = []
    for axis in directions.T:
        nearest = int(np.argmax(np.abs(axis)))
        ahead, back = _DIRECTIONS[nearest]
        words.append("" if abs(axis[nearest]) < _NEAR else ahead if axis[nearest] > 0 else back)
    return words


def _face(place: _Place, base: Trajectories, centre: NDArray[np.float64]) -> dict[str, object]:
    """Return the positions of all markers in some frames."""
    every = -(-len(place.frames) // MOST_POSES)
    points = place.of(base.positions)[::every] - centre
    count = np.count_nonzero(np.isfinite(points), axis=0)
    total = np.where(np.isnan(points), 0.0, points).sum(axis=0)
    rest = np.where(count > 0, total / np.maximum(count, 1), np.nan)
    return {
        "markers": list(base.markers),
        "edges": edges_of(base),
        "every": every,
        "rest": integers(rest),
        "moved": integers(points - rest, np.int8),
    }

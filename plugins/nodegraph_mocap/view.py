"""From where a face is seen: which way is right and up in the picture."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_mocap.marker_set import MarkerSet
    from nodegraph_mocap.recording import Trajectories

AUTO = "auto"
_AXES = {"x": 0, "y": 1, "z": 2}
_NEAR = np.cos(np.radians(30))
_FEWEST = 4
_CLEARLY = 1.8  # times as high as deep are the markers of a face, from 2.4 on


@dataclass(frozen=True)
class Projection:
    """A parallel projection.

    Attributes
    ----------
    centre, right, up : (3,) arrays of float64
        The point drawn at (0, 0), and the unit vectors of the picture's axes.
    """

    centre: NDArray[np.float64]
    right: NDArray[np.float64]
    up: NDArray[np.float64]

    def project(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return (..., 2) millimetres in the picture of (..., 3) positions."""
        return np.asarray((points - self.centre) @ np.stack([self.right, self.up], axis=1))


def frontal(recording: Trajectories, view: str) -> Projection:
    """Return the view of a recording's face from the front, or the requested one.

    The face is the mean of its measured samples. With a marker set that has pairs, the face's
    left is on the right of the picture; forward is the direction across the pairs and across the
    face's height in which the middle of the face stands out; up follows from the two. Where height
    and depth are alike, as those of a whole head, up is the recording's y or z axis. Without
    pairs, forward is the face's least extent, likewise, and up is the recording's y or z axis,
    whichever lies in the picture, or along the face's greatest extent if both do. Directions
    within 30 degrees of the recording's own axes are moved onto them.

    Parameters
    ----------
    recording
        A recording of at least four markers; with fewer, x is right and y is up.
    view
        ``auto`` or two signed axes, right and up, such as ``+x+y`` or ``-y+z``.

    Raises
    ------
    ValueError
        If `view` is neither.
    """
    face, known = _mean_face(recording)
    centre = face[known].mean(axis=0) if known.any() else np.zeros(3)
    if view != AUTO:
        return Projection(centre, *_signed_axes(view))
    if np.count_nonzero(known) < _FEWEST:
        return Projection(centre, *_signed_axes("+x+y"))
    sideways = _left(face, known, recording.markers, recording.marker_set)
    points = face[known] - centre
    axes = _from_extents(points) if sideways is None else _from_pairs(points, sideways)
    return Projection(centre, *_snapped(*axes))


def _signed_axes(view: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    parts = re.fullmatch(r"([+-])([xyz])([+-])([xyz])", view)
    if parts is None or parts[2] == parts[4]:
        raise ValueError(f"view {view!r} is neither 'auto' nor two signed axes such as '+x+y'")
    right, up = np.zeros(3), np.zeros(3)
    right[_AXES[parts[2]]] = float(parts[1] + "1")
    up[_AXES[parts[4]]] = float(parts[3] + "1")
    return right, up


def _mean_face(recording: Trajectories) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return the (M, 3) mean of the measured samples and which markers have any."""
    chosen = recording.measured if recording.measured.any() else recording.present
    count = chosen.sum(axis=0)
    total = np.where(chosen[..., np.newaxis], recording.positions, 0.0).sum(axis=0)
    return total / np.maximum(count, 1)[:, np.newaxis], count > 0


def _left(
    face: NDArray[np.float64],
    known: NDArray[np.bool_],
    markers: tuple[str, ...],
    marker_set: MarkerSet | None,
) -> NDArray[np.float64] | None:
    """Return the direction to the face's left, from its pairs; None where there are none."""
    place = {name: column for column, name in enumerate(markers) if known[column]}
    pairs = marker_set.pairs if marker_set else ()
    ends = [
        (place[left], place[right]) for left, right in pairs if left in place and right in place
    ]
    if not ends:
        return None
    across = np.mean([face[left] - face[right] for left, right in ends], axis=0)
    length = np.linalg.norm(across)
    return across / length if length > 0 else None


def _from_pairs(
    points: NDArray[np.float64], left: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    lateral = points @ left
    profile = points - np.outer(lateral, left)
    sizes = np.linalg.svd(profile, compute_uv=False)
    if sizes[0] < _CLEARLY * sizes[1]:
        return left, _up_of_head(points, left)
    forward = _outward(_extents(profile)[1], points, lateral**2)
    return left, np.cross(forward, left)


def _up_of_head(points: NDArray[np.float64], left: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the y or z axis, across left, from which the middle stands out more to the front."""
    lateral = points @ left
    upright = [axis - (axis @ left) * left for axis in np.eye(3)[1:]]
    axes = [axis / np.linalg.norm(axis) for axis in upright if np.linalg.norm(axis) > 0.5]

    def tilt(up: NDArray[np.float64]) -> float:
        depth = points @ np.cross(left, up)
        depth = depth - depth.mean()
        return float(depth @ (lateral**2 - (lateral**2).mean()) / np.linalg.norm(depth))

    return min(axes, key=tilt)


def _from_extents(
    points: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    longest, _, forward = _extents(points)
    in_plane = points - np.outer(points @ forward, forward)
    forward = _outward(forward, points, (in_plane**2).sum(axis=1))
    upright = [axis - (axis @ forward) * forward for axis in np.eye(3)[1:]]
    lengths = [np.linalg.norm(axis) for axis in upright]
    along = [abs(axis @ longest) for axis in upright]
    chosen = np.argmax(along if min(lengths) > _NEAR else lengths)
    up = upright[chosen] / lengths[chosen]
    return np.cross(up, forward), up


def _extents(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the principal axes, the one of the greatest extent first."""
    return np.asarray(np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2])


def _outward(
    forward: NDArray[np.float64], points: NDArray[np.float64], away: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return `forward` or its opposite, so that points far from the middle lie behind."""
    depth = points @ forward
    tilt = (depth - depth.mean()) @ (away - away.mean())
    return -forward if tilt > 0 else forward


def _snapped(
    right: NDArray[np.float64], up: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the recording's own signed axes where both are near, else the directions given."""
    nearest = [_nearest_axis(right), _nearest_axis(up)]
    near = nearest[0] @ right > _NEAR and nearest[1] @ up > _NEAR
    return (nearest[0], nearest[1]) if near else (right, up)


def _nearest_axis(direction: NDArray[np.float64]) -> NDArray[np.float64]:
    axis = np.zeros(3)
    largest = int(np.argmax(np.abs(direction)))
    axis[largest] = np.sign(direction[largest])
    return axis

"""Splits recordings, masks, weights, head motions, animations and detections into frames."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple, TypeVar

import numpy as np

from nodegraph import Streamable
from nodegraph_mocap.animation import Animation
from nodegraph_mocap.detections import Detections
from nodegraph_mocap.face_model import HeadMotion, Weights
from nodegraph_mocap.recording import Mask, Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

_Scalar = TypeVar("_Scalar", bound=np.generic)

_MISSING = int(Origin.MISSING)
"""A plain number: comparing an array with a member of an enumeration takes five times as long."""


class MarkerFrame(NamedTuple):
    """One frame of a recording.

    Attributes
    ----------
    positions : (M, 3) array of float64
        Millimetres; a missing sample is NaN in all three coordinates.
    origin : (M,) array of uint8
        An `Origin` per sample.
    sigma : (M,) array of float64, or None
        Millimetres; None where the recording has none.
    """

    positions: NDArray[np.float64]
    origin: NDArray[np.uint8]
    sigma: NDArray[np.float64] | None = None

    @property
    def present(self) -> NDArray[np.bool_]:
        """(M,), True where the marker is not missing."""
        present: NDArray[np.bool_] = self.origin != _MISSING
        return present

    def marked(self, which: NDArray[np.bool_], origin: Origin) -> NDArray[np.uint8]:
        """Return the origins with another one for some markers, (M,)."""
        marked = self.origin.copy()
        marked[which] = int(origin)
        return marked

    def at(self, frame: int) -> MarkerFrame:
        """Return one frame of a window, of whose arrays the first axis is the frames."""
        sigma = None if self.sigma is None else self.sigma[frame]
        return MarkerFrame(self.positions[frame], self.origin[frame], sigma)


class HeadPose(NamedTuple):
    """One frame of a head motion: ``captured = s R aligned + t``.

    Attributes
    ----------
    rotation : (3, 3) array of float64
    translation : (3,) array of float64
        Millimetres.
    scale : () array of float64
    """

    rotation: NDArray[np.float64]
    translation: NDArray[np.float64]
    scale: NDArray[np.float64]


class AnimationFrame(NamedTuple):
    """One frame of an animation.

    Attributes
    ----------
    weights : (K,) array of float64
    pose : HeadPose or None
        None where the head keeps still.
    """

    weights: NDArray[np.float64]
    pose: HeadPose | None


def _joined(frames: Sequence[NDArray[_Scalar]], header: NDArray[_Scalar]) -> NDArray[_Scalar]:
    return np.stack(frames) if len(frames) else header


def _marker_frames(recording: Trajectories) -> list[MarkerFrame]:
    sigma = [None] * recording.frames if recording.sigma is None else recording.sigma
    positions = np.ascontiguousarray(recording.positions)
    columns = zip(positions, recording.origin, sigma, strict=True)
    return [MarkerFrame(*column) for column in columns]


def _recording(header: Trajectories, frames: Sequence[MarkerFrame]) -> Trajectories:
    if not frames:
        return header
    sigma = [frame.sigma for frame in frames if frame.sigma is not None]
    return replace(
        header,
        positions=np.stack([frame.positions for frame in frames]),
        origin=np.stack([frame.origin for frame in frames]),
        sigma=np.stack(sigma) if sigma else None,
    )


def _missing_markers(header: Trajectories) -> MarkerFrame:
    count = len(header.markers)
    return MarkerFrame(
        np.full((count, 3), np.nan),
        np.full(count, Origin.MISSING, dtype=np.uint8),
        None if header.sigma is None else np.full(count, np.nan),
    )


def _poses(motion: HeadMotion) -> list[HeadPose]:
    columns = zip(motion.rotations, motion.translations, motion.scales[:, None], strict=True)
    return [HeadPose(rotation, place, scale[0]) for rotation, place, scale in columns]


def _head_motion(poses: Sequence[HeadPose]) -> HeadMotion:
    if not poses:
        return HeadMotion.still(0)
    return HeadMotion(
        rotations=np.stack([pose.rotation for pose in poses]),
        translations=np.stack([pose.translation for pose in poses]),
        scales=np.stack([pose.scale for pose in poses]),
    )


def _animation_header(animation: Animation) -> Animation:
    weights = replace(animation.weights, values=animation.weights.values[:0])
    motion = None if animation.head_motion is None else HeadMotion.still(0)
    return replace(animation, weights=weights, head_motion=motion)


def _animation_frames(animation: Animation) -> list[AnimationFrame]:
    motion = animation.head_motion
    poses = [None] * animation.frames if motion is None else _poses(motion)
    columns = zip(animation.weights.values, poses, strict=True)
    return [AnimationFrame(*column) for column in columns]


def _animation(header: Animation, frames: Sequence[AnimationFrame]) -> Animation:
    values = _joined([frame.weights for frame in frames], header.weights.values)
    poses = [frame.pose for frame in frames if frame.pose is not None]
    return replace(
        header,
        weights=replace(header.weights, values=values),
        head_motion=None if header.head_motion is None else _head_motion(poses),
    )


def _missing_weights(header: Animation) -> AnimationFrame:
    pose = None if header.head_motion is None else _poses(HeadMotion.still(1))[0]
    return AnimationFrame(np.full(len(header.weights.names), np.nan), pose)


def _detections(header: Detections, frames: Sequence[NDArray[np.float64]]) -> Detections:
    counts = [len(points) for points in frames]
    return Detections(
        points=np.concatenate([np.empty((0, 3)), *frames]),
        offsets=np.concatenate([[0], np.cumsum(counts, dtype=np.int64)]),
        rate=header.rate,
    )


STREAMS: Mapping[type, Streamable] = {
    Trajectories: Streamable(
        lambda recording: recording[:0], _marker_frames, _recording, _missing_markers
    ),
    Weights: Streamable(
        lambda weights: replace(weights, values=weights.values[:0]),
        lambda weights: list(weights.values),
        lambda header, frames: replace(header, values=_joined(frames, header.values)),
        lambda header: np.full(len(header.names), np.nan),
    ),
    Mask: Streamable(
        lambda mask: replace(mask, hidden=mask.hidden[:0]),
        lambda mask: list(mask.hidden),
        lambda header, frames: replace(header, hidden=_joined(frames, header.hidden)),
        lambda header: np.zeros(len(header.markers), dtype=np.bool_),
    ),
    HeadMotion: Streamable(
        lambda motion: HeadMotion.still(0),
        _poses,
        lambda header, frames: _head_motion(frames),
        lambda header: _poses(HeadMotion.still(1))[0],
    ),
    Animation: Streamable(_animation_header, _animation_frames, _animation, _missing_weights),
    Detections: Streamable(
        lambda detections: _detections(detections, ()),
        # the split of no frames has one part
        lambda detections: np.split(detections.points, detections.offsets[1:-1])[
            : len(detections.offsets) - 1
        ],
        _detections,
        lambda header: np.empty((0, 3)),
    ),
}
"""How values of each type are split into frames."""

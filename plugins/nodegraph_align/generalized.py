"""Alignment of frames to one another, by way of their mean shape."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Refusal, node
from nodegraph_align.fitting import Fitting
from nodegraph_align.landmarks import Landmarks, landmarks_of
from nodegraph_align.poses import Aligned, Scale, fit, warn
from nodegraph_align.reference import Reference, check_shape
from nodegraph_mocap import Trajectories
from nodegraph_mocap.reference_shape import reference_shape

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

_ROUNDS = 300
_TOLERANCE = 1e-11
"""Movement of the mean shape in a round, relative to its size, below which it is found."""


@node("align.generalized", cite="gower1975", lookahead=None)
def generalized(
    recording: Trajectories,
    *,
    landmarks: Landmarks | None = None,
    scale: Scale = "none",
) -> Aligned:
    """Align frames to their own mean shape: for scans, or a take without a reference (Gower).

    In turns, each frame's landmarks are fitted to the mean shape as in align.procrustes, and the
    mean shape becomes the mean of the landmarks so placed, until it moves by less than 1e-11 of
    its size. Without a scale each turn lowers the sum of squared distances from the mean shape.
    It is kept where the fullest frame is (the one with the most landmarks, the first of equals)
    and starts from that frame's landmarks; so that frame stays as it is. If the mean shape still
    moves after 300 rounds, a warning says by how much.

    Missing landmarks do not count, in the fit nor in the mean. A frame with fewer than three, or
    with all on a line, stays as it is and is not part of the mean; these are counted in a warning.
    Looks at the whole take.

    Parameters
    ----------
    recording
        A take, or a set of scans with a frame per scan, with or without gaps.
    landmarks
        Names of markers that the fit goes by. None: the stable markers of the marker set. ``*``
        alone: all markers.
    scale
        none: all frames keep their size. rms: they become as large as the fullest frame, by the
        root mean square distance of the landmarks from their mean. least_squares: as fits best.

    Returns
    -------
    aligned : Trajectories
        The recording, each frame moved; gaps, `origin` and marker set as they were, `sigma`
        scaled.
    head_motion : HeadMotion
        ``captured = s R aligned + t``.
    reference : Trajectories
        The mean of the aligned frames, each marker's over those that have it: a recording of one
        frame.

    Raises
    ------
    ValueError
        If a landmark is unknown, listed twice, or there are fewer than three; if none are named
        and no marker set says which markers are stable.
    Refusal
        If no frame has three landmarks that are not on a line.
    """
    names, notes = landmarks_of(recording, None, landmarks)
    place = recording.keep(names)
    fullest = _fullest(place)
    seen = place.present.any(axis=0)
    if not seen.all():
        notes.append(f"{np.count_nonzero(~seen)} landmarks are missing in every frame")
        place = place.keep(np.array(names)[seen].tolist())
    fitting, movement = _mean_shape(place, fullest, scale)
    if movement > _TOLERANCE:
        notes.append(
            f"after {_ROUNDS} rounds the mean shape still moves by {movement:.1e} of its size"
        )
    poses = fitting.fit()
    aligned, motion = poses.move(recording)
    columns = [recording.markers.index(name) for name in place.markers]
    face = np.full((len(recording.markers), 3), np.nan)
    face[columns] = fitting.shape
    face = _mean(aligned.positions[poses.known], face)
    face = _kept(face, columns, recording.positions[fullest], scale)
    reference = Reference(
        Trajectories(
            positions=face[None],
            markers=recording.markers,
            rate=recording.rate,
            marker_set=recording.marker_set,
        ),
        place.markers,
        fitting.shape,
    )
    warn(poses, recording, reference, notes)
    return Aligned(aligned, motion, reference.frame)


def _fullest(place: Trajectories) -> int:
    """Return the frame with the most landmarks, which must determine a rotation."""
    if not place.frames:
        raise Refusal("needs a frame to align to, and there is none")
    number = int(place.present.sum(axis=1).argmax())
    check_shape(place.positions[number, place.present[number]])
    return number


def _mean_shape(place: Trajectories, fullest: int, scale: Scale) -> tuple[Fitting, float]:
    """Return landmarks that belong where the mean shape has them, and how far it still moves."""
    fitting = Fitting(place.positions, reference_shape(place), scale)
    every, movement = range(len(fitting.shape)), math.inf
    for _ in range(_ROUNDS):
        poses, shape = fitting.fit(), fitting.shape
        mean = _mean(fitting.placed(poses)[poses.known], shape)
        mean = _kept(mean, every, fitting.points[fullest], scale)
        movement = float(np.linalg.norm(mean - shape) / np.linalg.norm(mean - mean.mean(axis=0)))
        fitting = replace(fitting, shape=mean)
        if movement <= _TOLERANCE:
            break
    return fitting, movement


def _mean(placed: NDArray[np.float64], otherwise: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the mean over frames, (M, 3), of the samples that are there, if there are any."""
    there = ~np.isnan(placed[..., :1])
    count = there.sum(axis=0)
    total = np.where(there, placed, 0.0).sum(axis=0)
    return np.where(count > 0, total / np.maximum(count, 1), otherwise)


def _kept(
    face: NDArray[np.float64],
    columns: Sequence[int],
    frame: NDArray[np.float64],
    scale: Scale,
) -> NDArray[np.float64]:
    """Return the face, (M, 3), moved such that a frame, (M, 3), that is fitted to it stays."""
    landmarks = np.array(columns)
    rotation, size, centre, goal, _ = fit(
        frame[None], landmarks, face[landmarks], np.ones((1, len(landmarks))), scale
    )
    return np.asarray((face - goal) @ rotation[0] / size + centre)

"""A face in few numbers: where the head is, what shapes it has, how much of each it shows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nodegraph import Value
from nodegraph_mocap.checks import distinct, finite, numbers, possible_rate, set_fields
from nodegraph_mocap.marker_set import MarkerSet
from nodegraph_mocap.recording import Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

_ORTHONORMAL = 1e-3
"""Largest deviation of R R^T from the identity; rotations stored as float32 stay far below it."""

_RATE = 1.0
"""A single frame has no rate, but a recording needs one."""


@dataclass(frozen=True, eq=False, kw_only=True)
class HeadMotion(Value):
    """The pose of the head in each frame: ``captured = s R aligned + t``.

    Attributes
    ----------
    rotations : (T, 3, 3) array of float64
        R, applied to points as columns.
    translations : (T, 3) array of float64
        t, millimetres.
    scales : (T,) array of float64
        s, positive; 1 where the head keeps its size.

    Raises
    ------
    ValueError
        If shapes disagree, a number is missing or infinite, a scale is not positive, or a
        rotation is not orthonormal.
    """

    rotations: NDArray[np.float64]
    translations: NDArray[np.float64]
    scales: NDArray[np.float64]

    def __post_init__(self) -> None:
        rotations = finite("rotations", self.rotations, ("frames", 3, 3))
        frames = len(rotations)
        translations = finite("translations", self.translations, (frames, 3))
        scales = finite("scales", self.scales, (frames,))
        if np.any(scales <= 0):
            frame = int(np.argmax(scales <= 0))
            raise ValueError(f"scales: must be positive, got {scales[frame]} in frame {frame}")
        _check_orthonormal(rotations)
        set_fields(self, rotations=rotations, translations=translations, scales=scales)

    @staticmethod
    def still(frames: int) -> HeadMotion:
        """Return the motion of a head that does not move."""
        return HeadMotion(
            rotations=np.tile(np.eye(3), (frames, 1, 1)),
            translations=np.zeros((frames, 3)),
            scales=np.ones(frames),
        )

    @property
    def frames(self) -> int:
        """Number of frames, T."""
        return len(self.rotations)

    def __getitem__(self, frames: slice | NDArray[np.generic]) -> HeadMotion:
        """Return the motion in some frames: a slice, flags, or numbers."""
        return HeadMotion(
            rotations=self.rotations[frames],
            translations=self.translations[frames],
            scales=self.scales[frames],
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class BlendshapeModel(Value):
    """A face at rest and named ways in which it moves, at the markers.

    A pose is ``neutral + sum(weight * shape)``.

    Attributes
    ----------
    neutral : (M, 3) array of float64
        Millimetres.
    shapes : (K, M, 3) array of float64
        Offsets from the neutral at weight 1, millimetres.
    names : tuple of K str
    markers : tuple of M str

    Raises
    ------
    ValueError
        If shapes disagree, a number is missing or infinite, or a name is listed twice.
    """

    neutral: NDArray[np.float64]
    shapes: NDArray[np.float64]
    names: tuple[str, ...]
    markers: tuple[str, ...]

    def __post_init__(self) -> None:
        names = distinct("shape names", self.names)
        markers = distinct("markers", self.markers)
        set_fields(
            self,
            neutral=finite("neutral", self.neutral, (len(markers), 3)),
            shapes=finite("shapes", self.shapes, (len(names), len(markers), 3)),
            names=names,
            markers=markers,
        )


class ModelAndNeutral(NamedTuple):
    """Outputs of a node that gives a model: the model, and its face at rest as a recording."""

    model: BlendshapeModel
    neutral: Trajectories

    @staticmethod
    def of(model: BlendshapeModel, marker_set: MarkerSet | None = None) -> ModelAndNeutral:
        """Return a model with its neutral, a recording of one frame."""
        neutral = Trajectories(
            positions=model.neutral[None], markers=model.markers, rate=_RATE, marker_set=marker_set
        )
        return ModelAndNeutral(model, neutral)


@dataclass(frozen=True, eq=False, kw_only=True)
class Weights(Value):
    """The weight of each blendshape in each frame.

    Attributes
    ----------
    values : (T, K) array of float64
        0 is none of the shape and 1 all of it; NaN where a weight is not known.
    names : tuple of K str
    rate : float
        Frames per second.

    Raises
    ------
    ValueError
        If shapes disagree, a weight is infinite, or a name is listed twice.
    """

    values: NDArray[np.float64]
    names: tuple[str, ...]
    rate: float

    def __post_init__(self) -> None:
        names = distinct("shape names", self.names)
        values = numbers("weights", self.values, ("frames", len(names)))
        set_fields(self, values=values, names=names, rate=possible_rate(self.rate))

    @property
    def frames(self) -> int:
        """Number of frames, T."""
        return len(self.values)


def _check_orthonormal(rotations: NDArray[np.float64]) -> None:
    errors = np.abs(rotations @ rotations.transpose(0, 2, 1) - np.eye(3)).max(
        axis=(1, 2), initial=0.0
    )
    if np.any(errors > _ORTHONORMAL):
        frame = int(np.argmax(errors > _ORTHONORMAL))
        raise ValueError(
            f"rotations: frame {frame} is not orthonormal (off by {errors[frame]:.3g})"
        )

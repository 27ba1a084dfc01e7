"""Poses: the place of each frame's landmarks, and the face moved there."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeVar

import numpy as np

from nodegraph import Refusal, listed, nearest
from nodegraph_align.landmarks import FEWEST
from nodegraph_mocap import HeadMotion, Trajectories

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from nodegraph_align.reference import Reference

_Scalar = TypeVar("_Scalar", bound=np.generic)
Scale = Literal["none", "rms", "least_squares"]
FITTED, MIRRORED, FEW, LINE = 0, 1, 2, 3
_CODES: dict[Scale, int] = {"none": 0, "rms": 1, "least_squares": 2}


class Aligned(NamedTuple):
    """The result of an alignment."""

    aligned: Trajectories
    head_motion: HeadMotion
    reference: Trajectories


class Moved(NamedTuple):
    """Frames moved to where they belong, and how to go back, as `HeadMotion` has it."""

    positions: NDArray[np.float64]
    sigma: NDArray[np.float64] | None
    rotations: NDArray[np.float64]
    translations: NDArray[np.float64]
    scales: NDArray[np.float64]


class Transforms(NamedTuple):
    """The transform of each frame's points x: ``s R (x - centre) + goal``.

    All arrays are contiguous, for which the kernel is compiled.

    Attributes
    ----------
    rotations : (T, 3, 3) array of float64
    scales : (T,) array of float64
    centres, goals : (T, 3) arrays of float64
    states : (T,) array of uint8
        `FITTED`; `MIRRORED`, fitted although a mirror image would fit far better; `FEW`, not
        fitted because landmarks are too few; `LINE`, because they are on a line.
    """

    rotations: NDArray[np.float64]
    scales: NDArray[np.float64]
    centres: NDArray[np.float64]
    goals: NDArray[np.float64]
    states: NDArray[np.uint8]

    @property
    def known(self) -> NDArray[np.bool_]:
        """(T,), True where the frame is fitted."""
        return np.asarray(self.states <= MIRRORED)

    def some(self, frames: NDArray[np.generic]) -> Transforms:
        """Return those of some frames."""
        return Transforms(*(part[frames] for part in self))

    def put(self, frames: NDArray[np.generic], others: Transforms) -> None:
        """Replace those of some frames."""
        parts: tuple[Any, ...] = self
        for part, other in zip(parts, others, strict=True):
            part[frames] = other

    def move(self, recording: Trajectories) -> tuple[Trajectories, HeadMotion]:
        """Return the recording with each fitted frame where it belongs, and how to go back.

        Samples keep their origin, and sigma goes with the scale.
        """
        there = self.moved(recording.positions, recording.sigma)
        motion = HeadMotion(
            rotations=there.rotations, translations=there.translations, scales=there.scales
        )
        return replace(recording, positions=there.positions, sigma=there.sigma), motion

    def moved(self, positions: NDArray[np.float64], sigma: NDArray[np.float64] | None) -> Moved:
        """Return (T, M, 3) positions and (T, M) sigma of the same frames, moved as by `move`."""
        from nodegraph_align import rigid_kernel

        points = for_kernel(positions)
        # of numpy, which takes large arrays from the system in large pages, numba in small ones
        there = np.empty_like(points)
        back = rigid_kernel.move(there, points, *self)
        if sigma is not None:
            sigma = sigma * np.where(self.known, self.scales, 1.0)[:, None]
        return Moved(there, sigma, *back)


def fitted(
    recording: Trajectories, reference: Reference, scale: Scale, *, reflection: bool = False
) -> Transforms:
    """Return the poses that minimize each frame's squared distances from the reference.

    Parameters
    ----------
    recording
        With the reference's landmarks.
    reference
        Where they belong.
    scale, reflection
        As for `fit`.
    """
    columns = reference.columns(recording)
    alike = np.ones((1, len(columns)))
    return fit(recording.positions, columns, reference.shape, alike, scale, reflection=reflection)


def fit(
    positions: NDArray[np.float64],
    columns: NDArray[np.intp],
    shape: NDArray[np.float64],
    weights: NDArray[np.float64],
    scale: Scale,
    *,
    reflection: bool = False,
) -> Transforms:
    """Return the poses that minimize ``sum(w |s R (x - centre) + goal - y|^2)`` in each frame.

    Parameters
    ----------
    positions
        (T, M, 3), NaN where missing.
    columns
        (L,), which of the M are landmarks.
    shape
        (L, 3), their places y.
    weights
        (T, L), or (1, L) for all frames.
    scale
        How large the frames become: as they are, as large as the reference by the root mean
        square of the landmarks' distances from their mean, or as fits best.
    reflection
        Whether a mirror image may be chosen.

    Raises
    ------
    ValueError
        If there is no such scale.
    """
    from nodegraph_align import rigid_kernel

    if scale not in _CODES:
        raise ValueError(f"no scale {scale!r}; {nearest(scale, _CODES)}")
    return Transforms(
        *rigid_kernel.fit(
            for_kernel(positions),
            for_kernel(columns),
            for_kernel(shape),
            for_kernel(weights),
            _CODES[scale],
            reflection,
        )
    )


def moved(
    positions: NDArray[np.float64], matrices: NDArray[np.float64], offsets: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return ``matrix x + offset``, (T, M, 3), of every point x of each frame."""
    from nodegraph_align import rigid_kernel

    points = for_kernel(positions)
    out = np.empty_like(points)
    rigid_kernel.move_into(out, points, for_kernel(matrices), for_kernel(offsets))
    return out


def for_kernel(array: NDArray[_Scalar]) -> NDArray[_Scalar]:
    """Return a view that cannot be written to, contiguous: one kind, compiled once."""
    if array.flags.c_contiguous and not array.flags.writeable:
        return array
    view = np.ascontiguousarray(array).view()
    view.flags.writeable = False
    return view


def warn(
    poses: Transforms,
    recording: Trajectories,
    reference: Reference,
    notes: list[str],
    *,
    stacklevel: int = 3,
) -> None:
    """Warn of the notes and of doubtful frames, with counts.

    Raises
    ------
    Refusal
        If no frame at all could be fitted.
    """
    if not poses.known.any():
        raise Refusal(
            f"no frame has {FEWEST} of the landmarks {listed(reference.landmarks)} that are "
            "not on a line"
        )
    every = [*notes, *_doubts(poses, recording, reference)]
    if every:
        warnings.warn("; ".join(every), stacklevel=stacklevel)


def _doubts(poses: Transforms, recording: Trajectories, reference: Reference) -> Iterator[str]:
    columns = reference.columns(recording)
    counts = np.count_nonzero(recording.present[:, columns], axis=1)
    fewer = poses.known & (counts < len(reference.landmarks))
    if fewer.any():
        yield (
            f"{_frames(fewer)} aligned by fewer than the {len(reference.landmarks)} landmarks, "
            f"{counts[fewer].min()} in the worst, as others are missing"
        )
    if np.any(poses.states == FEW):
        few = _frames(poses.states == FEW)
        yield f"{few} left as they are, with fewer than {FEWEST} landmarks"
    if np.any(poses.states == LINE):
        yield f"{_frames(poses.states == LINE)} left as they are, with landmarks on a line"
    if np.any(poses.states == MIRRORED):
        yield (
            f"{_frames(poses.states == MIRRORED)} fit badly where a mirror image would fit well: "
            "have left and right changed places?"
        )


def _frames(which: NDArray[np.bool_]) -> str:
    return f"{np.count_nonzero(which)} of {len(which)} frames (first {np.argmax(which)})"

"""The face to which others are aligned."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nodegraph import Refusal, listed
from nodegraph_align.landmarks import FEWEST, landmarks_of
from nodegraph_mocap import Trajectories

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

_ON_A_LINE = 1e-3
"""Least ratio of squared second to first extent of points that determine a rotation."""

_IN_ONE_PLACE = 1e-9
"""Extent relative to the distance from the origin, below which it is rounding."""


class Reference(NamedTuple):
    """One frame, and its landmarks.

    Attributes
    ----------
    frame : Trajectories
        One frame, with all its markers.
    landmarks : tuple of L str
        Present in it.
    shape : (L, 3) array of float64
        Where they are.
    """

    frame: Trajectories
    landmarks: tuple[str, ...]
    shape: NDArray[np.float64]

    def columns(self, recording: Trajectories) -> NDArray[np.intp]:
        """Return which of a recording's markers are the landmarks, (L,)."""
        return np.array([recording.markers.index(name) for name in self.landmarks])

    @property
    def centre(self) -> NDArray[np.float64]:
        """(3,), the landmarks' mean."""
        return np.asarray(self.shape.mean(axis=0))

    @property
    def size(self) -> float:
        """Root of the landmarks' mean squared distance from their mean (eq 2)."""
        return float(np.sqrt(np.mean(((self.shape - self.centre) ** 2).sum(axis=1))))


def reference_of(
    recording: Trajectories, reference: Trajectories | None, names: Sequence[str] | None
) -> tuple[Reference, list[str]]:
    """Return the first frame that has all landmarks, and notes for the user.

    Of a reference that is given and has no such frame, it is the fullest one, the first of equals,
    with the landmarks that it has.

    Parameters
    ----------
    recording
        Whose own frame it is where no reference is given.
    reference
        A recording of one frame or several, or None.
    names
        The landmarks that the user chose, or None.

    Raises
    ------
    ValueError
        As `landmarks_of`.
    Refusal
        If there is no frame with all landmarks and no reference is given, or there are fewer than
        three, or they lie on a line or in one place.
    """
    landmarks, notes = landmarks_of(recording, reference, names)
    source = recording if reference is None else reference
    columns = [source.markers.index(name) for name in landmarks]
    if not source.frames:
        raise Refusal("needs a frame to align to, and there is none")
    place = source.present[:, columns]
    number = int(place.sum(axis=1).argmax())
    there = place[number]
    lacking = [name for name, known in zip(landmarks, there, strict=True) if not known]
    if lacking and reference is None:
        raise Refusal(_incomplete(number, lacking, landmarks))
    if lacking:
        notes.append(
            f"{len(lacking)} landmarks are missing in the reference and are none: {listed(lacking)}"
        )
    shape = source.positions[number, columns][there]
    check_shape(shape)
    kept = tuple(name for name in landmarks if name not in lacking)
    return Reference(source[number : number + 1], kept, shape), notes


def check_shape(shape: NDArray[np.float64]) -> None:
    """Refuse landmarks, (L, 3), that nothing can be aligned to.

    Raises
    ------
    Refusal
        If they are fewer than three, on a line or in one place.
    """
    if len(shape) < FEWEST:
        raise Refusal(f"needs {FEWEST} landmarks in the frame to align to, which has {len(shape)}")
    middle = shape.mean(axis=0)
    extents = np.linalg.svd(shape - middle, compute_uv=False)
    if extents[0] <= _IN_ONE_PLACE * np.linalg.norm(middle):
        raise Refusal("the landmarks of the frame to align to are all in one place")
    if extents[1] ** 2 <= _ON_A_LINE * extents[0] ** 2:
        raise Refusal("the landmarks of the frame to align to lie on a line")


def _incomplete(number: int, lacking: Sequence[str], landmarks: Sequence[str]) -> str:
    return (
        f"needs a frame that has all {len(landmarks)} landmarks: the fullest, frame {number}, "
        f"lacks {listed(lacking)}; give a reference, name other `landmarks`, or fill their gaps"
    )

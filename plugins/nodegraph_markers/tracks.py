"""Tracks, the shape to whose places they are assigned, and where each marker is expected."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nodegraph_markers.rigid import RigidMotions, fit_robustly, spacing

if TYPE_CHECKING:
    from numpy.typing import NDArray

UNNAMED = -1
_REACH = 1.5
"""Times the spacing: how far the movement of one marker bears on another's expected place."""
_LITTLE = 1e-3
"""Weight of no movement, which counts where no neighbour is known."""


class Expectation(NamedTuple):
    """Poses and expected places in every frame, by the named tracks.

    Attributes
    ----------
    poses : RigidMotions
        From the recording onto the shape.
    places : (T, M, 3) array of float64
        Where each marker is expected, on the shape.
    """

    poses: RigidMotions
    places: NDArray[np.float64]


@dataclass(frozen=True)
class Tracks:
    """Tracks, and a shape.

    A marker is expected where the shape has it, moved as the markers around it that have names
    are displaced in that frame. That place does not depend on the track that bears the marker's
    own name, so that a wrong name gives way.

    Attributes
    ----------
    positions : (T, K, 3) array of float64
        The tracks, mm; NaN where missing.
    present : (T, K) array of bool
    shape : (M, 3) array of float64
        Places, none of them NaN.
    gate : float
        Millimetres.
    """

    positions: NDArray[np.float64]
    present: NDArray[np.bool_]
    shape: NDArray[np.float64]
    gate: float

    @property
    def fewest(self) -> int:
        """Number of named points that a frame needs to have a pose."""
        return min(4, len(self.shape))

    @cached_property
    def frames(self) -> list[NDArray[np.intp]]:
        """The frames of each track."""
        return [np.flatnonzero(column) for column in self.present.T]

    @cached_property
    def _nearness(self) -> NDArray[np.float64]:
        """(M, M), how much one marker's movement says of another's; 0 of its own."""
        apart = np.linalg.norm(self.shape[:, np.newaxis] - self.shape, axis=2)
        near = np.exp(-0.5 * (apart / (_REACH * spacing(self.shape))) ** 2)
        np.fill_diagonal(near, 0.0)
        return np.asarray(near)

    def marked(self, named: NDArray[np.intp]) -> NDArray[np.float64]:
        """Return the tracks by place, (T, M, 3), the longest where several share a frame.

        Parameters
        ----------
        named
            (K,), the number of the place that each track is, or -1.
        """
        marked = np.full((len(self.present), len(self.shape), 3), np.nan)
        for column in np.argsort(self.present.sum(axis=0), kind="stable"):
            if named[column] != UNNAMED:
                frames = self.frames[column]
                marked[frames, named[column]] = self.positions[frames, column]
        return marked

    def poses(self, named: NDArray[np.intp]) -> RigidMotions:
        """Return the pose of each frame, by the named tracks."""
        return self._poses(self.marked(named))

    def expectation(self, named: NDArray[np.intp]) -> Expectation:
        """Return where each marker is expected in each frame."""
        marked = self.marked(named)
        poses = self._poses(marked)
        there = ~np.isnan(marked[..., 0])
        moved = np.where(there[..., np.newaxis], poses.apply(marked) - self.shape, 0.0)
        weight = there @ self._nearness + _LITTLE
        total = np.stack([moved[..., axis] @ self._nearness for axis in range(3)], axis=-1)
        return Expectation(poses, self.shape + total / weight[..., np.newaxis])

    def distances(
        self, expectation: Expectation, frame: NDArray[np.intp], track: NDArray[np.intp] | int
    ) -> NDArray[np.float64]:
        """Return the distances of samples from where each marker is expected, (N, M).

        Parameters
        ----------
        expectation
            Where the markers are expected.
        frame, track
            (N,), the samples, which are present in frames that have a pose.
        """
        rotations, translations, _ = expectation.poses
        turned = (rotations[frame] @ self.positions[frame, track][..., np.newaxis])[..., 0]
        onto = (turned + translations[frame])[:, np.newaxis]
        return np.asarray(np.linalg.norm(onto - expectation.places[frame], axis=2))

    def _poses(self, marked: NDArray[np.float64]) -> RigidMotions:
        there = ~np.isnan(marked[..., 0])
        return fit_robustly(marked, self.shape, there, width=self.gate, fewest=self.fewest)

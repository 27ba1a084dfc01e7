"""Gap events in bursts, as occlusions come: the same few neighbours, several times in a row."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_gaps.groups import contiguous
from nodegraph_mocap.reference_shape import reference_shape

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_gaps.groups import Event, Groups
    from nodegraph_mocap import Trajectories

# of 34 gaps of a body at 100 Hz, the only real ones available: 4 bursts, of 2 to 4 markers each
EVENTS = 8
"""Mean number of events of a burst."""
NEIGHBOURS = 4
"""Markers around which the events of a burst lie."""
SPREAD = 0.2
"""Seconds, standard deviation of the events of a burst around its middle."""

WEIGHT = 4.0
"""Weight of markers of the mouth and the eyelids; that of others is 1."""
_OCCLUDED = {"mouth", "lip", "lips", "eyelid", "eyelids", "lid", "lids"}
_WORD = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])")
_TRIES = 100


class Bursts:
    """Events in bursts; one after the other is drawn, so that it knows the burst that it is in.

    Parameters
    ----------
    recording
        Where the events are placed.
    size
        Markers of an event.
    """

    def __init__(self, recording: Trajectories, size: int) -> None:
        shape = reference_shape(recording)
        self._groups: Groups = contiguous(shape, size)
        members = self._groups.members
        centres = members[:, 0]
        self._weights = _weights(recording)[centres]
        self._near = contiguous(shape[centres], min(NEIGHBOURS, len(centres))).members
        self._spread = SPREAD * recording.rate
        self._left = 0
        self._centre = 0
        self._middle = 0.0

    def draw(self, free: NDArray[np.bool_], random: np.random.Generator) -> Event | None:
        """Draw the next event of the burst, or the first of another one; see `AnyMarkers.draw`."""
        members = self._groups.members
        for _ in range(_TRIES if len(members) and len(free) else 0):
            if not self._left:
                self._left = int(random.geometric(1.0 / EVENTS))
                self._centre = int(
                    random.choice(len(members), p=self._weights / self._weights.sum())
                )
                self._middle = random.uniform(0.0, len(free))
            self._left -= 1
            group = members[random.choice(self._near[self._centre])]
            when = random.normal(self._middle, self._spread)
            starts = np.flatnonzero(free[:, group].all(axis=1))
            if len(starts):
                return int(starts[np.abs(starts - when).argmin()]), group
        return self._groups.draw(free, random)

    def draw_at(
        self, free: NDArray[np.bool_], random: np.random.Generator
    ) -> NDArray[np.intp] | None:
        """Draw markers among those that are free; see `Groups.draw_at`."""
        return self._groups.draw_at(free, random)


def _weights(recording: Trajectories) -> NDArray[np.float64]:
    """Return how often bursts centre on each marker, (M,), up to a factor."""
    occluded = [
        not _OCCLUDED.isdisjoint(word.lower() for word in _WORD.findall(name))
        for name in recording.markers
    ]
    if any(occluded):
        return np.where(occluded, WEIGHT, 1.0)
    return _speeds(recording)


def _speeds(recording: Trajectories) -> NDArray[np.float64]:
    """Return each marker's mean step in mm, the mean step of all markers taken off."""
    present = recording.present[1:] & recording.present[:-1]
    steps = np.where(present[..., None], np.diff(recording.positions, axis=0), 0.0)
    counts = np.maximum(np.count_nonzero(present, axis=1), 1)
    steps -= steps.sum(axis=1, keepdims=True) / counts[:, None, None]
    lengths = np.where(present, np.linalg.norm(steps, axis=2), 0.0)
    speeds = lengths.sum(axis=0) / np.maximum(np.count_nonzero(present, axis=0), 1)
    return speeds if speeds.any() else np.ones(len(recording.markers))

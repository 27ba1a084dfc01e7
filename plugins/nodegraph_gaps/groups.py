"""Groups of markers that one gap event may hide together."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Event = tuple[int, NDArray[np.intp]]
    """First frame, markers."""

DIRECTIONS = 8
"""Directions drawn for `region`: enough that hardly two events of a take share one."""


@dataclass(frozen=True)
class AnyMarkers:
    """Any markers, `size` at a time."""

    size: int

    def draw(self, free: NDArray[np.bool_], random: np.random.Generator) -> Event | None:
        """Draw a free place uniformly, and the other markers among those free at that time.

        Parameters
        ----------
        free : (S, M) array of bool
            Where an event may begin.
        random
            The source of chance.

        Returns
        -------
        (first frame, markers) or None
            None when no place is left.
        """
        room = free.sum(axis=1)
        places = np.cumsum(np.where(room >= self.size, room, 0))
        if not len(places) or not places[-1]:
            return None
        start = int(np.searchsorted(places, random.integers(places[-1]), side="right"))
        markers = random.choice(np.flatnonzero(free[start]), self.size, replace=False)
        return start, markers

    def draw_at(
        self, free: NDArray[np.bool_], random: np.random.Generator
    ) -> NDArray[np.intp] | None:
        """Draw markers among those that are free, an (M,) array; None if there are too few."""
        there = np.flatnonzero(free)
        if len(there) < self.size:
            return None
        return random.choice(there, self.size, replace=False)


@dataclass(frozen=True)
class Groups:
    """One of some groups of markers.

    Attributes
    ----------
    members : (G, size) array of int
        The markers of each group.
    """

    members: NDArray[np.intp]

    @cached_property
    def _clash(self) -> NDArray[np.bool_]:
        """(G, G), True where two groups have a marker in common."""
        inside = np.zeros((len(self.members), self.members.max(initial=0) + 1), dtype=np.float32)
        np.put_along_axis(inside, self.members, 1.0, axis=1)
        return np.asarray(inside @ inside.T > 0)

    def draw(self, free: NDArray[np.bool_], random: np.random.Generator) -> Event | None:
        """Draw a group that has a place left, then one of its places; see `AnyMarkers.draw`."""
        for group in random.permutation(len(self.members)):
            starts = np.flatnonzero(free[:, self.members[group]].all(axis=1))
            if len(starts):
                return int(random.choice(starts)), self.members[group]
        return None

    def draw_at(
        self, free: NDArray[np.bool_], random: np.random.Generator
    ) -> NDArray[np.intp] | None:
        """Draw among the free groups that stand in the way of fewest others, to pack densely."""
        there = np.flatnonzero(free[self.members].all(axis=1))
        if not len(there):
            return None
        crowding = self._clash[np.ix_(there, there)].sum(axis=1)
        chosen: NDArray[np.intp] = self.members[random.choice(there[crowding == crowding.min()])]
        return chosen


def contiguous(shape: NDArray[np.float64], size: int) -> Groups:
    """Return, for each marker, the group of it and those nearest to it.

    Parameters
    ----------
    shape : (M, 3) array of float64
        Where the markers lie; one that is NaN is in no group.
    size
        Markers of a group. There is none if fewer markers have a place.
    """
    known, distance = _distances(shape)
    return Groups(_nearest(known, np.argsort(distance, axis=1, kind="stable"), size))


def region(shape: NDArray[np.float64], size: int, random: np.random.Generator) -> Groups:
    """Return, for each marker and some random directions, those nearest to it on that side.

    A marker n is on the side of marker c in direction u when ``(x_n - x_c) . u >= 0``. Where
    that side has too few markers, the nearest of the other side follow.

    Parameters
    ----------
    shape : (M, 3) array of float64
        Where the markers lie; one that is NaN is in no group.
    size
        Markers of a group. There is none if fewer markers have a place.
    random
        The source of chance.
    """
    known, distance = _distances(shape)
    along = shape[known] @ random.normal(size=(DIRECTIONS, 3)).T
    behind = along[None, :, :] < along[:, None, :]
    order = [np.lexsort((distance, behind[..., side]), axis=1) for side in range(DIRECTIONS)]
    return Groups(_nearest(known, np.concatenate(order), size))


def _distances(shape: NDArray[np.float64]) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    known = np.flatnonzero(~np.isnan(shape).any(axis=1))
    places = shape[known]
    distance = np.linalg.norm(places[:, None] - places, axis=2)
    np.fill_diagonal(distance, -1.0)
    return known, distance


def _nearest(known: NDArray[np.intp], order: NDArray[np.intp], size: int) -> NDArray[np.intp]:
    if len(known) < size:
        return np.zeros((0, size), dtype=np.intp)
    return known[order[:, :size]]

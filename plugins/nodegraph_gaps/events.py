"""Where gaps can lie, and drawing places for them until all lie somewhere."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


class Free:
    """The places at which a gap of one length can still begin.

    Parameters
    ----------
    measured : (T, M) array of bool
        Samples that may be hidden.
    length
        Frames of a gap.
    at_end
        Whether a gap must end with the take, and so needs no sample on its right.
    """

    def __init__(self, measured: NDArray[np.bool_], length: int, *, at_end: bool) -> None:
        self.hidden = np.zeros_like(measured)
        self._left = measured.copy()
        self._length = length
        self._at_end = at_end
        self.starts = np.zeros_like(measured)
        for marker in range(measured.shape[1]):
            self._find_starts(marker)

    def again(self) -> Free:
        """Return the places as they were before any gap was cut."""
        return Free(self._left | self.hidden, self._length, at_end=self._at_end)

    def hide(self, start: int, markers: NDArray[np.intp]) -> None:
        """Cut one event."""
        frames = slice(start, start + self._length)
        self.hidden[frames, markers] = True
        self._left[frames, markers] = False
        for marker in markers:
            self._find_starts(int(marker))

    def _find_starts(self, marker: int) -> None:
        """Mark the frames from which a gap and a sample on each side of it are there."""
        column, starts = self._left[:, marker], self.starts[:, marker]
        starts[:] = False
        window = self._length + (1 if self._at_end else 2)
        if window > len(column):
            return
        there = np.concatenate([[0], np.cumsum(column)])
        fits = there[window:] - there[:-window] == window
        if self._at_end:
            starts[len(column) - self._length] = fits[-1]
        else:
            starts[1 : 1 + len(fits)] = fits


def place_events(
    free: Free,
    groups: NDArray[np.intp] | None,
    count: int,
    size: int,
    random: np.random.Generator,
) -> NDArray[np.bool_]:
    """Return the samples that `count` events hide, (T, M).

    Each event takes one of the places that are left, all equally likely. Where the last events
    find none, because the first ones lie unluckily, all are packed as early as they go.

    Raises
    ------
    ValueError
        If even packed they do not fit.
    """
    packed = free.again()
    if _place(free, groups, count, size, random, packed=False) == count:
        return free.hidden
    fitting = _place(packed, groups, count, size, random, packed=True)
    if fitting < count:
        raise ValueError(
            f"{count} gap events asked, {fitting} fit: ask for fewer or shorter ones, or for "
            "fewer markers at once"
        )
    return packed.hidden


def _place(
    free: Free,
    groups: NDArray[np.intp] | None,
    count: int,
    size: int,
    random: np.random.Generator,
    *,
    packed: bool,
) -> int:
    """Cut up to `count` events and return how many found a place."""
    for placed in range(count):
        starts = _group_starts(free.starts, groups, size)
        places = np.flatnonzero(starts)
        if not len(places):
            return placed
        # places are in order of time, so that the first is the earliest
        chosen = int(places[0] if packed else random.choice(places))
        start, which = divmod(chosen, starts.shape[1])
        free.hide(start, _markers(free.starts[start], which, groups, size, random))
    return count


def _group_starts(
    starts: NDArray[np.bool_], groups: NDArray[np.intp] | None, size: int
) -> NDArray[np.bool_]:
    """Return where an event can begin: per frame and group, or per frame and first marker."""
    if groups is None:
        return np.asarray(starts & (np.count_nonzero(starts, axis=1) >= size)[:, None])
    return np.asarray(np.logical_and.reduce([starts[:, column] for column in groups.T]))


def _markers(
    possible: NDArray[np.bool_],
    which: int,
    groups: NDArray[np.intp] | None,
    size: int,
    random: np.random.Generator,
) -> NDArray[np.intp]:
    if groups is not None:
        return np.asarray(groups[which])
    others = np.flatnonzero(possible)
    others = others[others != which]
    return np.append(which, random.choice(others, size - 1, replace=False)).astype(np.intp)

"""The placement of gap events."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_gaps.bursts import Bursts
    from nodegraph_gaps.groups import AnyMarkers, Event, Groups
    from nodegraph_mocap import Trajectories


def free_places(recording: Trajectories, length: int, *, at_end: bool) -> NDArray[np.bool_]:
    """Return where a gap of some length may begin.

    Parameters
    ----------
    recording
        Trajectories, with or without gaps of their own.
    length
        Frames of the gap.
    at_end
        Whether the gap must reach the last frame, or must end before it.

    Returns
    -------
    (T - length + 1, M) array of bool
        True where `length` measured samples begin, with a present sample on each side (at the
        take's end: before them).
    """
    frames, markers = recording.origin.shape
    starts = max(frames - length + 1, 0)
    free = np.zeros((starts, markers), dtype=np.bool_)
    if starts < 2:
        return free
    measured = np.zeros((frames + 1, markers), dtype=np.int64)
    np.cumsum(recording.measured, axis=0, out=measured[1:])
    whole = measured[length:] - measured[:-length] == length
    present = recording.present
    if at_end:
        free[-1] = whole[-1] & present[-length - 1]
    else:
        free[1:-1] = whole[1:-1] & present[: starts - 2] & present[length + 1 :]
    return free


def place_events(
    free: NDArray[np.bool_],
    length: int,
    count: int,
    groups: AnyMarkers | Groups | Bursts,
    random: np.random.Generator,
) -> tuple[list[Event], int]:
    """Place events so that none hides a sample of another one or beside it.

    Parameters
    ----------
    free
        Where an event may begin, from `free_places`.
    length
        Frames of an event.
    count
        How many events.
    groups
        The markers that an event may hide.
    random
        The source of chance.

    Returns
    -------
    list of (first frame, markers), int
        The events, and how many could be placed: `count`, or fewer where they do not fit.
    """
    chance, packing = random.spawn(2)
    drawn = _drawn(free.copy(), length, count, groups, chance)
    if len(drawn) == count:
        return drawn, count
    packed = _packed(free.copy(), length, groups, packing)
    if len(packed) < count:
        return [], max(len(drawn), len(packed))
    chosen = packing.choice(len(packed), count, replace=False)
    return [packed[index] for index in chosen], count


def _drawn(
    free: NDArray[np.bool_],
    length: int,
    count: int,
    groups: AnyMarkers | Groups | Bursts,
    random: np.random.Generator,
) -> list[Event]:
    events: list[Event] = []
    while len(events) < count and (event := groups.draw(free, random)) is not None:
        events.append(event)
        _take(free, length, event)
    return events


def _packed(
    free: NDArray[np.bool_],
    length: int,
    groups: AnyMarkers | Groups | Bursts,
    random: np.random.Generator,
) -> list[Event]:
    """Pack as many events as go, each as early as it can be.

    For events of one marker no arrangement holds more.
    """
    events: list[Event] = []
    for start in np.flatnonzero(free.any(axis=1)):
        while (markers := groups.draw_at(free[start], random)) is not None:
            events.append((int(start), markers))
            _take(free, length, events[-1])
    return events


def _take(free: NDArray[np.bool_], length: int, event: Event) -> None:
    start, markers = event
    free[max(start - length, 0) : start + length + 1, markers] = False

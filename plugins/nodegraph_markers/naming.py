"""Assignment of tracks to markers: poses, expected places and names, in alternation."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_markers.registration import Match, closest, register
from nodegraph_markers.rigid import fit_robustly
from nodegraph_markers.tracks import UNNAMED, Tracks

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

_ROUNDS, _SAMPLES, _TRIED = 40, 24, 16
ENOUGH = 4
"""A frame can be a start when it has points at one in this many places of the shape."""
_FULL = 0.9


def names(tracks: Tracks) -> NDArray[np.intp]:
    """Return the number of the place that each track is, (K,), or -1.

    Begins at the frame that looks most like the shape, continues until no name changes, and begins
    again where frames are left that no named track reaches.
    """
    named = np.full(tracks.present.shape[1], UNNAMED)
    reached = np.zeros(len(tracks.present), dtype=np.bool_)
    while (start := _start(tracks, ~reached)) is not None:
        frame, match = start
        named[np.flatnonzero(tracks.present[frame])[match.point]] = match.place
        named = _settled(tracks, named)
        before, reached = reached, reached | tracks.poses(named).known
        if np.array_equal(before, reached):
            break
    return named


def track_distances(tracks: Tracks, named: NDArray[np.intp]) -> NDArray[np.float64]:
    """Return the median distance from each track to where each marker is expected, (K, M).

    Over up to 24 frames of a track, evenly spread among those that have a pose; infinite where
    none has.
    """
    expectation = tracks.expectation(named)
    frames, seen = _sampled(tracks, expectation.poses.known)
    columns = np.flatnonzero(seen)
    distances = np.full((len(seen), len(tracks.shape)), np.inf)
    if len(columns):
        every = [tracks.distances(expectation, frame, columns) for frame in frames[columns].T]
        distances[columns] = np.median(every, axis=0)
    return distances


def _settled(tracks: Tracks, named: NDArray[np.intp]) -> NDArray[np.intp]:
    seen = {named.tobytes()}
    for _ in range(_ROUNDS):
        named = assign(track_distances(tracks, named), tracks.present, tracks.gate)
        if named.tobytes() in seen:
            break
        seen.add(named.tobytes())
    return named


def _start(tracks: Tracks, allowed: NDArray[np.bool_]) -> tuple[int, Match] | None:
    """Return the frame among those allowed that fits the shape best, and how it fits.

    The fullest frame is registered whatever its pose; from there the tracks lead to others,
    which may show less expression. None where no frame has enough points, or they do not fit.
    """
    counts = np.where(allowed, tracks.present.sum(axis=1), 0)
    enough = max(3, tracks.fewest, len(tracks.shape) // ENOUGH)
    if counts.max(initial=0) < enough:
        return None
    full = int(np.argmax(counts))
    match = register(_points(tracks, full), tracks.shape, tracks.gate)
    if match is None:
        return None
    candidates = [(full, match), *_later_matches(tracks, full, match, counts)]
    frame, best = min(candidates, key=lambda candidate: candidate[1].cost)
    return (frame, best) if len(best.point) >= enough else None


def _later_matches(
    tracks: Tracks, full: int, match: Match, counts: NDArray[np.intp]
) -> Iterator[tuple[int, Match]]:
    """Yield other full frames, and how they fit in the pose to which the tracks lead."""
    frames = np.flatnonzero(counts >= _FULL * counts[full])
    frames = frames[np.unique(np.linspace(0, len(frames) - 1, _TRIED).astype(np.intp))]
    there = tracks.present[full]
    way = fit_robustly(
        tracks.positions[frames][:, there],
        tracks.positions[full, there],
        tracks.present[frames][:, there],
        width=tracks.gate,
        fewest=tracks.fewest,
    )
    for number in np.flatnonzero(way.known):
        rotation = match.rotation @ way.rotations[number]
        translation = match.rotation @ way.translations[number] + match.translation
        points = _points(tracks, int(frames[number]))
        later = closest(points, tracks.shape, rotation, translation, tracks.gate)
        yield int(frames[number]), later


def _points(tracks: Tracks, frame: int) -> NDArray[np.float64]:
    return np.asarray(tracks.positions[frame, tracks.present[frame]])


def _sampled(
    tracks: Tracks, known: NDArray[np.bool_]
) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Return up to 24 frames of each track that have a pose, (K, 24), and which have any."""
    frames = np.zeros((len(tracks.frames), _SAMPLES), dtype=np.intp)
    seen = np.zeros(len(tracks.frames), dtype=np.bool_)
    for column, own in enumerate(tracks.frames):
        posed = own[known[own]]
        if len(posed):
            frames[column] = posed[np.linspace(0, len(posed) - 1, _SAMPLES).astype(np.intp)]
            seen[column] = True
    return frames, seen


def assign(
    distances: NDArray[np.float64], present: NDArray[np.bool_], gate: float
) -> NDArray[np.intp]:
    """Return each track's place, (K,), or -1: the best assignment, in rounds.

    A track at distance d from a place, with n frames that no track of the place has yet, is
    worth ``n (1 - (d / gate)^2)`` there, or nothing if these are less than half of its own. In
    each round every place gets one track at most, by `scipy.optimize.linear_sum_assignment`, so
    that the sum is largest; a track that would still be worth more at another place waits for
    the next.

    Parameters
    ----------
    distances
        (K, M) mm.
    present
        (T, K), the frames of each track.
    gate
        Millimetres.
    """
    from scipy.optimize import linear_sum_assignment

    nearness = np.maximum(0.0, 1.0 - (np.minimum(distances, gate) / gate) ** 2)
    named = np.full(len(nearness), UNNAMED)
    taken = np.zeros((len(present), distances.shape[1]), dtype=np.bool_)
    while (worth := _worth(nearness, present, taken)).any():
        track, place = linear_sum_assignment(worth, maximize=True)
        useful = worth[track, place] > 0
        track, place = track[useful], place[useful]
        after = taken.copy()
        after[:, place] |= present[:, track]
        later = _worth(nearness[track], present[:, track], after).max(axis=1)
        now = worth[track, place] >= later
        now |= not now.any()
        named[track[now]] = place[now]
        taken[:, place[now]] |= present[:, track[now]]
        nearness[track[now]] = 0.0
    return named


def _worth(
    nearness: NDArray[np.float64], present: NDArray[np.bool_], taken: NDArray[np.bool_]
) -> NDArray[np.float64]:
    length = present.sum(axis=0)[:, np.newaxis]
    # in float32 the product is one of BLAS, and counts up to 16 million frames are exact
    shared = present.T.astype(np.float32) @ taken.astype(np.float32)
    return np.where(2 * shared <= length, (length - shared) * nearness, 0.0)

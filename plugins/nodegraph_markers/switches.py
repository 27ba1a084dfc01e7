"""Tracks that switch from one marker to another: where to cut them, and which samples stay."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_markers.tracks import UNNAMED, Expectation, Tracks

if TYPE_CHECKING:
    from numpy.typing import NDArray

_SHORTEST = 3


def cut(tracks: Tracks, named: NDArray[np.intp]) -> tuple[Tracks, NDArray[np.intp]]:
    """Return the tracks cut where they switch, and the track that each piece is of.

    A sample is at another marker when it is more than half the gate from where its own is
    expected, and less than half as far from where that one is. Three or more such samples in
    sequence, all at one marker, are cut out, if tracks are at home at that marker elsewhere, but
    in less than half of these frames; otherwise the face itself has moved. All samples of a track
    at one marker are one piece.

    Parameters
    ----------
    tracks
        K tracks.
    named
        (K,), the place that each track is, or -1.
    """
    expectation = tracks.expectation(named)
    places = [_places(tracks, expectation, track, own) for track, own in enumerate(named.tolist())]
    home = np.zeros((len(tracks.present), len(tracks.shape)), dtype=np.bool_)
    for frames, place, own in zip(tracks.frames, places, named.tolist(), strict=True):
        home[frames[place == own], own] |= own != UNNAMED
    owner: list[int] = []
    pieces: list[NDArray[np.intp]] = []
    for track, (frames, place) in enumerate(zip(tracks.frames, places, strict=True)):
        for part in _parts(frames, place, int(named[track]), home):
            owner.append(track)
            pieces.append(part)
    return _taken_apart(tracks, owner, pieces), np.array(owner, dtype=np.intp)


def nearest_samples(tracks: Tracks, named: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Return which samples keep their track's name, (T, K).

    Of several tracks of a marker, in a frame that they share, the one that is nearer to where
    the marker is expected keeps its sample; without an expected place, the earlier one.
    """
    expectation = tracks.expectation(named)
    nearest = np.full((len(tracks.present), len(tracks.shape)), np.inf)
    holder = np.full(nearest.shape, UNNAMED)
    for track in np.flatnonzero(named != UNNAMED).tolist():
        frames, place = tracks.frames[track], named[track]
        apart = _apart(tracks, expectation, track)[:, place]
        better = (apart < nearest[frames, place]) | (holder[frames, place] == UNNAMED)
        nearest[frames[better], place] = apart[better]
        holder[frames[better], place] = track
    frame, place = np.nonzero(holder != UNNAMED)
    stays = np.zeros_like(tracks.present)
    stays[frame, holder[frame, place]] = True
    return stays


def _places(tracks: Tracks, expectation: Expectation, track: int, own: int) -> NDArray[np.intp]:
    """Return which marker a track's samples are at, (n,)."""
    frames = tracks.frames[track]
    if own == UNNAMED:
        return np.full(len(frames), UNNAMED)
    apart = _apart(tracks, expectation, track)
    nearest = apart.argmin(axis=1)
    least = apart[np.arange(len(apart)), nearest]
    away = (apart[:, own] > 0.5 * tracks.gate) & (least < 0.5 * apart[:, own])
    place = np.where(away & expectation.poses.known[frames], nearest, own)
    run = np.cumsum(np.diff(place, prepend=place[:1]) != 0)
    return np.where(np.bincount(run)[run] < _SHORTEST, own, place)


def _parts(
    frames: NDArray[np.intp], place: NDArray[np.intp], own: int, home: NDArray[np.bool_]
) -> list[NDArray[np.intp]]:
    """Return the frames of each piece of a track, those at its own place first (or none)."""
    visits = {int(other): frames[place == other] for other in np.unique(place[place != own])}
    cut_out = [
        part
        for other, part in visits.items()
        if home[:, other].any() and 2 * np.count_nonzero(home[part, other]) < len(part)
    ]
    rest = np.setdiff1d(frames, np.concatenate([np.empty(0, np.intp), *cut_out]))
    return [rest, *cut_out]


def _taken_apart(tracks: Tracks, owner: list[int], pieces: list[NDArray[np.intp]]) -> Tracks:
    positions = np.full((len(tracks.present), len(pieces), 3), np.nan)
    for column, (track, frames) in enumerate(zip(owner, pieces, strict=True)):
        positions[frames, column] = tracks.positions[frames, track]
    present = ~np.isnan(positions[..., 0])
    return Tracks(positions, present, tracks.shape, tracks.gate)


def _apart(tracks: Tracks, expectation: Expectation, track: int) -> NDArray[np.float64]:
    frames = tracks.frames[track]
    return tracks.distances(expectation, frames, np.full(len(frames), track))

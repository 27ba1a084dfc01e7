"""Names for tracks, from a reference whose markers have names."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Annotated, TypeVar

import numpy as np
from pydantic import Field

from nodegraph import Refusal, Unit, listed, node
from nodegraph_markers.naming import ENOUGH, names, track_distances
from nodegraph_markers.rigid import on_a_line, spacing
from nodegraph_markers.tracks import UNNAMED, Expectation, Tracks
from nodegraph_mocap import Origin, Trajectories
from nodegraph_mocap.reference_shape import reference_shape

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from nodegraph_mocap import MarkerSet

_Scalar = TypeVar("_Scalar", bound=np.generic)

_FEWEST = 3
_SHORTEST = 3
"""Samples in sequence at another marker that make a switch."""
_ALIKE = 0.3
"""Distance from the expected place, in spacings, above which a face is not the reference's: at
most 0.21 on takes with their own first frame, 0.36 and more on takes of something else."""


@node("markers.label", cite=("besl_mckay1992", "kabsch1976"))
def label(
    recording: Trajectories,
    reference: Trajectories,
    *,
    gate: Annotated[float, Field(gt=0), Unit("mm")] | None = None,
) -> Trajectories:
    """Give tracks the names of a reference's markers: rigid fit, best assignment of whole tracks.

    The names that the tracks have mean nothing, nor does the head's pose. The fullest frame is
    aligned with the reference's shape by trying rotations all around (never a mirror image) and
    iterative closest points (Besl & McKay); the tracks lead from there to the frame that looks
    most like the reference, where the first names are given. Then in turns, until no name
    changes:

    - each frame's pose is fitted to the reference (Kabsch), markers that expression has moved
      counting less;
    - each marker is expected where the reference has it, moved as the named markers around it
      are displaced in that frame;
    - a track's distance d from a marker is the median over its frames (up to 24 of them, evenly
      spread); tracks of n frames are assigned so that the sum of ``n (1 - (d / gate)^2)`` is
      largest, by `scipy.optimize.linear_sum_assignment`.

    Tracks that share less than half of their frames may be the same marker, and are joined under
    its name; in a frame that they share, the nearer one keeps the sample. Where a track goes over
    to a marker that no other track is at then (for three samples or more half the gate off, and
    twice as near to that one) it is cut, and all is named again. What is left keeps its samples
    under t000, t001, ..., behind the named markers, in the order of the tracks. A marker of the
    reference that no track is stays in the recording, wholly missing. Both are counted in a
    warning, and a take that hardly looks like the reference in another.

    Looks at the whole take.

    Parameters
    ----------
    recording
        Tracks, in any order, pose and number, with or without gaps.
    reference
        Markers with names, and a marker set if there is one; of several frames the most complete
        one, usually of a face at rest.
    gate
        How far from where it is expected a track may be. None: the median distance from a marker
        of the reference to the nearest other one.

    Returns
    -------
    Trajectories
        All samples of the recording, none moved: the reference's markers, then what is left;
        with the reference's marker set.

    Raises
    ------
    Refusal
        If no frame has enough points that fit the reference: three, and a quarter of its markers.
    """
    shape = reference_shape(reference)
    known = np.flatnonzero(~np.isnan(shape[:, 0]))
    if len(known) < _FEWEST or on_a_line(shape[known]):
        raise Refusal(
            f"needs a reference of {_FEWEST} markers that are ever present and not on a line; "
            f"{len(known)} are"
        )
    width = spacing(shape) if gate is None else gate
    tracks = Tracks(recording.positions, recording.present, shape[known], width)
    place, doubt = _places(tracks)
    left = np.flatnonzero((recording.present & (place == UNNAMED)).any(axis=0))
    behind = len(reference.markers) + np.searchsorted(left, np.arange(len(recording.markers)))
    markers = (*reference.markers, *_free_names(len(left), reference.markers))
    messages = [
        *_messages(recording, reference.markers, np.where(place < 0, place, known[place])),
        *doubt,
    ]
    if messages:
        warnings.warn("; ".join(messages), stacklevel=2)
    column = np.where(place == UNNAMED, behind, known[place])
    return _moved(recording, column, markers, reference.marker_set)


def _places(tracks: Tracks) -> tuple[NDArray[np.intp], list[str]]:
    """Return the place in the shape of each sample, (T, K), or -1; and the doubtful ones."""
    named = names(tracks)
    if not (named != UNNAMED).any():
        raise Refusal(
            f"no frame fits the reference: in none do {max(_FEWEST, len(tracks.shape) // ENOUGH)} "
            f"points come within {tracks.gate:.1f} mm of its {len(tracks.shape)} markers, however "
            "it is turned"
        )
    pieces, owner = cut(tracks, named)
    marker_of = names(pieces) if len(owner) > len(named) else named
    frame, piece = np.nonzero(nearest_samples(pieces, marker_of))
    place = np.full(tracks.present.shape, UNNAMED)
    place[frame, owner[piece]] = marker_of[piece]
    return place, _doubt(pieces, marker_of)


def _doubt(tracks: Tracks, named: NDArray[np.intp]) -> list[str]:
    """Return a warning where names were found that mean little."""
    track = np.flatnonzero(named != UNNAMED)
    apart = track_distances(tracks, named)[track, named[track]]
    typical = float(np.median(np.repeat(apart, tracks.present[:, track].sum(axis=0))))
    limit = _ALIKE * spacing(tracks.shape)
    if typical <= limit:
        return []
    return [
        f"the names are doubtful: half of the samples are more than {typical:.1f} mm from where "
        f"they are expected, which is less than {limit:.1f} mm for a face like the reference"
    ]


def _moved(
    recording: Trajectories,
    column: NDArray[np.intp],
    markers: tuple[str, ...],
    marker_set: MarkerSet | None,
) -> Trajectories:
    """Return the recording's samples in other columns, (T, K)."""
    frame, track = np.nonzero(recording.present)
    target = (frame, column[frame, track])

    def moved(samples: NDArray[_Scalar], missing: float) -> NDArray[_Scalar]:
        shape = (recording.frames, len(markers), *samples.shape[2:])
        spread = np.full(shape, missing, dtype=samples.dtype)
        spread[target] = samples[frame, track]
        return spread

    return Trajectories(
        positions=moved(recording.positions, np.nan),
        markers=markers,
        rate=recording.rate,
        marker_set=marker_set,
        origin=moved(recording.origin, Origin.MISSING),
        sigma=None if recording.sigma is None else moved(recording.sigma, np.nan),
    )


def _free_names(count: int, taken: tuple[str, ...]) -> list[str]:
    """Return ``t000``, ``t001``, ..., without those that a marker of the reference has."""
    numbered = (f"t{number:03d}" for number in range(count + len(taken)))
    return [name for name in numbered if name not in taken][:count]


def _messages(
    recording: Trajectories, markers: tuple[str, ...], marker: NDArray[np.intp]
) -> Iterator[str]:
    left = recording.present & (marker == UNNAMED)
    if left.any():
        some = left.any(axis=0)
        part = np.count_nonzero(some & (marker != UNNAMED).any(axis=0))
        yield (
            f"{np.count_nonzero(left)} of {np.count_nonzero(recording.present)} samples are no "
            f"marker of the reference, {np.count_nonzero(some) - part} tracks as a whole and "
            f"{part} in part: they are called t000 and so on"
        )
    there = np.unique(marker)
    absent = [name for number, name in enumerate(markers) if number not in there]
    if absent:
        yield f"{len(absent)} markers of the reference are in no track: {listed(absent)}"


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
    places = [_visits(tracks, expectation, track, own) for track, own in enumerate(named.tolist())]
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


def _visits(tracks: Tracks, expectation: Expectation, track: int, own: int) -> NDArray[np.intp]:
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

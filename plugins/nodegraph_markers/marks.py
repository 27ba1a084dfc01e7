"""What a person has marked in a take, applied to it."""

from __future__ import annotations

import warnings
from collections import Counter
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import nearest, node
from nodegraph_markers.rename import renamed_set
from nodegraph_mocap import Mark, Marks, Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

_ORIGIN = 3
_MISSING = np.array([np.nan, np.nan, np.nan, Origin.MISSING, np.nan])


@node("recording.apply_marks")
def apply_marks(recording: Trajectories, marks: Marks) -> Trajectories:
    """Leave out the samples that a person has marked as bad; name and swap others as marked.

    A take is marked in `nodegraph view`, which keeps the marks in a file beside it and never writes
    the take itself. A warning counts the samples, so that a report does.

    A marker all of whose samples are those of a marker that the take lacks is renamed, in the
    marker set as well; one that has lost all its samples to another is left out.

    Parameters
    ----------
    recording
        The take that was looked at.
    marks
        As `read.marks` gives them. Each holds for what those before it leave.

    Returns
    -------
    Trajectories
        Samples that were marked as bad are missing; all others are those of the take.

    Raises
    ------
    ValueError
        If a mark names a marker or a frame that the take lacks, or gives a marker samples in frames
        in which it has some.
    """
    take = _Take(recording)
    for mark in marks.marks:
        take.apply(mark)
    kinds = ", ".join(f"{count} {kind}" for kind, count in take.samples.items())
    warnings.warn(
        f"{take.samples.total()} samples marked by hand" + (f": {kinds}" if kinds else ""),
        stacklevel=2,
    )
    return take.recording()


@dataclass(frozen=True)
class _Track:
    """Samples of a marker: (T, 5) x, y, z, origin and sigma, and its name in the take."""

    samples: NDArray[np.float64]
    name: str

    @property
    def known(self) -> NDArray[np.bool_]:
        """(T,), True where the marker is there."""
        return np.asarray(self.samples[:, _ORIGIN] != Origin.MISSING)


class _Take:
    """A recording whose samples change places.

    Attributes
    ----------
    samples : Counter of str
        Number of marked samples, by kind of mark.
    """

    def __init__(self, recording: Trajectories) -> None:
        self.samples: Counter[str] = Counter()
        self._recording = recording
        sigma = recording.sigma
        if sigma is None:
            sigma = np.full(recording.origin.shape, np.nan)
        parts = (recording.positions, recording.origin[..., None], sigma[..., None])
        every: NDArray[np.float64] = np.concatenate(parts, axis=2, dtype=np.float64)
        self._tracks = {
            name: _Track(every[:, column], name) for column, name in enumerate(recording.markers)
        }

    def apply(self, mark: Mark) -> None:
        """Apply a mark.

        Raises
        ------
        ValueError
            If it does not fit the take.
        """
        place = f"{mark.marker}, frames {mark.start} to {mark.stop - 1}, {mark.kind}"
        if mark.stop > self._recording.frames:
            raise ValueError(f"{place}: the last frame is {self._recording.frames - 1}")
        span = slice(mark.start, mark.stop)
        track = self._track(mark.marker, place)
        count = np.count_nonzero(track.known[span])
        if mark.kind == "bad":
            track.samples[span] = _MISSING
        elif mark.kind == "named":
            self._give(mark, track, span, place)
        else:
            other = self._track(mark.other, place)
            count += np.count_nonzero(other.known[span])
            before = track.samples[span].copy()
            track.samples[span], other.samples[span] = other.samples[span], before
        self.samples[mark.kind] += int(count)

    def _give(self, mark: Mark, track: _Track, span: slice, place: str) -> None:
        """Give samples to another marker."""
        known = track.known
        is_all = np.count_nonzero(known[span]) == np.count_nonzero(known)
        if is_all and mark.other not in self._tracks:
            new_names = (mark.other if name == mark.marker else name for name in self._tracks)
            self._tracks = dict(zip(new_names, self._tracks.values(), strict=True))
            return
        nothing = np.tile(_MISSING, (len(known), 1))
        other = self._tracks.setdefault(mark.other, _Track(nothing, mark.other))
        given = np.zeros_like(known)
        given[span] = known[span]
        both = np.count_nonzero(given & other.known)
        if both:
            raise ValueError(
                f"{place}: {mark.other} has samples in {both} of these frames; swap the two, or "
                "mark those as bad first"
            )
        other.samples[given] = track.samples[given]
        track.samples[given] = _MISSING
        if is_all:
            del self._tracks[mark.marker]

    def _track(self, marker: str, place: str) -> _Track:
        if marker not in self._tracks:
            raise ValueError(f"{place}: no marker {marker!r}; {nearest(marker, self._tracks)}")
        return self._tracks[marker]

    def recording(self) -> Trajectories:
        """Return the recording with all marks applied."""
        take, markers = self._recording, tuple(self._tracks)
        every = np.stack([track.samples for track in self._tracks.values()], axis=1)
        marker_set = take.marker_set
        if marker_set is not None:
            new_names = {
                track.name: name
                for name, track in self._tracks.items()
                if track.name in marker_set.markers and name not in marker_set.markers
            }
            marker_set = renamed_set(marker_set, new_names).keep(markers)
        return replace(
            take,
            positions=every[..., :_ORIGIN],
            markers=markers,
            marker_set=marker_set,
            origin=every[..., _ORIGIN].astype(np.uint8),
            sigma=None if take.sigma is None else every[..., _ORIGIN + 1],
        )

"""Recordings: marker trajectories, where each sample came from, and masks over samples.

A notebook shows a recording by its size, the origins of its samples, and a strip per marker.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import IntEnum
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph import Value, closest, listed
from nodegraph_mocap.checks import distinct, possible_rate, set_fields, twice
from nodegraph_mocap.frame_ranges import chunks, runs_of
from nodegraph_mocap.marker_set import MarkerSet
from nodegraph_mocap.tuning import Tuning
from nodegraph_tables.style import BLUE, GREY, ORANGE, VERMILLION

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray


_FROM_POSITIONS: Any = None


class Origin(IntEnum):
    """The origin of a sample."""

    MISSING = 0
    MEASURED = 1
    FILLED = 2
    REPAIRED = 3


_MISSING, _LAST = int(Origin.MISSING), int(max(Origin))
"""As numbers, which numpy compares faster: there is a recording for each frame of a stream."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Trajectories(Value):
    """A recording: the positions of named markers over time.

    A set of scans with corresponding points is a recording of one frame per scan.

    Attributes
    ----------
    positions : (T, M, 3) array of float64
        Millimetres; a missing sample is NaN in all three coordinates.
    markers : tuple of M str
    rate : float
        Frames per second.
    marker_set : MarkerSet or None
    origin : (T, M) array of uint8
        An `Origin` per sample; made from the missing samples when it is not given.
    sigma : (T, M) array of float64, or None
        Standard deviation of each sample in millimetres, where a method knows it: 95 % of the
        errors of a coordinate lie within 1.96 of it, in general more than 50 % within 0.67.
        NaN for a missing sample, whatever is given.
    tuning : Tuning or None
        The settings that a fill has chosen by the recording, if its settings were tuned.

    Raises
    ------
    ValueError
        If shapes disagree, names repeat, a sample is partly missing or infinite, or `origin`
        does not call exactly the missing samples missing.
    """

    positions: NDArray[np.float64]
    markers: tuple[str, ...]
    rate: float
    marker_set: MarkerSet | None = None
    origin: NDArray[np.uint8] = _FROM_POSITIONS
    sigma: NDArray[np.float64] | None = None
    tuning: Tuning | None = None

    def __post_init__(self) -> None:
        positions = np.asarray(self.positions, dtype=np.float64)
        _check_shape(positions, self.markers)
        missing = _missing(positions, self.markers)
        if self.origin is None:
            origin = np.where(missing, np.uint8(Origin.MISSING), np.uint8(Origin.MEASURED))
        else:
            origin = np.asarray(self.origin)
            _check_origin(origin, missing)
            origin = origin.astype(np.uint8, copy=False)
        set_fields(
            self,
            positions=positions,
            markers=tuple(self.markers),
            rate=possible_rate(self.rate),
            origin=origin,
        )
        if not isinstance(self.marker_set, MarkerSet | None):
            raise ValueError(f"marker_set must be a MarkerSet, got {self.marker_set!r}")
        if self.sigma is not None:
            set_fields(self, sigma=_checked_sigma(self.sigma, missing))

    @property
    def frames(self) -> int:
        """Number of frames, T."""
        return int(self.positions.shape[0])

    @property
    def present(self) -> NDArray[np.bool_]:
        """(T, M), True where a sample is not missing."""
        return np.asarray(self.origin != _MISSING)

    @property
    def measured(self) -> NDArray[np.bool_]:
        """(T, M), True where a sample was measured or repaired: what no fill may change."""
        return np.asarray((self.origin == Origin.MEASURED) | (self.origin == Origin.REPAIRED))

    def _repr_html_(self) -> str:
        """Return the recording for a notebook."""
        return _recording_html(self)

    def with_samples(
        self,
        positions: NDArray[np.float64],
        *,
        changed: NDArray[np.bool_],
        origin: Origin,
        sigma: NDArray[np.float64] | None = None,
    ) -> Trajectories:
        """Return the recording with other positions; what was changed gets that origin.

        Parameters
        ----------
        positions
            (T, M, 3) millimetres.
        changed
            (T, M), True where a sample was written. One that is NaN in `positions` is missing.
        origin
            The origin of the written samples.
        sigma
            (T, M) millimetres, or None to keep what the recording has.
        """
        marked = np.where(changed, np.uint8(origin), self.origin)
        marked[np.isnan(positions[..., 0])] = Origin.MISSING
        deviation = self.sigma if sigma is None else sigma
        return replace(self, positions=positions, origin=marked, sigma=deviation)

    def __getitem__(self, frames: slice | NDArray[np.generic]) -> Trajectories:
        """Return the recording in some frames: a slice, flags, or numbers."""
        return replace(
            self,
            positions=self.positions[frames],
            origin=self.origin[frames],
            sigma=None if self.sigma is None else self.sigma[frames],
        )

    def positions_of(self, names: Sequence[str]) -> NDArray[np.float64]:
        """Return (T, N, 3) positions of some markers; NaN for those that the recording lacks."""
        place = {marker: column for column, marker in enumerate(self.markers)}
        there = [column for column, name in enumerate(names) if name in place]
        positions = np.full((self.frames, len(names), 3), np.nan)
        positions[:, there] = self.positions[:, [place[names[column]] for column in there]]
        return positions

    def keep(self, names: Iterable[str]) -> Trajectories:
        """Return the recording with these markers only, in this order.

        Raises
        ------
        ValueError
            If the recording lacks one of them, or one is a duplicate.
        """
        markers = tuple(names)
        check_markers(self, markers)
        columns = [self.markers.index(name) for name in markers]
        return replace(
            self,
            positions=self.positions[:, columns],
            markers=markers,
            marker_set=self.marker_set.keep(markers) if self.marker_set else None,
            origin=self.origin[:, columns],
            sigma=None if self.sigma is None else self.sigma[:, columns],
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class Mask(Value):
    """Samples that a cut has hidden, or that an impulse has hit.

    Attributes
    ----------
    hidden : (T, M) array of bool
    markers : tuple of M str
    """

    hidden: NDArray[np.bool_]
    markers: tuple[str, ...]

    def __post_init__(self) -> None:
        hidden = np.asarray(self.hidden, dtype=np.bool_)
        if hidden.ndim != 2 or hidden.shape[1] != len(self.markers):
            raise ValueError(f"a mask is (frames, {len(self.markers)} markers), got {hidden.shape}")
        set_fields(self, hidden=hidden, markers=tuple(self.markers))

    @property
    def frames(self) -> int:
        """Number of frames, T."""
        return len(self.hidden)


def check_markers(
    recording: Trajectories, names: Iterable[str], *, what: str = "the recording"
) -> None:
    """Raise an error for names that are not markers of a recording, or are duplicates.

    Parameters
    ----------
    recording
        Has the markers.
    names
        Markers that it must have.
    what
        The name of the recording in messages.

    Raises
    ------
    ValueError
        With the names, for each the nearest marker if one is near, and all that there are.
    """
    wanted = list(names)
    repeated = twice(wanted)
    if repeated:
        raise ValueError(f"{what}: duplicate markers {listed(repeated)}")
    known = set(recording.markers)
    unknown = [_with_nearest(name, recording.markers) for name in wanted if name not in known]
    if unknown:
        raise ValueError(
            f"{what} has no marker {'; '.join(unknown)}; it has {listed(recording.markers)}"
        )


def with_marker_set(
    recording: Trajectories, marker_set: MarkerSet | None, *, what: str = "the recording"
) -> Trajectories:
    """Return a recording with what is known of its markers, or as it is where nothing is.

    Parameters
    ----------
    recording
    marker_set
    what
        What has the recording's markers, in the message.

    Raises
    ------
    ValueError
        If the marker set names a marker that the recording lacks.
    """
    if marker_set is None:
        return recording
    known = set(recording.markers)
    absent = [name for name in marker_set.markers if name not in known]
    if absent:
        raise ValueError(
            f"the marker set names {listed(absent)}, which {what} lacks; it has "
            f"{listed(recording.markers)}"
        )
    return replace(recording, marker_set=marker_set)


def _with_nearest(name: str, markers: Sequence[str]) -> str:
    near = closest(name, markers)
    return f"{name!r} (did you mean {near!r}?)" if near else repr(name)


def _check_shape(positions: NDArray[np.float64], markers: tuple[str, ...]) -> None:
    if positions.ndim != 3 or positions.shape[1:] != (len(markers), 3):
        raise ValueError(
            f"positions must be (frames, {len(markers)} markers, 3), got {positions.shape}"
        )
    distinct("markers", markers)


def _missing(positions: NDArray[np.float64], markers: tuple[str, ...]) -> NDArray[np.bool_]:
    missing = np.zeros(positions.shape[:2], dtype=np.bool_)
    for piece in chunks(len(positions), positions[:1].nbytes):
        finite = np.isfinite(positions[piece])
        lacking = finite.size - np.count_nonzero(finite)
        if lacking:
            # Over an axis of three, `any` takes twenty times as long as two bitwise operations.
            nan = np.isnan(positions[piece])
            missing[piece] = nan[..., 0] | nan[..., 1] | nan[..., 2]
            if not lacking == np.count_nonzero(nan) == 3 * np.count_nonzero(missing[piece]):
                raise _broken(positions, markers)
    return missing


def _broken(positions: NDArray[np.float64], markers: tuple[str, ...]) -> ValueError:
    nan = np.isnan(positions)
    bad = np.isinf(positions).any(axis=2) | (nan.any(axis=2) & ~nan.all(axis=2))
    frame, marker = np.argwhere(bad)[0]
    return ValueError(
        f"frame {frame}, marker {markers[marker]!r}: {positions[frame, marker]} is neither a "
        f"position nor wholly missing ({np.count_nonzero(bad)} such samples)"
    )


def _check_origin(origin: NDArray[np.integer], missing: NDArray[np.bool_]) -> None:
    if origin.shape != missing.shape:
        raise ValueError(f"origin must be {missing.shape}, got {origin.shape}")
    known = not origin.size or (origin.min() >= 0 and origin.max() <= _LAST)
    if not known or ((origin == _MISSING) != missing).any():
        raise ValueError("origin must call exactly the missing samples missing (0), others 1 to 3")


def _checked_sigma(sigma: NDArray[np.float64], missing: NDArray[np.bool_]) -> NDArray[np.float64]:
    sigma = np.asarray(sigma, dtype=np.float64)
    if sigma.shape != missing.shape:
        raise ValueError(f"sigma must be {missing.shape}, got {sigma.shape}")
    stays = np.isnan(sigma[missing]).all()
    return sigma if stays else np.where(missing, np.nan, sigma)


_COLOURS = (
    (Origin.MEASURED, "measured", BLUE),
    (Origin.FILLED, "filled", VERMILLION),
    (Origin.REPAIRED, "repaired", ORANGE),
    (Origin.MISSING, "missing", GREY),
)
_WIDTH = 800
_HIGHEST = 480


def _recording_html(recording: Trajectories) -> str:
    """Return a fragment of HTML that needs nothing else; names are escaped."""
    facts = (
        f"{recording.frames} frames, {len(recording.markers)} markers, {recording.rate:g} Hz, "
        f"{recording.frames / recording.rate:.3g} s"
    )
    counts = "; ".join(
        f'<span style="color:{colour}">\N{BLACK SQUARE}</span> {_share(recording, origin)} {name}'
        for origin, name, colour in _COLOURS
    )
    return f"<div><p><b>Trajectories</b>: {facts}</p><p>{counts}</p>{_strips(recording)}</div>"


def _share(recording: Trajectories, origin: Origin) -> str:
    count = int(np.count_nonzero(recording.origin == origin))
    share = count / max(recording.origin.size, 1)
    samples = "sample" if count == 1 else "samples"
    return f"{count} {samples} ({100 * share:.1f} %)" if count else "no samples"


def _strips(recording: Trajectories) -> str:
    """Return a picture: a row per marker, time to the right, missing samples left white."""
    if not recording.origin.size:
        return ""
    markers = len(recording.markers)
    height = min(8 * markers, _HIGHEST)
    rows = "".join(
        f'<g><title>{escape(name)}</title><rect x="0" y="{row}" width="{recording.frames}" '
        f'height="1" fill="transparent"/></g>'
        for row, name in enumerate(recording.markers)
    )
    paths = "".join(
        f'<path fill="{colour}" d="{_path(recording, origin)}"/>'
        for origin, _, colour in _COLOURS
        if origin is not Origin.MISSING
    )
    return (
        f'<svg role="img" aria-label="Where samples come from, a row per marker" '
        f'width="{_WIDTH}" height="{height}" style="max-width:100%" preserveAspectRatio="none" '
        f'viewBox="0 0 {recording.frames} {markers}" shape-rendering="crispEdges">'
        f"{paths}{rows}</svg>"
    )


def _path(recording: Trajectories, origin: Origin) -> str:
    runs = runs_of(np.asarray(recording.origin == origin))
    return "".join(
        f"M{start} {marker}.1h{stop - start}v.8h{start - stop}z"
        for marker, start, stop in zip(*(column.tolist() for column in runs), strict=True)
    )

"""What every despiker promises, whoever wrote it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph import Tried
from nodegraph_mocap import Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

_SHIFT = np.array([110.0, -70.0, 240.0])
_TOLERANCE = 1e-6
"""Millimetres: far above rounding, far below anything a camera sees."""


def takes_and_gives_a_recording(tried: Tried) -> Iterator[str]:
    """Take one port, `recording`, and give a recording with the same markers first."""
    given, made = _given(tried.inputs), _made(tried.outputs)
    if given is None:
        yield f"its ports are {', '.join(tried.inputs) or 'none'}; name the recording `recording`"
    elif made is None:
        yield f"its first output is not a recording; it gives {', '.join(tried.outputs)}"
    else:
        for what in ("markers", "rate", "frames", "marker_set"):
            if getattr(given, what) != getattr(made, what):
                yield f"{what} went in as {getattr(given, what)}, came out as {getattr(made, what)}"


def missing_stays_missing(tried: Tried) -> Iterator[str]:
    """Leave missing samples missing and present ones present: nothing is filled, nothing cut."""
    for given, made in _pairs(tried):
        for what, where in (
            ("filled", ~given.present & made.present),
            ("removed", given.present & ~made.present),
        ):
            if where.any():
                yield f"{_spots(given, where)} {what}"


def repaired_samples_are_marked(tried: Tried) -> Iterator[str]:
    """Mark each sample that is changed as repaired, and leave the others as they are."""
    for given, made in _pairs(tried):
        both = given.present & made.present
        changed = both & np.any(given.positions != made.positions, axis=2)
        unmarked = changed & (made.origin != Origin.REPAIRED)
        if unmarked.any():
            yield f"{_spots(given, unmarked)} changed but not marked: {_HOW_TO_MARK}"
        renamed = both & ~changed & (made.origin != given.origin)
        if renamed.any():
            yield f"{_spots(given, renamed)} not changed but marked anew: {_HOW_TO_MARK}"


def sigma_belongs_to_its_sample(tried: Tried) -> Iterator[str]:
    """Keep the sigma of samples that stay, and not that of samples that are changed."""
    for given, made in _pairs(tried):
        if given.sigma is None:
            continue
        if made.sigma is None:
            yield "sigma is gone; keep it where samples stay"
            continue
        changed = np.any(given.positions != made.positions, axis=2) & given.present
        other = (given.sigma != made.sigma) & ~(np.isnan(given.sigma) & np.isnan(made.sigma))
        lost = given.present & ~changed & other
        if lost.any():
            yield f"{_spots(given, lost)} not changed but with another sigma"
        kept = changed & ~other & ~np.isnan(given.sigma)
        if kept.any():
            yield f"{_spots(given, kept)} changed but with the sigma of what it was: make it NaN"


def moves_with_the_face(tried: Tried) -> Iterator[str]:
    """Repair a recording that is shifted as a whole like the one that is not."""
    for given, made in _pairs(tried):
        again = _again(tried, replace(given, positions=given.positions + _SHIFT))
        if again is None:
            yield "declines the shifted recording"
        else:
            yield from _differences(made, again.positions - _SHIFT)


def does_not_depend_on_the_order_of_markers(tried: Tried) -> Iterator[str]:
    """Repair markers in another order alike."""
    for given, made in _pairs(tried):
        again = _again(tried, given.keep(given.markers[::-1]))
        if again is None:
            yield "declines the recording whose markers are in another order"
        else:
            yield from _differences(made, again.keep(given.markers).positions)


CONTRACTS = (
    takes_and_gives_a_recording,
    missing_stays_missing,
    repaired_samples_are_marked,
    sigma_belongs_to_its_sample,
    moves_with_the_face,
    does_not_depend_on_the_order_of_markers,
)

_HOW_TO_MARK = "return recording.with_samples(positions, changed=bad, origin=Origin.REPAIRED)"


def _given(inputs: Mapping[str, Any]) -> Trajectories | None:
    recording = inputs.get("recording")
    return recording if isinstance(recording, Trajectories) else None


def _made(outputs: Mapping[str, Any]) -> Trajectories | None:
    first = next(iter(outputs.values()))
    return first if isinstance(first, Trajectories) else None


def _pairs(tried: Tried) -> Iterator[tuple[Trajectories, Trajectories]]:
    """Yield what went in and what came out, if they can be compared at all."""
    given, made = _given(tried.inputs), _made(tried.outputs)
    if given is not None and made is not None and given.origin.shape == made.origin.shape:
        yield given, made


def _again(tried: Tried, recording: Trajectories) -> Trajectories | None:
    outputs = tried.again(recording=recording)
    return None if outputs is None else _made(outputs)


def _differences(made: Trajectories, back: NDArray[np.float64]) -> Iterator[str]:
    apart = np.nan_to_num(np.linalg.norm(back - made.positions, axis=2))
    far = apart > _TOLERANCE
    if far.any():
        yield f"{_spots(made, far)} differ, by up to {apart.max():.3g} mm"


def _spots(recording: Trajectories, where: NDArray[np.bool_]) -> str:
    frame, marker = np.argwhere(where)[0]
    count = int(np.count_nonzero(where))
    more = f" and {count - 1} more samples" if count > 1 else ""
    return f"frame {frame}, marker {recording.markers[marker]!r}{more}"

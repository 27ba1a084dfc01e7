"""What every fill promises, whoever wrote it."""

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


def present_samples_stay(tried: Tried) -> Iterator[str]:
    """Leave present samples bit for bit as they are, and write only missing ones."""
    for given, made in _pairs(tried):
        changed = given.present & np.any(given.positions != made.positions, axis=2)
        if changed.any():
            yield f"{_spots(given, changed)} changed: write where ~recording.present only"


def written_samples_are_marked(tried: Tried) -> Iterator[str]:
    """Mark each sample that is written as filled, and leave the others' origin as it is."""
    for given, made in _pairs(tried):
        written = ~given.present & made.present
        unmarked = written & (made.origin != Origin.FILLED)
        if unmarked.any():
            yield f"{_spots(given, unmarked)} written but not marked: {_HOW_TO_MARK}"
        renamed = given.present & (made.origin != given.origin)
        if renamed.any():
            yield f"{_spots(given, renamed)} not written but marked anew: {_HOW_TO_MARK}"


def moves_with_the_face(tried: Tried) -> Iterator[str]:
    """Fill a recording that is shifted as a whole like the one that is not."""
    for given, made in _pairs(tried):
        shifted = replace(given, positions=given.positions + _SHIFT)
        again = _again(tried, shifted)
        if again is None:
            yield "declines the shifted recording"
        else:
            yield from _differences(made, again, again.positions - _SHIFT)


def does_not_depend_on_the_order_of_markers(tried: Tried) -> Iterator[str]:
    """Fill markers in another order alike, where no tie and no choice depends on it."""
    for given, made in _pairs(tried):
        if _order_matters(given):
            continue
        again = _again(tried, given.keep(given.markers[::-1]))
        if again is None:
            yield "declines the recording whose markers are in another order"
        else:
            again = again.keep(given.markers)
            yield from _differences(made, again, again.positions)


CONTRACTS = (
    takes_and_gives_a_recording,
    present_samples_stay,
    written_samples_are_marked,
    moves_with_the_face,
    does_not_depend_on_the_order_of_markers,
)

_HOW_TO_MARK = "return recording.with_samples(positions, changed=written, origin=Origin.FILLED)"


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


def _differences(
    made: Trajectories, again: Trajectories, back: NDArray[np.float64]
) -> Iterator[str]:
    fickle = made.present != again.present
    if fickle.any():
        yield f"{_spots(made, fickle)} filled in one and missing in the other"
    apart = np.linalg.norm(back - made.positions, axis=2)
    far = np.nan_to_num(apart) > _TOLERANCE
    if far.any():
        yield f"{_spots(made, far)} differ, by up to {np.nanmax(apart):.3g} mm"


def _order_matters(recording: Trajectories) -> bool:
    """Return whether a frame lacks several markers, or markers coincide: ties go by order."""
    if np.any(np.count_nonzero(~recording.present, axis=1) > 1):
        return True
    positions = np.nan_to_num(recording.positions, nan=np.inf)
    return any(len(np.unique(one, axis=0)) < len(one) for one in positions)


def _spots(recording: Trajectories, where: NDArray[np.bool_]) -> str:
    frame, marker = np.argwhere(where)[0]
    count = int(np.count_nonzero(where))
    more = f" and {count - 1} more samples" if count > 1 else ""
    return f"frame {frame}, marker {recording.markers[marker]!r}{more}"

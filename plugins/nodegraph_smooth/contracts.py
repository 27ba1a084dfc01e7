"""What every smoothing promises, whoever wrote it."""

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
_SWAP = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]])
"""A turn by which coordinates only change places and signs."""

_TURN = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
_TOLERANCE = 1e-6
"""Millimetres: far above rounding, far below anything a camera sees."""

_LAG = 0.05
"""Frames: a shift that is smaller is taken for rounding."""


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


def adds_no_gap_and_fills_none(tried: Tried) -> Iterator[str]:
    """Leave missing samples missing, present ones present, and every sample's origin."""
    for given, made in _pairs(tried):
        lost, filled = given.present & ~made.present, ~given.present & made.present
        renamed = given.present & made.present & (given.origin != made.origin)
        if lost.any():
            yield f"{_spots(given, lost)} lost: smooth each run of present samples by itself"
        if filled.any():
            yield f"{_spots(given, filled)} filled: leave that to a fill"
        if renamed.any():
            yield (
                f"{_spots(given, renamed)} called otherwise: return "
                "dataclasses.replace(recording, positions=smoothed)"
            )


def moves_with_the_face(tried: Tried) -> Iterator[str]:
    """Smooth a recording that is shifted as a whole like the one that is not."""
    for given, made in _pairs(tried):
        again = _again(tried, replace(given, positions=given.positions + _SHIFT))
        if again is None:
            yield "declines the shifted recording"
        else:
            yield from _differences(made, again, again.positions - _SHIFT)


def turns_with_the_face(tried: Tried) -> Iterator[str]:
    """Smooth a turned recording like the other; coordinate by coordinate, axes may but swap."""
    for given, made in _pairs(tried):
        turn = _SWAP if _goes_by_coordinates(tried, given, made) else _TURN
        again = _again(tried, replace(given, positions=given.positions @ turn.T))
        if again is None:
            yield "declines the turned recording"
        else:
            yield from _differences(made, again, again.positions @ turn)


def does_not_depend_on_the_order_of_markers(tried: Tried) -> Iterator[str]:
    """Smooth markers in another order alike."""
    for given, made in _pairs(tried):
        again = _again(tried, given.keep(given.markers[::-1]))
        if again is None:
            yield "declines the recording whose markers are in another order"
        else:
            again = again.keep(given.markers)
            yield from _differences(made, again, again.positions)


def shifts_nothing_in_time(tried: Tried) -> Iterator[str]:
    """Shift nothing in time, unless it looks at no frame ahead: then it cannot but lag."""
    for given, _ in _pairs(tried):
        nod = _nod(given)
        made = _again(tried, nod)
        lag = 0.0 if made is None else _lag(nod, made)
        if made is not None and abs(lag) > _LAG and not _is_causal(tried, nod, made):
            yield (
                f"a nod comes out {abs(lag):.2f} frames {'late' if lag > 0 else 'early'}, "
                "although frames ahead are looked at: centre the window, or filter forward and "
                "backward"
            )


def sigma_belongs_to_its_sample(tried: Tried) -> Iterator[str]:
    """Keep no sigma of samples that are changed: it was that of what they were before."""
    for given, made in _pairs(tried):
        if given.sigma is None or made.sigma is None:
            continue
        kept = np.any(given.positions != made.positions, axis=2) & (given.sigma == made.sigma)
        if kept.any():
            yield f"{_spots(given, kept)} changed but with its old sigma: make it NaN"


CONTRACTS = (
    takes_and_gives_a_recording,
    adds_no_gap_and_fills_none,
    moves_with_the_face,
    turns_with_the_face,
    does_not_depend_on_the_order_of_markers,
    shifts_nothing_in_time,
    sigma_belongs_to_its_sample,
)


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
        yield f"{_spots(made, fickle)} present in one and missing in the other"
    apart = np.linalg.norm(back - made.positions, axis=2)
    far = np.nan_to_num(apart) > _TOLERANCE
    if far.any():
        yield f"{_spots(made, far)} differ, by up to {np.nanmax(apart):.3g} mm"


def _goes_by_coordinates(tried: Tried, given: Trajectories, made: Trajectories) -> bool:
    """Return whether y and z come out as they did when x is another."""
    again = _again(tried, replace(given, positions=given.positions * [3.0, 1.0, 1.0]))
    if again is None:
        return False
    return np.array_equal(made.positions[..., 1:], again.positions[..., 1:], equal_nan=True)


def _nod(given: Trajectories) -> Trajectories:
    """Return all markers at rest for two seconds, but for one movement of a second amid them."""
    half = max(round(given.rate), 20)
    time = np.arange(-half, half + 1) / half
    way = 20.0 * np.exp(-0.5 * (time / 0.2) ** 2)
    rest = np.arange(3.0 * len(given.markers)).reshape(-1, 3)
    return replace(
        given,
        positions=rest + way[:, None, None] * [0.0, 0.6, 0.8],
        origin=np.full((len(time), len(given.markers)), Origin.MEASURED, dtype=np.uint8),
        sigma=None,
    )


def _lag(nod: Trajectories, made: Trajectories) -> float:
    """Return by how many frames the movement comes later, of its centre of gravity."""
    way = (made.positions - nod.positions[0]) @ [0.0, 0.6, 0.8]
    total = way.sum()
    if abs(total) < 1.0:  # smoothed away: it has no place
        return 0.0
    return float((way.sum(axis=1) @ np.arange(len(way))) / total - (len(way) - 1) / 2.0)


def _is_causal(tried: Tried, nod: Trajectories, made: Trajectories) -> bool:
    """Return whether the first frames come out the same without those after them."""
    count = len(nod.positions) // 2
    start = replace(nod, positions=nod.positions[:count], origin=nod.origin[:count])
    again = _again(tried, start)
    if again is None or again.frames != count:
        return False
    return bool(np.allclose(again.positions, made.positions[:count], rtol=0.0, atol=_TOLERANCE))


def _spots(recording: Trajectories, where: NDArray[np.bool_]) -> str:
    frame, marker = np.argwhere(where)[0]
    count = int(np.count_nonzero(where))
    more = f" and {count - 1} more samples" if count > 1 else ""
    return f"frame {frame}, marker {recording.markers[marker]!r}{more}"

"""Contracts shared by families that take a recording and return one.

Each function yields what breaks a promise; see `nodegraph.Contract`. A family lists those that
hold for it beside its own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Tried
from nodegraph_mocap.recording import Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

SHIFT = np.array([110.0, -70.0, 240.0])
SWAP = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]])
"""A turn by which coordinates only change places and signs."""

TURN = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
_OTHER_LENGTHS = {"m", "metre", "metres", "meter", "meters", "cm", "um", "inch", "inches", "ft"}
_SECONDS = {"s": 1, "ms": 1, "Hz": -1, "mm/s": -1, "mm/s^2": -2}
"""The power of seconds in units of settings."""

DEPENDS_ON_AXES = "depends on the axes"
"""Phrase in the documentation of a method that works coordinate by coordinate."""

DEPENDS_ON_RATE = "depends on the rate"
"""Phrase in the documentation of a method with a fixed duration."""

SCALE = 2.0
FASTER = 2.0
MISPLACED = 100.0
"""Factor of the distance from the origin by which no method misplaces a sample by intent."""

TOLERANCE = 1e-6
"""Millimetres: far above rounding, far below anything a camera sees."""


def takes_and_gives_a_recording(tried: Tried) -> Iterator[str]:
    """Take one port, `recording`, and give a recording with the same markers first."""
    yield from gives_a_recording_of_the_same(tried, ("markers", "rate", "frames", "marker_set"))


def gives_a_recording_of_the_same(tried: Tried, properties: Iterable[str]) -> Iterator[str]:
    """Take one port, `recording`, and give a recording first that has these properties of it."""
    recording, output = tried.inputs.get("recording"), next(iter(tried.outputs.values()))
    if not isinstance(recording, Trajectories):
        yield f"its ports are {', '.join(tried.inputs) or 'none'}; name the recording `recording`"
    elif not isinstance(output, Trajectories):
        yield f"its first output is not a recording; it gives {', '.join(tried.outputs)}"
    else:
        yield from changes(recording, output, properties)


def changes(given: object, returned: object, properties: Iterable[str]) -> Iterator[str]:
    """Yield which properties of what a node is given another value has that it returns."""
    for what in properties:
        before, after = getattr(given, what), getattr(returned, what)
        if before != after:
            yield f"{what} went in as {before}, came out as {after}"


def moves_with_the_face(tried: Tried) -> Iterator[str]:
    """Do with a recording that is shifted as a whole what is done with the one that is not."""
    for recording, output in before_and_after(tried):
        again = output_again(tried, replace(recording, positions=recording.positions + SHIFT))
        yield from _unlike(output, again, "the shifted recording", lambda moved: moved - SHIFT)


def turns_with_the_face(tried: Tried) -> Iterator[str]:
    """Do with a turned recording what is done with the other, or say "depends on the axes"."""
    # whoever works coordinate by coordinate still gives the same when axes only change places
    turn = SWAP if says(tried, DEPENDS_ON_AXES) else TURN
    for recording, output in before_and_after(tried):
        again = output_again(tried, replace(recording, positions=recording.positions @ turn.T))
        yield from _unlike(output, again, "the turned recording", lambda moved: moved @ turn)


def scales_with_the_face(tried: Tried) -> Iterator[str]:
    """Do with a face twice as large, and settings in mm twice as large, what is done with it."""
    settings = _changed(tried, SCALE, _power)
    for recording, output in before_and_after(tried):
        sigma = None if recording.sigma is None else recording.sigma * SCALE
        larger = replace(recording, positions=recording.positions * SCALE, sigma=sigma)
        again = output_again(tried, larger, settings)
        what = "the recording of a larger face"
        yield from _unlike(output, again, what, lambda moved: moved / SCALE)


def runs_with_the_clock(tried: Tried) -> Iterator[str]:
    """Do at twice the rate, settings in Hz and s changed with it, what is done at the rate.

    Or say "depends on the rate", as a method may that has a time of its own by heart.
    """
    if says(tried, DEPENDS_ON_RATE):
        return
    settings = _changed(tried, 1.0 / FASTER, _power_of_seconds)
    for recording, output in before_and_after(tried):
        again = output_again(tried, replace(recording, rate=recording.rate * FASTER), settings)
        yield from _unlike(output, again, "the recording that plays faster")


def looks_ahead_as_declared(tried: Tried) -> Iterator[str]:
    """Let the result in a frame depend on no more frames ahead than the node declares.

    Samples before a marker's first one are exempt: there is nothing before them to go on from.
    """
    if tried.lookahead is None:
        return
    for recording, output in before_and_after(tried):
        now = recording.frames // 2
        later = now + 1 + tried.lookahead
        positions = recording.positions.copy()
        positions[later:] += SHIFT / 10.0
        positions[later:, ::2] = np.nan
        origin = np.where(np.isnan(positions[..., 0]), Origin.MISSING, recording.origin)
        changed = replace(recording, positions=positions, origin=origin)
        again = output_again(tried, changed)
        if again is None or later >= recording.frames:
            continue
        begun = np.maximum.accumulate(recording.present, axis=0)[: now + 1]
        known, other = (each.positions[: now + 1] for each in (output, again))
        apart = begun & ~np.all((known == other) | (np.isnan(known) & np.isnan(other)), axis=2)
        if apart.any():
            yield (
                f"{places(recording, apart)} changed with frames from {later} on: declare a "
                f"look-ahead of more than {tried.lookahead}, or None"
            )


def gives_millimetres(tried: Tried) -> Iterator[str]:
    """Give positions in millimetres, and take settings that are lengths in millimetres."""
    for name, unit in tried.units.items():
        if unit.replace("/", " ").replace("^", " ").split(" ")[0] in _OTHER_LENGTHS:
            yield f"setting {name!r} is in {unit}: let it be in mm, as positions are"
    for recording, output in before_and_after(tried):
        written = output.present & np.any(recording.positions != output.positions, axis=2)
        if not written.any() or not recording.present.any():
            continue
        ratio = _usual_distance(output, written) / _usual_distance(recording, recording.present)
        if not 1.0 / MISPLACED < ratio < MISPLACED:
            yield (
                f"{places(output, written)} come out {ratio:.2g} times as far from the origin as "
                "what went in: are they in metres? positions are in millimetres"
            )


def does_not_depend_on_the_order_of_markers(tried: Tried) -> Iterator[str]:
    """Do the same with markers in another order."""
    for recording, output in before_and_after(tried):
        again = output_again(tried, recording.keep(recording.markers[::-1]))
        again = again and again.keep(recording.markers)
        yield from _unlike(output, again, "the recording whose markers are in another order")


def says(tried: Tried, words: str) -> bool:
    """Return whether a node's documentation says these words."""
    return words in " ".join(tried.doc.lower().split())


def before_and_after(tried: Tried) -> Iterator[tuple[Trajectories, Trajectories]]:
    """Yield what went in and what came out, if they can be compared at all."""
    recording, output = tried.inputs.get("recording"), next(iter(tried.outputs.values()))
    if not isinstance(recording, Trajectories) or not isinstance(output, Trajectories):
        return
    if recording.origin.shape == output.origin.shape:
        yield recording, output


def output_again(
    tried: Tried, recording: Trajectories, settings: dict[str, object] | None = None
) -> Trajectories | None:
    """Return what comes out of another recording; None where it is declined."""
    outputs = tried.again(settings or {}, recording=recording)
    output = None if outputs is None else next(iter(outputs.values()))
    return output if isinstance(output, Trajectories) else None


def _unlike(
    output: Trajectories,
    again: Trajectories | None,
    what: str,
    back: Callable[[NDArray[np.float64]], NDArray[np.float64]] = lambda positions: positions,
) -> Iterator[str]:
    """Yield where a result differs from that of another recording, whose positions `back` moves."""
    if again is None:
        yield f"declines {what}"
    else:
        yield from differences(output, again, back(again.positions))


def differences(
    output: Trajectories, again: Trajectories, back: NDArray[np.float64]
) -> Iterator[str]:
    """Yield where a result differs from one that was moved back."""
    fickle = output.present != again.present
    if fickle.any():
        yield f"{places(output, fickle)} present in one and missing in the other"
    apart = np.nan_to_num(np.linalg.norm(back - output.positions, axis=2))
    if np.any(apart > TOLERANCE):
        yield f"{places(output, apart > TOLERANCE)} differ, by up to {apart.max():.3g} mm"


def places(recording: Trajectories, where: NDArray[np.bool_]) -> str:
    """Return the first of some samples and the number of others as text."""
    frame, marker = np.argwhere(where)[0]
    count = int(np.count_nonzero(where))
    more = f" and {count - 1} more {'samples' if count > 2 else 'sample'}" if count > 1 else ""
    return f"frame {frame}, marker {recording.markers[marker]!r}{more}"


def _usual_distance(recording: Trajectories, which: NDArray[np.bool_]) -> float:
    """Return the median distance of some samples from the origin, which is not 0."""
    return max(float(np.median(np.linalg.norm(recording.positions[which], axis=1))), 1e-9)


def _changed(tried: Tried, factor: float, power: Callable[[str], int]) -> dict[str, object]:
    """Return the settings that change when what they are measured in does, changed."""
    powers = {name: power(tried.units.get(name, "")) for name in tried.settings}
    return {
        name: value * factor ** powers[name]
        for name, value in tried.settings.items()
        if powers[name] and isinstance(value, (int, float))
    }


def _power(unit: str) -> int:
    """Return the power of millimetres in a unit: 2 for ``mm^2``, 0 for ``frames``."""
    if "per mm" in unit:
        return -1
    return 0 if not unit.startswith("mm") else 2 if unit.startswith("mm^2") else 1


def _power_of_seconds(unit: str) -> int:
    """Return the power of seconds in a unit: -2 for ``mm/s^2``, 0 for ``Hz per mm/s``."""
    above, _, below = unit.partition(" per ")
    return _SECONDS.get(above, 0) - _SECONDS.get(below, 0)

"""Contracts of every node that combines recordings, third-party ones included."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from nodegraph import Across, Tried
from nodegraph_mocap import Trajectories
from nodegraph_mocap.contracts import changes

_SHIFT = np.array([110.0, -70.0, 240.0])
_TOLERANCE = 1e-6


def takes_recordings_and_gives_one(tried: Tried) -> Iterator[str]:
    """Take one gathering port, `recordings`, and give a recording of the same markers first."""
    recordings, combined = tried.inputs.get("recordings"), next(iter(tried.outputs.values()))
    if not isinstance(recordings, Across):
        yield f"its ports are {', '.join(tried.inputs) or 'none'}; name the port `recordings`"
    elif not isinstance(combined, Trajectories):
        yield f"its first output is not a recording; it gives {', '.join(tried.outputs)}"
    else:
        properties = ("markers", "rate", "frames", "marker_set")
        yield from changes(recordings.values()[0], combined, properties)


def keeps_what_all_have_alike(tried: Tried) -> Iterator[str]:
    """Leave samples that all recordings have alike bit for bit as they are."""
    if any(takes_recordings_and_gives_one(tried)):
        return
    recordings, combined = tried.inputs["recordings"].values(), next(iter(tried.outputs.values()))
    alike = np.all(
        [recording.positions == recordings[0].positions for recording in recordings], axis=(0, 3)
    )
    changed = alike & np.any(combined.positions != recordings[0].positions, axis=2)
    if changed.any():
        yield f"{np.count_nonzero(changed)} samples that all have alike are changed"


def does_not_depend_on_the_order(tried: Tried) -> Iterator[str]:
    """Give the same recording when the recordings come in another order."""
    if any(takes_recordings_and_gives_one(tried)):
        return
    pair = _unlike(tried)
    straight, back = (_combined(tried, ordered) for ordered in (pair, pair[::-1]))
    if straight is None or back is None:
        yield "declines recordings of two methods"
    elif not _near(straight, back):
        yield "the recordings in another order give another result"


def moves_with_the_face(tried: Tried) -> Iterator[str]:
    """Combine recordings that are shifted as a whole like those that are not."""
    if any(takes_recordings_and_gives_one(tried)):
        return
    pair = _unlike(tried)
    shifted = [replace(recording, positions=recording.positions + _SHIFT) for recording in pair]
    straight, moved = (_combined(tried, inputs) for inputs in (pair, shifted))
    if straight is None or moved is None:
        yield "declines recordings that are shifted, or of two methods"
    elif not _near(straight, replace(moved, positions=moved.positions - _SHIFT)):
        yield "shifted recordings give another result"


CONTRACTS = (
    takes_recordings_and_gives_one,
    keeps_what_all_have_alike,
    does_not_depend_on_the_order,
    moves_with_the_face,
)


def _unlike(tried: Tried) -> tuple[Trajectories, Trajectories]:
    """Return a recording, and one in which every seventh present sample is elsewhere."""
    recording: Trajectories = tried.inputs["recordings"].values()[0]
    which = np.arange(recording.origin.size).reshape(recording.origin.shape) % 7 == 3
    return recording, replace(
        recording, positions=recording.positions + np.where(which, 2.5, 0.0)[..., None]
    )


def _combined(tried: Tried, recordings: Sequence[Trajectories]) -> Trajectories | None:
    outputs = tried.again(recordings=Across.of(dict(zip("ab", recordings, strict=True)), axis="x"))
    return None if outputs is None else next(iter(outputs.values()))


def _near(first: Trajectories, second: Trajectories) -> bool:
    close = np.allclose(first.positions, second.positions, rtol=0, atol=_TOLERANCE, equal_nan=True)
    return close and bool(np.all(first.origin == second.origin))

"""What every node that chooses or names markers promises, whoever wrote it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Tried
from nodegraph_mocap import Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray


def gives_a_recording_of_the_same_frames(tried: Tried) -> Iterator[str]:
    """Take `recording`, and give a recording of as many frames and that rate first."""
    given, made = tried.inputs.get("recording"), next(iter(tried.outputs.values()))
    if not isinstance(given, Trajectories):
        yield f"its ports are {', '.join(tried.inputs) or 'none'}; name the recording `recording`"
    elif not isinstance(made, Trajectories):
        yield f"its first output is not a recording; it gives {', '.join(tried.outputs)}"
    else:
        for what in ("frames", "rate"):
            if getattr(given, what) != getattr(made, what):
                yield f"{what} went in as {getattr(given, what)}, came out as {getattr(made, what)}"


def moves_no_sample(tried: Tried) -> Iterator[str]:
    """Give samples of the same frame only, bit for bit with their origin, none of them twice."""
    if any(gives_a_recording_of_the_same_frames(tried)):
        return
    given, made = tried.inputs["recording"], next(iter(tried.outputs.values()))
    there, how_many = np.unique(_samples(given), axis=0, return_counts=True)
    every = np.concatenate([there, _samples(made)])
    found, index = np.unique(every, axis=0, return_inverse=True)
    used = np.bincount(index.ravel()[len(there) :], minlength=len(there))
    if len(found) > len(there):
        yield f"{len(found) - len(there)} samples are none of their frame, or their origin changed"
    elif np.any(used > how_many):
        yield f"{np.count_nonzero(used > how_many)} samples are used more than once"


CONTRACTS = (gives_a_recording_of_the_same_frames, moves_no_sample)


def _samples(recording: Trajectories) -> NDArray[np.float64]:
    """Return (N, 5): frame, origin and position of each present sample."""
    frame, marker = np.nonzero(recording.present)
    return np.column_stack(
        [frame, recording.origin[frame, marker], recording.positions[frame, marker]]
    )

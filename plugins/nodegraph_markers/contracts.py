"""Contracts of every node that chooses or names markers, third-party ones included."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Tried
from nodegraph_mocap import Trajectories, contracts

if TYPE_CHECKING:
    from numpy.typing import NDArray


def gives_a_recording_of_the_same_frames(tried: Tried) -> Iterator[str]:
    """Take `recording`, and give a recording of as many frames and that rate first."""
    yield from contracts.gives_a_recording_of_the_same(tried, ("frames", "rate"))


def moves_no_sample(tried: Tried) -> Iterator[str]:
    """Give samples of the same frame only, bit for bit with their origin, none of them twice."""
    if any(gives_a_recording_of_the_same_frames(tried)):
        return
    recording, output = tried.inputs["recording"], next(iter(tried.outputs.values()))
    there, how_many = np.unique(_samples(recording), axis=0, return_counts=True)
    every = np.concatenate([there, _samples(output)])
    distinct, index = np.unique(every, axis=0, return_inverse=True)
    used = np.bincount(index.ravel()[len(there) :], minlength=len(there))
    if len(distinct) > len(there):
        count = len(distinct) - len(there)
        yield f"{count} samples are none of their frame, or their origin changed"
    elif np.any(used > how_many):
        yield f"{np.count_nonzero(used > how_many)} samples are used more than once"


CONTRACTS = (gives_a_recording_of_the_same_frames, moves_no_sample)


def _samples(recording: Trajectories) -> NDArray[np.float64]:
    """Return (N, 5): frame, origin and position of each present sample."""
    frame, marker = np.nonzero(recording.present)
    return np.column_stack(
        [frame, recording.origin[frame, marker], recording.positions[frame, marker]]
    )

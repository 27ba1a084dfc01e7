"""Differences between two recordings, masks or weights, by frames and markers."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import listed
from nodegraph_mocap.face_model import Weights
from nodegraph_mocap.recording import Mask, Trajectories
from nodegraph_tables import differences, name_differences

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

_MOST_NAMES = 5


def compare_recordings(first: Trajectories, second: Trajectories) -> Iterator[str]:
    """Yield what differs: length and markers, then samples with their frames and markers."""
    if first.rate != second.rate:
        yield f"rate was {first.rate:g} Hz, now {second.rate:g} Hz"
    if first.frames != second.frames:
        yield f"had {first.frames} frames, now {second.frames}"
    if first.markers != second.markers:
        yield from name_differences("markers", first.markers, second.markers)
    if first.frames != second.frames or set(first.markers) != set(second.markers):
        return
    second = second.keep(first.markers)
    lone = first.present != second.present
    if lone.any():
        yield f"{_samples(lone, first.markers)} present in one and missing in the other"
    apart = np.nan_to_num(np.linalg.norm(first.positions - second.positions, axis=2))
    if apart.any():
        yield f"{_samples(apart > 0, first.markers)} moved, {_most(apart, ' mm', first.markers)}"
    relabelled = (first.origin != second.origin) & ~lone
    if relabelled.any():
        yield f"{_samples(relabelled, first.markers)} of another origin"


def compare_masks(first: Mask, second: Mask) -> Iterator[str]:
    """Yield which samples only one of the masks has."""
    if first.markers != second.markers or first.hidden.shape != second.hidden.shape:
        yield from name_differences("markers", first.markers, second.markers)
        return
    lone = first.hidden != second.hidden
    if lone.any():
        yield f"{_samples(lone, first.markers)} in one mask only"


def compare_weights(first: Weights, second: Weights) -> Iterator[str]:
    """Yield what differs: length and shapes, then weights with their frames and shapes."""
    if first.names != second.names:
        yield from name_differences("shapes", first.names, second.names)
    if len(first.values) != len(second.values):
        yield f"had {len(first.values)} frames, now {len(second.values)}"
    if first.names != second.names or len(first.values) != len(second.values):
        return
    differs = differences(first.values, second.values)
    if differs.any():
        apart = np.nan_to_num(np.abs(first.values - second.values))
        most = _most(apart, "", first.names)
        yield f"{_samples(differs, first.names)} of another weight, {most}"


def _samples(where: NDArray[np.bool_], markers: Sequence[str]) -> str:
    """Return the number of samples with their frames and markers as text."""
    frames, columns = np.flatnonzero(where.any(axis=1)), np.flatnonzero(where.any(axis=0))
    count = int(np.count_nonzero(where))
    names = listed((markers[column] for column in columns.tolist()), _MOST_NAMES)
    first, last = int(frames[0]), int(frames[-1])
    span = f"frame {first}" if first == last else f"frames {first} to {last}"
    return f"{count} sample{'s' if count > 1 else ''} ({span}; {names})"


def _most(apart: NDArray[np.float64], unit: str, names: Sequence[str]) -> str:
    frame, column = divmod(int(np.argmax(apart)), apart.shape[1])
    return f"by up to {apart[frame, column]:.3g}{unit} (frame {frame}, {names[column]})"

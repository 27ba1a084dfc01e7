"""Differences between two recordings, masks or weights, by frames and markers."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Comparison, listed
from nodegraph_mocap.face_model import Weights
from nodegraph_mocap.recording import Mask, Trajectories
from nodegraph_tables import differences, name_differences

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

_NAMED = 5


def comparisons() -> tuple[Comparison, ...]:
    """Return the comparisons of this package's types."""
    return (
        Comparison(Trajectories, compare_recordings, recording_parts),
        Comparison(Mask, compare_masks),
        Comparison(Weights, compare_weights, weight_parts),
    )


def compare_recordings(one: Trajectories, other: Trajectories) -> Iterator[str]:
    """Yield what differs: length and markers, then samples with their frames and markers."""
    if one.rate != other.rate:
        yield f"rate was {one.rate:g} Hz, now {other.rate:g} Hz"
    if one.frames != other.frames:
        yield f"had {one.frames} frames, now {other.frames}"
    if one.markers != other.markers:
        yield from name_differences("markers", one.markers, other.markers)
    if one.frames != other.frames or set(one.markers) != set(other.markers):
        return
    other = other.keep(one.markers)
    lone = one.present != other.present
    if lone.any():
        yield f"{_samples(lone, one.markers)} present in one and missing in the other"
    apart = np.nan_to_num(np.linalg.norm(one.positions - other.positions, axis=2))
    if apart.any():
        yield f"{_samples(apart > 0, one.markers)} moved, {_most(apart, one.markers)}"
    relabelled = (one.origin != other.origin) & ~lone
    if relabelled.any():
        yield f"{_samples(relabelled, one.markers)} of another origin"


def recording_parts(recording: Trajectories) -> dict[str, tuple[tuple[str, tuple[str, ...]], ...]]:
    """Return what the positions are made of: frames and markers."""
    return {"positions": (("frame", ()), ("marker", recording.markers))}


def compare_masks(one: Mask, other: Mask) -> Iterator[str]:
    """Yield which samples only one of the masks has."""
    if one.markers != other.markers or one.hidden.shape != other.hidden.shape:
        yield from name_differences("markers", one.markers, other.markers)
        return
    lone = one.hidden != other.hidden
    if lone.any():
        yield f"{_samples(lone, one.markers)} in one mask only"


def compare_weights(one: Weights, other: Weights) -> Iterator[str]:
    """Yield what differs: length and shapes, then weights with their frames and shapes."""
    if one.names != other.names:
        yield from name_differences("shapes", one.names, other.names)
    if len(one.values) != len(other.values):
        yield f"had {len(one.values)} frames, now {len(other.values)}"
    if one.names != other.names or len(one.values) != len(other.values):
        return
    differs = differences(one.values, other.values)
    if differs.any():
        apart = np.nan_to_num(np.abs(one.values - other.values))
        frame, column = divmod(int(np.argmax(apart)), apart.shape[1])
        most = f"by up to {apart[frame, column]:.3g} (frame {frame}, {one.names[column]})"
        yield f"{_samples(differs, one.names)} of another weight, {most}"


def weight_parts(weights: Weights) -> dict[str, tuple[tuple[str, tuple[str, ...]], ...]]:
    """Return what the weights are made of: frames and shapes."""
    return {"values": (("frame", ()), ("shape", weights.names))}


def _samples(where: NDArray[np.bool_], markers: Sequence[str]) -> str:
    """Return how many samples there are, in which frames and of which markers."""
    frames, columns = np.flatnonzero(where.any(axis=1)), np.flatnonzero(where.any(axis=0))
    count = int(np.count_nonzero(where))
    names = listed((markers[column] for column in columns.tolist()), _NAMED)
    first, last = int(frames[0]), int(frames[-1])
    span = f"frame {first}" if first == last else f"frames {first} to {last}"
    return f"{count} sample{'s' if count > 1 else ''} ({span}; {names})"


def _most(apart: NDArray[np.float64], markers: Sequence[str]) -> str:
    frame, column = divmod(int(np.argmax(apart)), apart.shape[1])
    return f"by up to {apart[frame, column]:.3g} mm (frame {frame}, {markers[column]})"

"""Recordings and weights without frames, and their frames, from what a stream says."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph import NodegraphError
from nodegraph_live.packet_reader import as_doubles
from nodegraph_mocap import MarkerFrame, Origin, Trajectories, Weights

if TYPE_CHECKING:
    from numpy.typing import NDArray

_FARTHEST = 1e9  # mm
_MISSING, _MEASURED = np.uint8(Origin.MISSING), np.uint8(Origin.MEASURED)


def recording_header(names: Sequence[str], rate: float) -> Trajectories:
    """Return a recording without frames; names that repeat, or no rate, are a ValueError."""
    if not names:
        raise ValueError("the stream has no markers")
    return Trajectories(positions=np.empty((0, len(names), 3)), markers=tuple(names), rate=rate)


def weights_header(names: Sequence[str], rate: float) -> Weights:
    """Return weights without frames; names that repeat, or no rate, are a ValueError."""
    if not names:
        raise ValueError("the stream has no weights")
    return Weights(values=np.empty((0, len(names))), names=tuple(names), rate=rate)


def marker_frame(numbers: NDArray[np.floating], *, zeros_missing: bool = False) -> MarkerFrame:
    """Return one frame of a recording.

    Parameters
    ----------
    numbers
        (M, 3) millimetres, float32 or float64. A marker is missing if a coordinate is NaN.
    zeros_missing
        Whether a marker at exactly (0, 0, 0) is missing too.

    Raises
    ------
    ValueError
        If a position is infinite or beyond 1e9 mm.
    """
    positions = np.array(numbers, dtype=np.float64)
    missing = np.isnan(positions).any(axis=1)
    if zeros_missing:
        missing |= ~positions.any(axis=1)
    positions[missing] = np.nan
    if (np.abs(positions) > _FARTHEST).any():
        raise ValueError("a position is beyond 1e9 mm")
    return MarkerFrame(positions, np.where(missing, _MISSING, _MEASURED))


def weights_frame(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return one frame of weights, NaN where one is missing; an infinite one is a ValueError."""
    if np.isinf(values).any():
        raise ValueError("a weight is infinite")
    return values


def names_of(header: Trajectories | Weights) -> tuple[str, ...]:
    """Return the names of markers or weights."""
    return header.markers if isinstance(header, Trajectories) else header.names


def count_of_numbers(header: Trajectories | Weights) -> int:
    """Return how many numbers a frame has."""
    return len(names_of(header)) * (3 if isinstance(header, Trajectories) else 1)


def payload_of(header: Trajectories | Weights, numbers: NDArray[np.floating]) -> object:
    """Return a frame from its numbers: x, y and z of each marker, or weights."""
    if isinstance(header, Trajectories):
        return marker_frame(numbers.reshape(-1, 3))
    return weights_frame(as_doubles(numbers))


def numbers_of(payload: Any) -> NDArray[np.float64]:
    """Return the numbers of a frame: x, y and z of each marker, or weights."""
    return payload.positions.ravel() if isinstance(payload, MarkerFrame) else payload


def recording_or_weights(address: str, header: object) -> Trajectories | Weights:
    """Return a header that is one of these; any other is an error that names the address."""
    if isinstance(header, Trajectories | Weights):
        return header
    raise NodegraphError(f"{address}: carries recordings and weights, not {type(header).__name__}")


def recording_only(address: str, header: object) -> Trajectories:
    """Return a header that is one of a recording; any other is an error that names the address."""
    if isinstance(header, Trajectories):
        return header
    raise NodegraphError(f"{address}: carries recordings, not {type(header).__name__}")


def weights_only(address: str, header: object) -> Weights:
    """Return a header that is one of weights; any other is an error that names the address."""
    if isinstance(header, Weights):
        return header
    raise NodegraphError(f"{address}: carries weights, not {type(header).__name__}")

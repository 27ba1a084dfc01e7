"""How recordings and tables are told apart: by frames and markers, by rows and columns."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph import Comparison, listed
from nodegraph_mocap.face_model import Weights
from nodegraph_mocap.recording import Mask, Trajectories
from nodegraph_mocap.shown.stored_figure import StoredFigure
from nodegraph_mocap.tables import Table

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
        Comparison(Table, compare_tables),
        Comparison(StoredFigure, compare_drawings),
    )


def compare_recordings(one: Trajectories, other: Trajectories) -> Iterator[str]:
    """Yield what differs: length and markers, then samples with their frames and markers."""
    if one.rate != other.rate:
        yield f"rate was {one.rate:g} Hz, now {other.rate:g} Hz"
    if one.frames != other.frames:
        yield f"had {one.frames} frames, now {other.frames}"
    if one.markers != other.markers:
        yield from _names_apart("markers", one.markers, other.markers)
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
        yield from _names_apart("markers", one.markers, other.markers)
        return
    lone = one.hidden != other.hidden
    if lone.any():
        yield f"{_samples(lone, one.markers)} in one mask only"


def compare_weights(one: Weights, other: Weights) -> Iterator[str]:
    """Yield what differs: length and shapes, then weights with their frames and shapes."""
    if one.names != other.names:
        yield from _names_apart("shapes", one.names, other.names)
    if len(one.values) != len(other.values):
        yield f"had {len(one.values)} frames, now {len(other.values)}"
    if one.names != other.names or len(one.values) != len(other.values):
        return
    differs = _differs(one.values, other.values)
    if differs.any():
        apart = np.nan_to_num(np.abs(one.values - other.values))
        frame, column = divmod(int(np.argmax(apart)), apart.shape[1])
        most = f"by up to {apart[frame, column]:.3g} (frame {frame}, {one.names[column]})"
        yield f"{_samples(differs, one.names)} of another weight, {most}"


def weight_parts(weights: Weights) -> dict[str, tuple[tuple[str, tuple[str, ...]], ...]]:
    """Return what the weights are made of: frames and shapes."""
    return {"values": (("frame", ()), ("shape", weights.names))}


def compare_tables(one: Table, other: Table) -> Iterator[str]:
    """Yield which columns differ, in how many rows and by how much."""
    before, now = tuple(map(str, one.columns)), tuple(map(str, other.columns))
    if before != now:
        yield from _names_apart("columns", before, now)
    if len(one) != len(other):
        yield f"had {len(one)} rows, now {len(other)}"
        return
    for column in (name for name in one.columns if name in other.columns):
        was, here = one[column].to_numpy(), other[column].to_numpy()
        differs = _differs(was, here)
        if differs.any():
            yield f"{column}: {_rows(differs)}: {_change(was, here, differs)}"


def compare_drawings(one: StoredFigure, other: StoredFigure) -> Iterator[str]:
    """Yield that two figures are not the same, if they are not."""
    if one.svg != other.svg:
        yield "the drawing is another"


def _differs(was: NDArray[Any], now: NDArray[Any]) -> NDArray[np.bool_]:
    differs = np.asarray(was != now, dtype=np.bool_)
    return differs & ~(np.asarray(was != was, np.bool_) & np.asarray(now != now, np.bool_))


def _rows(differs: NDArray[np.bool_]) -> str:
    places = np.flatnonzero(differs)
    return f"row{'s' if len(places) > 1 else ''} {listed(places.tolist(), _NAMED)}"


def _change(was: NDArray[Any], now: NDArray[Any], differs: NDArray[np.bool_]) -> str:
    """Return the largest change, or the first where there are no numbers."""
    place = int(np.argmax(differs))
    if was.dtype.kind in "fiu" and now.dtype.kind in "fiu":
        size = np.abs(now.astype(float) - was.astype(float))
        size[~np.isfinite(size)] = 0.0
        if size.any():
            place = int(np.argmax(size))
            return f"by up to {size[place]:.3g} ({was[place]:.6g}, now {now[place]:.6g})"
    return f"{was[place]}, now {now[place]}"


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


def _names_apart(what: str, one: Sequence[str], other: Sequence[str]) -> Iterator[str]:
    for said, names in (
        ("only before", [name for name in one if name not in set(other)]),
        ("only now", [name for name in other if name not in set(one)]),
    ):
        if names:
            yield f"{what} {said}: {listed(names, _NAMED)}"
    if set(one) == set(other):
        yield f"{what} in another order"

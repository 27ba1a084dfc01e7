"""Recordings that a figure compares: their names and looks, checks, and their truth."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from nodegraph import Across
from nodegraph_mocap import Origin, check_markers
from nodegraph_mocap.checks import twice
from nodegraph_tables.style import Look, looks

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

    from nodegraph import Label
    from nodegraph_mocap import Trajectories

_Value = TypeVar("_Value")


def named(recordings: Across[Trajectories]) -> dict[str, Trajectories]:
    """Return the recordings by their labels, in order.

    Raises
    ------
    ValueError
        If there is none, two have the same labels, or one has no frames or no markers.
    """
    if not len(recordings):
        raise ValueError("there is no recording to draw")
    by_name = by_label("recording", recordings)
    for name, recording in by_name.items():
        check_something(name, recording)
    return by_name


def by_label(kind: str, gathered: Across[_Value]) -> dict[str, _Value]:
    """Return values by their labels, in order; two of the same labels are a ValueError."""
    names = gathered.names()
    repeated = twice(names)
    if repeated:
        raise ValueError(f"several {kind}s are labelled {', '.join(repeated)}")
    return dict(zip(names, gathered.values(), strict=True))


def agreeing(gathered: Across[_Value], labels: Mapping[str, Label]) -> list[_Value]:
    """Return the values that have these labels, along the axes that both have."""
    return [
        value
        for at, value in gathered
        if all(labels.get(axis, label) == label for axis, label in at.items())
    ]


def check_something(name: str, recording: Trajectories) -> None:
    """Raise a ValueError if a recording has no frames or no markers."""
    lacking = "frames" if not recording.frames else "markers" if not recording.markers else ""
    if lacking:
        raise ValueError(f"{name or 'the recording'} has no {lacking}: there is nothing to draw")


def named_looks(recordings: Across[Trajectories]) -> dict[str, Look]:
    """Return a look per recording: that which it has in every figure of the graph.

    Looks are assigned to all combinations of the labels that the graph has, drawn here or not.
    """
    axes = [recordings.labels(axis) for axis in recordings.axes]
    every = tuple(
        (dict(zip(recordings.axes, labels, strict=True)), None) for labels in product(*axes)
    )
    return looks((*recordings.names(), *Across(recordings.axes, every).names()))


def check_frames(recordings: dict[str, Trajectories], frames: Iterable[int]) -> None:
    """Raise a ValueError if a recording lacks one of the frames."""
    wanted = tuple(frames)
    for name, recording in recordings.items():
        beyond = [frame for frame in wanted if not 0 <= frame < recording.frames]
        if beyond:
            there = f"{recording.frames} frames, 0 to {recording.frames - 1}"
            raise ValueError(
                f"no frame {', '.join(map(str, beyond))}{_of(name)}: "
                f"it has {there if recording.frames else 'none'}"
            )


def check_all_markers(recordings: dict[str, Trajectories], markers: Iterable[str]) -> None:
    """Raise a ValueError if a recording lacks one of the markers."""
    wanted = tuple(markers)
    for name, recording in recordings.items():
        check_markers(recording, wanted, what=name or "the recording")


def check_truth(recordings: dict[str, Trajectories], truth: Trajectories | None) -> None:
    """Raise a ValueError if the truth has another number of frames than a recording."""
    for name, recording in recordings.items():
        if truth is not None and truth.frames != recording.frames:
            raise ValueError(
                f"the truth has {truth.frames} frames, the recording{_of(name)} {recording.frames}"
            )


def true_positions(truth: Trajectories | None, recording: Trajectories) -> NDArray[np.float64]:
    """Return the truth of a recording's markers, (T, M, 3); NaN where it is not known."""
    if truth is None:
        return np.full(recording.positions.shape, np.nan)
    return truth.positions_of(recording.markers)


def estimated(recording: Trajectories) -> NDArray[np.bool_]:
    """Return (T, M), True where a sample was filled or repaired."""
    return np.asarray((recording.origin == Origin.FILLED) | (recording.origin == Origin.REPAIRED))


def comparable(recording: Trajectories, truth: Trajectories | None) -> NDArray[np.bool_]:
    """Return (T, M), True where a filled or repaired sample has a known truth.

    If none has one, True where a sample was filled or repaired.
    """
    flags = estimated(recording)
    known = flags & np.isfinite(true_positions(truth, recording)[..., 0])
    return known if known.any() else flags


def _of(name: str) -> str:
    return f" of {name}" if name else ""

"""Several recordings of one take stacked in one array, and one recording combined from them."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Across, Label
from nodegraph_mocap import Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class RecordingStack:
    """Recordings of the same frames and markers.

    Attributes
    ----------
    first : Trajectories
        Its markers, rate and marker set are those of the result.
    positions : (C, T, M, 3) array of float64
    origin : (C, T, M) array of uint8
    """

    first: Trajectories
    positions: NDArray[np.float64]
    origin: NDArray[np.uint8]

    @cached_property
    def shared(self) -> NDArray[np.bool_]:
        """(T, M), True where all recordings have the very same sample, or none has one."""
        same = self.positions == self.positions[0]
        nowhere = np.isnan(self.positions[..., 0]).all(axis=0)
        return np.asarray(same.all(axis=(0, 3)) | nowhere)

    def with_samples(self, positions: NDArray[np.float64]) -> Trajectories:
        """Return one recording: shared samples as they are, the others from `positions`.

        Its origins are, of each sample, the highest that a recording gives it: filled where it
        is filled in one, repaired where it is repaired in one. What none has is missing.
        """
        shared = self.shared
        combined = np.where(shared[..., None], self.positions[0], positions)
        origin = self.origin.max(axis=0)
        origin[np.isnan(combined[..., 0])] = Origin.MISSING
        return replace(self.first, positions=combined, origin=origin, sigma=None, tuning=None)


@dataclass(frozen=True)
class Several:
    """Recordings of one take that are combined.

    Attributes
    ----------
    recordings
        Recordings of the same frames, markers and rate: what several methods made of one.

    Returns
    -------
    Trajectories
        The origin of each sample is the highest that it has in any of them (filled, then
        repaired); without `sigma`.

    Raises
    ------
    ValueError
        If they differ in frames, markers or rate.
    """

    recordings: Across[Trajectories]


def stack_recordings(several: Several) -> RecordingStack:
    """Return the recordings as one array; warn of those that are absent.

    Raises
    ------
    ValueError
        If they have not the same markers, frames and rate; the message says which differs.
    """
    recordings = several.recordings
    (labels, first), *others = recordings.entries
    same = [first]
    for other_labels, other in others:
        _check_alike(_label_text(labels), first, _label_text(other_labels), other)
        same.append(other if other.markers == first.markers else other.keep(first.markers))
    if recordings.absent:
        absent = "; ".join(
            f"{_label_text(absence.labels)} was {absence.kind}" for absence in recordings.absent
        )
        total = len(same) + len(recordings.absent)
        warnings.warn(f"{len(same)} of {total} recordings are combined: {absent}", stacklevel=4)
    return RecordingStack(
        first,
        np.stack([recording.positions for recording in same]),
        np.stack([recording.origin for recording in same]),
    )


def _check_alike(label: str, first: Trajectories, other_label: str, other: Trajectories) -> None:
    apart = sorted(set(first.markers) ^ set(other.markers))
    if apart:
        raise ValueError(
            f"{label} and {other_label} have not the same markers: only one has {', '.join(apart)}"
        )
    for what in ("frames", "rate"):
        value, other_value = getattr(first, what), getattr(other, what)
        if value != other_value:
            raise ValueError(
                f"{what}: {label} has {value}, {other_label} has {other_value}; need the same"
            )


def _label_text(labels: Mapping[str, Label]) -> str:
    return ", ".join(f"{axis}={label}" for axis, label in labels.items())

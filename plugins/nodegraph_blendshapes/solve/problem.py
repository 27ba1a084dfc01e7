"""The least-squares problem: displacements of the markers from the neutral, and the shapes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Refusal, listed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_mocap import BlendshapeModel, Trajectories

SEEN = 0.5
"""Millimetres: a shape that moves no marker so far cannot be seen."""


@dataclass(frozen=True, kw_only=True)
class Problem:
    """A recording beside a model, over the markers that both have.

    Attributes
    ----------
    markers : tuple of M str
        In the model's order, so that the recording's does not matter.
    offsets : (T, M, 3) array of float64
        From the neutral, mm; NaN where a sample is missing.
    present : (T, M) array of bool
    shapes : (K, M, 3) array of float64
        Shapes of the whole model.
    seen : (K,) array of bool
        Whether a shape moves a marker that is present in any frame.
    notes : tuple of str
        Parts of either that were left out.
    """

    markers: tuple[str, ...]
    offsets: NDArray[np.float64]
    present: NDArray[np.bool_]
    shapes: NDArray[np.float64]
    seen: NDArray[np.bool_]
    notes: tuple[str, ...]

    @classmethod
    def of(cls, recording: Trajectories, model: BlendshapeModel) -> Problem:
        """Match a recording with a model by the names of markers.

        Raises
        ------
        Refusal
            If no frame has a marker of the model.
        ValueError
            If the two have no marker in common, or the model no shape.
        """
        if not model.names:
            raise ValueError("the model has no shapes: there is no weight to find")
        markers = _shared(recording, model)
        kept = recording.keep(markers)
        if recording.frames and not kept.present.any():
            raise Refusal("needs a frame in which a marker of the model is present; all are empty")
        places = [model.markers.index(name) for name in markers]
        shapes = model.shapes[:, places]
        seen = moves(shapes[:, kept.present.any(axis=0)])
        return cls(
            markers=markers,
            offsets=kept.positions - model.neutral[places],
            present=kept.present,
            shapes=shapes,
            seen=seen,
            notes=(*_left_out(recording, model), *_unseen(model, seen)),
        )


def moves(shapes: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which of (K, M, 3) shapes move one of the markers by `SEEN` or more."""
    return np.asarray(np.linalg.norm(shapes, axis=2).max(axis=1, initial=0.0) >= SEEN)


def _shared(recording: Trajectories, model: BlendshapeModel) -> tuple[str, ...]:
    known = set(recording.markers)
    shared = tuple(name for name in model.markers if name in known)
    if not shared:
        raise ValueError(
            "recording and model have no marker in common: the recording has "
            f"{listed(recording.markers)}, the model {listed(model.markers)}"
        )
    return shared


def _left_out(recording: Trajectories, model: BlendshapeModel) -> list[str]:
    """Say which markers only one of the two has."""
    notes = []
    for what, ours, other in (
        ("recording", recording.markers, set(model.markers)),
        ("model", model.markers, set(recording.markers)),
    ):
        alone = [name for name in ours if name not in other]
        if alone:
            notes.append(
                f"{len(alone)} of {len(ours)} markers of the {what} are left out, as only the "
                f"{what} has them: {listed(alone)}"
            )
    return notes


def _unseen(model: BlendshapeModel, seen: NDArray[np.bool_]) -> list[str]:
    unseen = [name for name, is_seen in zip(model.names, seen, strict=True) if not is_seen]
    if not unseen:
        return []
    return [
        f"{len(unseen)} of {len(seen)} shapes move no marker of the recording by {SEEN:g} mm and "
        f"cannot be seen; their weight is 0: {', '.join(unseen)}"
    ]

"""A recording as the matrices that estimators of scikit-learn know, and back."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph import Refusal
from nodegraph_mocap import Origin, Trajectories
from nodegraph_mocap.frame_ranges import runs_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

_FEWEST = 2
"""Frames from which a regressor learns, at least."""


def impute(recording: Trajectories, imputer: Any) -> Trajectories:
    """Return a recording whose gaps an imputer has filled."""
    seen = recording.present.any(axis=0)
    positions = recording.positions.copy()
    if recording.present.all() or not seen.any():
        return _filled(recording, positions)
    rows = positions[:, seen].reshape(recording.frames, -1)
    completed = np.asarray(imputer.fit_transform(rows), dtype=np.float64)
    if completed.shape != rows.shape:
        raise Refusal(f"the imputer returns {completed.shape[1]} columns of {rows.shape[1]}")
    positions[:, seen] = completed.reshape(recording.frames, -1, 3)
    return _filled(recording, positions)


def regress(recording: Trajectories, regressor: Any) -> Trajectories:
    """Return a recording whose gaps a regressor has predicted from other markers."""
    from sklearn.base import clone

    present = recording.present
    positions = recording.positions.copy()
    fitted: dict[tuple[int, bytes], Any] = {}
    for marker, start, stop in zip(*runs_of(~present), strict=True):
        others = np.asarray(present[start:stop].all(axis=0))
        learnt = present[:, others].all(axis=1) & present[:, marker]
        if not others.any() or np.count_nonzero(learnt) < _FEWEST:
            continue
        key = int(marker), others.tobytes()
        if key not in fitted:
            fitted[key] = clone(regressor).fit(
                _rows(recording, learnt, others), recording.positions[learnt, marker]
            )
        inside = np.zeros(recording.frames, dtype=bool)
        inside[start:stop] = True
        positions[start:stop, marker] = fitted[key].predict(_rows(recording, inside, others))
    return _filled(recording, positions)


def project(recording: Trajectories, transformer: Any) -> Trajectories:
    """Return a recording with what a transformer keeps of each complete frame."""
    seen = np.asarray(recording.present.any(axis=0))
    whole = np.asarray(recording.present[:, seen].all(axis=1) & seen.any())
    if not whole.any():
        raise Refusal("no frame has every marker, and a transformer takes complete frames only")
    rows = _rows(recording, whole, seen)
    kept = np.asarray(transformer.inverse_transform(transformer.fit_transform(rows)))
    positions = recording.positions.copy()
    positions[np.ix_(whole, seen)] = kept.reshape(len(rows), -1, 3)
    if lost := recording.frames - np.count_nonzero(whole):
        warnings.warn(f"{lost} frames with a missing sample stay as they are", stacklevel=4)
    sigma = recording.sigma
    if sigma is not None:
        moved = (positions != recording.positions).any(axis=2)
        sigma = np.where(moved, np.nan, sigma)
    return replace(recording, positions=positions, sigma=sigma)


def _rows(
    recording: Trajectories, frames: NDArray[np.bool_], markers: NDArray[np.bool_]
) -> NDArray[np.float64]:
    chosen = recording.positions[np.ix_(frames, markers)]
    return chosen.reshape(len(chosen), -1)


def _filled(recording: Trajectories, positions: NDArray[np.float64]) -> Trajectories:
    """Return a recording with what is finite of its missing samples, and warn of the others."""
    known = np.isfinite(positions).all(axis=2)
    changed = ~recording.present & known
    positions = np.where(changed[..., np.newaxis], positions, recording.positions)
    left = np.count_nonzero(~recording.present & ~known)
    if left:
        markers = np.count_nonzero((~recording.present & ~known).any(axis=0))
        warnings.warn(f"{left} samples of {markers} markers left missing", stacklevel=4)
    return recording.with_samples(positions, changed=changed, origin=Origin.FILLED)

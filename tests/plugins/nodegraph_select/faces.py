"""Faces whose markers move together in groups, with pairs and a midline."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from nodegraph_mocap import MarkerSet, Selection, Trajectories

MARKERS = (
    "lip_left", "lip_right", "chin", "brow_left", "brow_right", "cheek_left", "cheek_right",
    "nose", "jaw_left", "jaw_right", "forehead",
)  # fmt: skip
"""In no order, so that the order of names is another one."""


def make_set(markers: tuple[str, ...] = MARKERS) -> MarkerSet:
    sides = [name.removesuffix("_left") for name in markers if name.endswith("_left")]
    return MarkerSet(
        markers=markers,
        pairs=tuple((f"{side}_left", f"{side}_right") for side in sides),
        midline=tuple(name for name in markers if "_" not in name),
    )


def make_face(
    seed: int = 0, *, frames: int = 90, movements: int = 5, noise: float = 0.05
) -> Trajectories:
    """A face that a few movements drive, each moving all markers, some more than others."""
    random = np.random.default_rng(seed)
    time = np.cumsum(random.normal(0, 1, (frames, movements)), axis=0)
    reach = random.gamma(0.4, 1.0, (movements, len(MARKERS), 1))
    direction = random.normal(0, 1, (movements, len(MARKERS), 3))
    positions = random.normal(0, 40, (len(MARKERS), 3)) + np.einsum(
        "tk,kmc->tmc", time, reach * direction
    )
    positions += random.normal(0, noise, positions.shape)
    return Trajectories(positions=positions, markers=MARKERS, rate=60.0, marker_set=make_set())


def make_rigid(face: Trajectories, seed: int = 0) -> Trajectories:
    """The face's first frame in all, as an alignment leaves it: but for rounding, it is still."""
    random = np.random.default_rng(seed)
    rounding = random.normal(0, 1e-12, face.positions.shape)
    return replace(face, positions=face.positions[0] + rounding)


def columns_of(selection: Selection) -> dict[str, NDArray[np.float64]]:
    assert selection.history is not None
    return dict(zip(selection.columns, selection.history.T, strict=True))

"""Heads of known shape and motion, and what NumPy makes of them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from nodegraph_mocap import HeadMotion, MarkerSet, Trajectories

Array = NDArray[np.float64]


def random_rotations(count: int, seed: int = 0) -> Array:
    """Rotations from quaternions spread evenly over the sphere, (count, 3, 3)."""
    quaternions = np.random.default_rng(seed).normal(size=(count, 4))
    w, x, y, z = (quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.array(rows).transpose(2, 0, 1)


def make_recording(positions: Any, stable: int | None = 6, **more: Any) -> Trajectories:
    """Markers m0, m1, ..., of which the first few are stable."""
    names = tuple(f"m{index}" for index in range(np.shape(positions)[1]))
    marker_set = None if stable is None else MarkerSet(markers=names, stable=names[:stable])
    return Trajectories(
        positions=positions, markers=names, rate=60.0, marker_set=marker_set, **more
    )


def make_head(
    frames: int = 20, markers: int = 12, seed: int = 0
) -> tuple[Trajectories, HeadMotion]:
    """A face at rest, and a motion of it anywhere."""
    random = np.random.default_rng(seed)
    rest = make_recording(random.normal([20.0, 1500.0, -300.0], 50, (1, markers, 3)))
    motion = HeadMotion(
        rotations=random_rotations(frames, seed),
        translations=random.normal(0, 400, (frames, 3)),
        scales=np.ones(frames),
    )
    return rest, motion


def run_moved(rest: Trajectories, motion: HeadMotion) -> Trajectories:
    """The face at rest, moved, by the plain formula ``s R x + t``."""
    frames = [
        [scale * rotation @ point + shift for point in rest.positions[0]]
        for rotation, shift, scale in zip(
            motion.rotations, motion.translations, motion.scales, strict=True
        )
    ]
    return make_recording(
        np.array(frames), stable=len(rest.marker_set.stable) if rest.marker_set else None
    )


def plain_fit(
    points: Array, shape: Array, weights: Array | None = None, *, reflection: bool = False
) -> tuple[Array, Array, Array]:
    """Rotation, centre and goal of one frame, by NumPy's singular value decomposition."""
    each = np.ones(len(points)) if weights is None else weights
    centre, goal = each @ points / each.sum(), each @ shape / each.sum()
    u, _, v = np.linalg.svd((shape - goal).T @ (each[:, None] * (points - centre)))
    sign = 1.0 if reflection else np.linalg.det(u @ v)
    return u @ np.diag([1.0, 1.0, sign]) @ v, centre, goal

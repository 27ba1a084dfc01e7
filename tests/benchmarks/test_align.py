"""Aligning 60 markers to a reference: the compiled loops beside NumPy's batched SVD and eigh."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph.plugin.registry import default_registry
from nodegraph_align.poses import fit
from nodegraph_align.procrustes import procrustes
from nodegraph_mocap import Trajectories
from tests.benchmarks.conftest import Clock
from tests.plugins.recordings import make_recording

Positions = NDArray[np.float64]
MARKERS = 60
CASE = "rigid alignment of 60 markers, us/frame"
FRAMES = {600: 300, 60_000: 5}
LANDMARKS = (5, 60)


def nodding(frames: int) -> tuple[Trajectories, Trajectories]:
    """A face that nods, shakes and twitches, and the face at rest."""
    random = np.random.default_rng(0)
    rest = random.normal(0, 50, (MARKERS, 3))
    angles = 0.2 * np.sin(np.arange(frames)[:, None] / [17.0, 29.0])
    positions = rest @ turned(angles[:, 0], 0) @ turned(angles[:, 1], 1)
    positions += random.normal([10.0, 1400.0, 300.0], 0.5, positions.shape)
    return make_recording(positions), make_recording(rest[None])


def turned(angle: NDArray[np.float64], axis: int) -> NDArray[np.float64]:
    result = np.zeros((len(angle), 3, 3))
    first, other = (axis + 1) % 3, (axis + 2) % 3
    result[:, axis, axis] = 1.0
    result[:, first, first] = result[:, other, other] = np.cos(angle)
    result[:, first, other] = np.sin(angle)
    result[:, other, first] = -np.sin(angle)
    return result


def compiled(take: Trajectories, rest: Trajectories, count: int) -> Positions:
    columns = np.arange(count)
    poses = fit(take.positions, columns, rest.positions[0, :count], np.ones((1, count)), "none")
    return poses.moved(take.positions, None).positions


def whole_node(take: Trajectories, rest: Trajectories, count: int) -> Positions:
    return procrustes(take, rest, landmarks=take.markers[:count]).aligned.positions


def centred(take: Trajectories, rest: Trajectories, count: int) -> tuple[Positions, ...]:
    points, shape = take.positions[:, :count], rest.positions[0, :count]
    middle, goal = points.mean(axis=1, keepdims=True), shape.mean(axis=0)
    return middle, goal, (points - middle).transpose(0, 2, 1) @ (shape - goal)


def batched_svd(take: Trajectories, rest: Trajectories, count: int) -> Positions:
    middle, goal, covariance = centred(take, rest, count)
    u, _, v = np.linalg.svd(covariance)
    u[:, :, 2] *= np.linalg.det(u @ v)[:, None]
    return np.asarray((take.positions - middle) @ (u @ v) + goal)


def batched_eigh(take: Trajectories, rest: Trajectories, count: int) -> Positions:
    """Horn's quaternion: the leading eigenvector of a symmetric 4 x 4 matrix."""
    middle, goal, s = centred(take, rest, count)
    n = np.empty((len(s), 4, 4))
    trace = np.trace(s, axis1=1, axis2=2)
    n[:, 0, 0] = trace
    n[:, 0, 1:] = n[:, 1:, 0] = np.stack(
        [s[:, 1, 2] - s[:, 2, 1], s[:, 2, 0] - s[:, 0, 2], s[:, 0, 1] - s[:, 1, 0]], axis=1
    )
    n[:, 1:, 1:] = s + s.transpose(0, 2, 1) - trace[:, None, None] * np.eye(3)
    w, x, y, z = np.linalg.eigh(n)[1][:, :, 3].T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    rotations = np.array(rows).transpose(2, 0, 1)
    return np.asarray((take.positions - middle) @ rotations.transpose(0, 2, 1) + goal)


def plain_loop(take: Trajectories, rest: Trajectories, count: int) -> Positions:
    single = Trajectories(positions=take.positions[:1], markers=take.markers, rate=60.0)
    result = np.empty_like(take.positions)
    for frame in range(take.frames):
        object.__setattr__(single, "positions", take.positions[frame : frame + 1])
        result[frame] = batched_svd(single, rest, count)[0]
    return result


ROWS: dict[str, Callable[[Trajectories, Trajectories, int], Positions]] = {
    "nodegraph": compiled,
    "nodegraph, the whole node": whole_node,
    "NumPy batched svd": batched_svd,
    "NumPy batched eigh (Horn)": batched_eigh,
    "plain loop of NumPy svd": plain_loop,
}


@pytest.mark.parametrize("count", LANDMARKS)
@pytest.mark.parametrize("frames", FRAMES)
@pytest.mark.parametrize("name", ROWS)
def test_rigid_alignment(name: str, frames: int, count: int, clock: Clock) -> None:
    take, rest = nodding(frames)
    rounds = 2 if "loop" in name else FRAMES[frames]
    column = f"{frames:,} frames by {count}"
    result = clock(
        CASE, name, column, lambda: ROWS[name](take, rest, count), per=frames, rounds=rounds
    )
    np.testing.assert_allclose(result, batched_svd(take, rest, count), rtol=0, atol=1e-9)


def alignments() -> list[str]:
    return [
        registered.node.name
        for registered in default_registry()
        if registered.node.family == "align"
    ]


@pytest.mark.parametrize("name", alignments())
def test_every_alignment(name: str, clock: Clock) -> None:
    take, _ = nodding(600)
    align = default_registry().find(name).node.function
    landmarks = take.markers[:10]
    case = "every alignment by its defaults, 600 x 60, 10 landmarks"
    result = clock(case, name, "us/frame", lambda: align(take, landmarks=landmarks), per=600)
    assert np.any(result.aligned.positions != take.positions)

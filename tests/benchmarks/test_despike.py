"""Despiking 600 frames of 60 markers: the impulse filter, and a running median beside others.

scipy and pandas take the median of each coordinate by itself; ours is the vector median, which
does not depend on how the axes lie, and takes more work.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_despike.hampel import hampel
from nodegraph_despike.impulse import impulse
from nodegraph_despike.median import median
from nodegraph_mocap import Trajectories
from tests.benchmarks.conftest import Clock
from tests.plugins.recordings import make_recording, quietly

FRAMES, MARKERS, REACH = 600, 60, 2
IMPULSES = "impulse filter, 600 x 60"
MEDIANS = "running median of 5 frames, 600 x 60"
Positions = NDArray[np.float64]


def spiky() -> Positions:
    random = np.random.default_rng(0)
    positions = np.cumsum(random.normal(0, 0.3, (FRAMES, MARKERS, 3)), axis=0)
    hit = random.random((FRAMES, MARKERS)) < 0.005
    positions[hit] += random.normal(0, 8, (np.count_nonzero(hit), 3))
    return positions


def plain_loop(positions: Positions) -> Positions:
    result = positions.copy()
    for marker in range(MARKERS):
        track = positions[:, marker].tolist()
        steps = [math.dist(track[i], track[i - 1]) for i in range(1, FRAMES)]
        bar = 1.5 * sum(steps) / len(steps)
        for i in range(1, FRAMES - 1):
            if steps[i - 1] >= bar and steps[i] >= bar:
                for axis in range(3):
                    result[i, marker, axis] = (track[i - 1][axis] + track[i + 1][axis]) / 2
    return result


def vectorised(positions: Positions) -> Positions:
    steps = np.sqrt((np.diff(positions, axis=0) ** 2).sum(axis=2))
    long = steps >= 1.5 * steps.mean(axis=0)
    bad = np.zeros(positions.shape[:2], dtype=np.bool_)
    bad[1:-1] = long[:-1] & long[1:]
    frame, marker = np.nonzero(bad)
    result = positions.copy()
    result[frame, marker] = (positions[frame - 1, marker] + positions[frame + 1, marker]) / 2
    return result


def kernel(order: str) -> Callable[[Positions], Positions]:
    from nodegraph_despike import impulse_kernel

    def run(positions: Positions) -> Positions:
        bar = impulse_kernel.bars(positions, 1.5)
        repaired = positions.copy()
        getattr(impulse_kernel, order)(repaired, positions, bar, 1)
        return repaired

    return run


def node(
    method: Callable[..., Trajectories], **settings: object
) -> Callable[[Positions], Positions]:
    take = make_recording(spiky())

    def run(positions: Positions) -> Positions:
        return quietly(method, take, **settings).positions

    return run


def medfilt(positions: Positions) -> Positions:
    from scipy.signal import medfilt

    return np.asarray(medfilt(positions, (2 * REACH + 1, 1, 1)))


def rolling(positions: Positions) -> Positions:
    from pandas import DataFrame

    flat = DataFrame(positions.reshape(FRAMES, -1))
    result = flat.rolling(2 * REACH + 1, center=True, min_periods=1).median()
    return result.to_numpy().reshape(positions.shape)


FILTERS: dict[str, tuple[Callable[[], Callable[[Positions], Positions]], int]] = {
    "nodegraph": (lambda: kernel("simultaneous"), 50),
    "nodegraph, the whole node": (lambda: node(impulse), 50),
    "vectorised NumPy": (lambda: vectorised, 20),
    "plain loop": (lambda: plain_loop, 3),
}
MEDIAN_FILTERS: dict[str, Callable[[], Callable[[Positions], Positions]]] = {
    "nodegraph": lambda: node(median, reach=REACH, threshold=0.0),
    "nodegraph, Hampel": lambda: node(hampel, reach=REACH),
    "scipy.signal.medfilt": lambda: medfilt,
    "pandas, rolling": lambda: rolling,
}


@pytest.mark.parametrize("name", FILTERS)
def test_impulse_filter(name: str, clock: Clock) -> None:
    make, rounds = FILTERS[name]
    positions, run = spiky(), make()
    result = clock(IMPULSES, name, "us/frame", lambda: run(positions), per=FRAMES, rounds=rounds)
    assert np.allclose(result, vectorised(positions), rtol=0, atol=1e-12)
    assert np.any(result != positions)


@pytest.mark.parametrize("order", ["in_place", "redetect"])
def test_other_orders(order: str, clock: Clock) -> None:
    positions, run = spiky(), kernel(order)
    name = f"nodegraph, {order}"
    result = clock(IMPULSES, name, "us/frame", lambda: run(positions), per=FRAMES, rounds=20)
    assert np.any(result != positions)


@pytest.mark.parametrize("name", MEDIAN_FILTERS)
def test_running_median(name: str, clock: Clock) -> None:
    positions, run = spiky(), MEDIAN_FILTERS[name]()
    result = clock(MEDIANS, name, "us/frame", lambda: run(positions), per=FRAMES, rounds=5)
    inner = slice(REACH, FRAMES - REACH)
    near = np.linalg.norm((result - medfilt(positions))[inner], axis=2)
    # Its own median or a coordinate's: both are among the samples of the window.
    assert np.median(near) < 1.0
    assert np.any(result != positions)

"""Smoothing 60 markers: the B-spline of order 3 beside a memory copy, and the other methods.

New memory costs more than the arithmetic: rows that write into a buffer in hand are told apart
from those that allocate their result.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph.plugin.registry import default_registry
from nodegraph_mocap import Trajectories
from nodegraph_smooth.bspline import bspline, curve_into
from nodegraph_smooth.bspline_weights import first_rows, middle
from nodegraph_smooth.gcv import gcv
from nodegraph_smooth.present_runs import Runs
from tests.benchmarks.conftest import Clock
from tests.plugins.recordings import make_recording

Positions = NDArray[np.float64]
MARKERS = 60
CASE = "B-spline of order 3, ns per frame of 60 markers"
COUNTS = {600: 2000, 60_000: 40}
WEIGHTS = np.array([1.0, 4.0, 1.0]) / 6.0


def noisy(frames: int) -> Trajectories:
    random = np.random.default_rng(0)
    positions = np.cumsum(random.normal(0, 0.3, (frames, MARKERS, 3)), axis=0)
    return make_recording(positions)


def into_a_buffer(take: Trajectories) -> Callable[[], Positions]:
    from nodegraph_smooth import weights_kernel

    result, runs = np.zeros_like(take.positions), Runs.of(take)
    places = middle(3), runs.marker, runs.start, runs.stop, first_rows(3, "vertex")

    def run() -> Positions:
        weights_kernel.curve_into(result, take.positions, *places)
        return result

    return run


def into_new_memory(take: Trajectories) -> Callable[[], Positions]:
    runs = Runs.of(take)

    def run() -> Positions:
        result = np.empty_like(take.positions)
        curve_into(result, take.positions, runs, 3, "vertex")
        return result

    return run


def copy(take: Trajectories) -> Callable[[], Positions]:
    result = np.zeros_like(take.positions)

    def run() -> Positions:
        np.copyto(result, take.positions)
        return result

    return run


def convolved(take: Trajectories, result: Positions | None) -> Callable[[], Positions]:
    from scipy.ndimage import convolve1d

    return lambda: np.asarray(
        convolve1d(take.positions, WEIGHTS, axis=0, mode="nearest", output=result)
    )


def vectorised(take: Trajectories) -> Callable[[], Positions]:
    def run() -> Positions:
        x = take.positions
        result = np.empty_like(x)
        result[1:-1] = (x[:-2] + 4.0 * x[1:-1] + x[2:]) / 6.0
        result[[0, -1]] = x[[0, -1]]
        return result

    return run


def plain_loop(take: Trajectories) -> Callable[[], Positions]:
    def run() -> Positions:
        result = take.positions.copy()
        for marker in range(MARKERS):
            for axis in range(3):
                x = take.positions[:, marker, axis].tolist()
                result[1:-1, marker, axis] = [
                    (x[t - 1] + 4.0 * x[t] + x[t + 1]) / 6.0 for t in range(1, len(x) - 1)
                ]
        return result

    return run


ROWS: dict[str, Callable[[Trajectories], Callable[[], Positions]]] = {
    "nodegraph": into_a_buffer,
    "memory copy into a buffer": copy,
    "scipy convolve1d into a buffer": lambda take: convolved(take, np.zeros_like(take.positions)),
    "nodegraph, new memory": into_new_memory,
    "nodegraph, the whole node": lambda take: lambda: bspline(take).positions,
    "scipy convolve1d, new memory": lambda take: convolved(take, None),
    "vectorised NumPy": vectorised,
    "plain loop": plain_loop,
}


@pytest.mark.parametrize("frames", COUNTS)
@pytest.mark.parametrize("name", ROWS)
def test_bspline(name: str, frames: int, clock: Clock) -> None:
    take, rounds = noisy(frames), COUNTS[frames]
    if name == "plain loop":
        rounds = 3
    run = ROWS[name](take)
    result = clock(CASE, name, f"{frames:,} frames", run, per=frames, scale=1e9, rounds=rounds)
    expected = take.positions if "copy" in name else vectorised(take)()
    np.testing.assert_allclose(result[1:-1], expected[1:-1], rtol=0, atol=1e-11)


def smoothings() -> list[str]:
    return [
        registered.node.name
        for registered in default_registry()
        if registered.node.family == "smooth"
    ]


@pytest.mark.parametrize("name", smoothings())
def test_every_smoothing(name: str, clock: Clock) -> None:
    take, smooth = noisy(600), default_registry().find(name).node.function
    case = "every smoothing by its defaults, 600 x 60"
    result = clock(case, name, "us/frame", lambda: smooth(take), per=600, rounds=5)
    assert np.any(result.positions != take.positions)


def scipy_gcv(take: Trajectories) -> Positions:
    from scipy.interpolate import make_smoothing_spline

    frame = np.arange(float(take.frames))
    result = [make_smoothing_spline(frame, run)(frame) for run in take.positions[:, 0].T]
    return np.stack(result, axis=1)


PEERS: dict[str, Callable[[Trajectories], object]] = {
    "nodegraph": lambda take: gcv(take).positions[:, 0],
    "scipy make_smoothing_spline": scipy_gcv,
}


@pytest.mark.parametrize("name", PEERS)
def test_cross_validation(name: str, clock: Clock) -> None:
    single = noisy(600).keep(["m0"])
    case = "smoothing spline by cross-validation, 600 frames of one marker"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = clock(case, name, "ms", lambda: PEERS[name](single), scale=1e3, rounds=3)
    assert np.abs(result - single.positions[:, 0]).max() < 3.0

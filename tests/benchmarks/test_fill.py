"""Filling 600 frames of 60 markers, a twentieth and a fifth of them missing, beside others.

The step-wise fills stand beside a plain loop of the same rule, and the straight line beside
pandas and xarray. Gaps are 15 frames long, as from `gaps.cut`. What learns from the whole take
fills a made face.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_fill.bilinear import bilinear
from nodegraph_fill.guenter import guenter
from nodegraph_fill.lin_ouhyoung import lin_ouhyoung
from nodegraph_fill.linear import linear
from nodegraph_fill.muscle import muscle
from nodegraph_fill.ridge import ridge
from nodegraph_fill.soft_impute import soft_impute
from nodegraph_fill.stepwise import Rule, _Pass
from nodegraph_fill.subspace_kalman import subspace_kalman
from nodegraph_fill.waters import waters
from nodegraph_gaps.cut import cut
from nodegraph_mocap import Trajectories
from nodegraph_synthesize.face import synthesize_face
from tests.benchmarks.conftest import Clock
from tests.plugins.recordings import make_recording, quietly

FRAMES, MARKERS, GAP = 600, 60, 15
SHARES = (0.05, 0.2)
Positions = NDArray[np.float64]
Fill = Callable[..., Trajectories]


def take(share: float) -> Trajectories:
    """Markers that walk about, with gaps of 15 frames at random."""
    random = np.random.default_rng(0)
    places = random.normal(0, 40, (MARKERS, 3))
    positions = places + np.cumsum(random.normal(0, 0.3, (FRAMES, MARKERS, 3)), axis=0)
    while np.isnan(positions[..., 0]).mean() < share:
        start = int(random.integers(1, FRAMES - GAP - 1))
        positions[start : start + GAP, random.integers(MARKERS)] = np.nan
    return make_recording(positions)


def kernel(recording: Trajectories, **rule: Any) -> Callable[[], Positions]:
    """The compiled loop alone, its buffers included."""
    from nodegraph_fill.gaps import Gaps

    gaps, chosen = Gaps.of(recording), Rule(use_filled=True, **rule)

    def run() -> Positions:
        result = _Pass.over(recording)
        result.run(gaps, chosen, backward=False)
        return result.positions

    return run


def node(fill: Fill, recording: Trajectories) -> Callable[[], Positions]:
    def run() -> Positions:
        return quietly(fill, recording).positions

    return run


def plain_loop(recording: Trajectories) -> Callable[[], Positions]:
    """The mean displacement of the three nearest neighbours, frame by frame."""

    def run() -> Positions:
        positions = recording.positions.copy()
        for now in range(1, FRAMES):
            for marker in np.flatnonzero(np.isnan(positions[now, :, 0])):
                then, here = positions[now - 1], positions[now]
                usable = np.flatnonzero(~np.isnan(then[:, 0]) & ~np.isnan(here[:, 0]))
                apart = ((then[usable] - then[marker]) ** 2).sum(axis=1)
                nearest = usable[np.argsort(apart, kind="stable")[:3]]
                positions[now, marker] = then[marker] + (here[nearest] - then[nearest]).mean(axis=0)
        return positions

    return run


def with_pandas(recording: Trajectories) -> Callable[[], Positions]:
    import pandas as pd

    table = pd.DataFrame(recording.positions.reshape(FRAMES, -1))
    return lambda: np.asarray(table.interpolate(limit_area="inside").to_numpy())


def with_xarray(recording: Trajectories) -> Callable[[], Positions]:
    xarray = pytest.importorskip("xarray")
    array = xarray.DataArray(recording.positions, dims=("time", "marker", "space"))
    return lambda: np.asarray(array.interpolate_na("time", use_coordinate=False).to_numpy())


KERNELS: dict[str, dict[str, object]] = {
    "guenter": {"weights": "mean", "neighbours": 3, "ring": 8},
    "lin_ouhyoung": {"weights": "cosine", "neighbours": 8},
    "muscle": {"weights": "muscle", "neighbours": 3},
    "waters": {"weights": "waters", "neighbours": 1, "full_radius": 15.0, "falloff_radius": 45.0},
}
NODES: dict[str, Fill] = {
    "guenter": guenter,
    "lin_ouhyoung": lin_ouhyoung,
    "muscle": muscle,
    "waters": waters,
}
WHOLE_TAKE: dict[str, Fill] = {
    "bilinear": bilinear,
    "ridge": ridge,
    "soft_impute": soft_impute,
    "subspace_kalman": subspace_kalman,
}


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("method", WHOLE_TAKE)
def test_fills_from_the_whole_take(method: str, seed: int, clock: Clock) -> None:
    face = synthesize_face(seconds=10.0, seed=seed, noise=0.1, missing=0.05, impulses=0.005)
    gappy = cut(face.captured, truth=face.truth).gappy

    def run() -> Positions:
        # of the same recording, fills know what they have found
        return WHOLE_TAKE[method](replace(gappy)).positions

    case = f"600 frames of a face, seed {seed}"
    result = clock(case, f"fill.{method}", "ms", run, scale=1e3, rounds=5)
    assert not np.isnan(result).any()


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("method", KERNELS)
def test_stepwise_kernels(method: str, share: float, clock: Clock) -> None:
    recording = take(share)
    run = kernel(recording, **KERNELS[method])
    result = clock(_case(method, share), "nodegraph", "us/frame", run, per=FRAMES, rounds=30)
    assert np.isnan(result).sum() < np.isnan(recording.positions).sum()


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("method", NODES)
def test_stepwise_nodes(method: str, share: float, clock: Clock) -> None:
    recording = take(share)
    run = node(NODES[method], recording)
    name = "nodegraph, the whole node"
    result = clock(_case(method, share), name, "us/frame", run, per=FRAMES, rounds=30)
    assert np.isnan(result).sum() < np.isnan(recording.positions).sum()


@pytest.mark.parametrize("share", SHARES)
def test_plain_loop(share: float, clock: Clock) -> None:
    recording = take(share)
    run = plain_loop(recording)
    result = clock(_case("guenter", share), "plain loop", "us/frame", run, per=FRAMES, rounds=3)
    assert np.isnan(result).sum() < np.isnan(recording.positions).sum()


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("name", ["nodegraph", "pandas", "xarray"])
def test_straight_lines(name: str, share: float, clock: Clock) -> None:
    recording = take(share)
    ways = {"pandas": with_pandas, "xarray": with_xarray}
    ours = node(linear, recording)
    run = ours if name == "nodegraph" else ways[name](recording)
    case = f"straight lines, {share:.0%} missing"
    result = clock(case, name, "us/frame", run, per=FRAMES, rounds=10)
    expected = ours().reshape(result.shape)
    known = ~np.isnan(expected)
    np.testing.assert_allclose(result[known], expected[known], rtol=0, atol=1e-9)


def _case(method: str, share: float) -> str:
    return f"fill.{method}, {share:.0%} missing"

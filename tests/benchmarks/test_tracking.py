"""Tracking a face's points: trackpy and ours on the same points, how fast and how right."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_mocap import Trajectories
from nodegraph_track.assignment import assignment
from nodegraph_track.nearest import nearest
from nodegraph_track.neighbours import neighbours
from tests.benchmarks.conftest import Clock
from tests.benchmarks.tables import OURS, Tables
from tests.benchmarks.trackers import Scene, Trackpy, best_of_trackpy, recording_of, scene
from tests.plugins.recordings import quietly

CASE = "tracking points, 2 % dropped, 1 % ghosts, ms per take"
RIGHT = "the same: wrong links among 1000"
SCENES = ("jaw", "cheeks", "made face")
TRACKERS = {
    OURS: assignment,
    "nodegraph, neighbours": neighbours,
    "nodegraph, nearest": nearest,
}


@cache
def given(name: str) -> Scene:
    return scene(name)


@cache
def best(name: str) -> Trackpy:
    return best_of_trackpy(given(name))


def tracked(row: str, case: Scene, gate: float | None = None) -> Trajectories:
    return quietly(TRACKERS[row], case.detections, gate=gate)


def wrong(case: Scene, tracks: Trajectories) -> float:
    score = case.score(tracks)
    return float(1000.0 * score["switches"].sum() / score["links"].sum())


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("row", TRACKERS)
def test_ours(row: str, name: str, clock: Clock, tables: Tables) -> None:
    case = given(name)
    result = clock(CASE, row, name, lambda: tracked(row, case), scale=1e3, rounds=9)
    tables.put(RIGHT, row.replace(OURS, "ours"), name, wrong(case, result))
    assert result.frames == case.truth.frames


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("predicted", [False, True], ids=["plain", "predicted"])
def test_trackpy(predicted: bool, name: str, clock: Clock, tables: Tables) -> None:
    case, settings = given(name), replace(best(name), predicted=predicted)
    row = "trackpy, velocity predicted" if predicted else "trackpy"
    run, rounds = settings.linker(case.detections), 1 if predicted else 5
    linked = clock(CASE, row, name, run, scale=1e3, rounds=rounds)
    theirs = wrong(case, recording_of(linked, case.detections))
    tables.put(RIGHT, row, name, theirs)
    assert wrong(case, tracked(OURS, case)) <= theirs


@pytest.mark.parametrize("row", TRACKERS)
def test_switches_and_fragments_are_those_that_motmetrics_counts(row: str) -> None:
    motmetrics = pytest.importorskip("motmetrics")
    case = given("made face")
    # a gate so narrow that many tracks break, some of them on ghosts
    result = tracked(row, case, gate=1.0)
    counted = motmetrics.MOTAccumulator(auto_id=True)
    for truth, outcome in zip(case.truth.positions, result.positions, strict=True):
        there, here = (np.flatnonzero(~np.isnan(part[:, 0])) for part in (truth, outcome))
        counted.update(there, here, _same(truth[there], outcome[here]))
    names = ["num_switches", "num_fragmentations", "num_objects", "num_detections"]
    expected = motmetrics.metrics.create().compute(counted, metrics=names).iloc[0]
    score = case.score(result)
    assert score["switches"].sum() == expected["num_switches"] > 20
    assert score["fragments"].sum() == expected["num_fragmentations"] > 20
    assert score["samples"].sum() == expected["num_objects"]
    assert (score["tracked"] * score["samples"]).sum() == pytest.approx(expected["num_detections"])


def _same(truth: NDArray[np.float64], result: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return 0 where a track has a marker's very position, NaN elsewhere."""
    equal = (truth[:, None] == result).all(axis=2)
    return np.where(equal, 0.0, np.nan)

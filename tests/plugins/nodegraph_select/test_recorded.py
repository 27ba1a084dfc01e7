"""What principal feature analysis does on recorded faces."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from nodegraph_files import read_live_link, read_marker_set_yaml, read_model_npz
from nodegraph_mocap import Selection, Trajectories
from nodegraph_select.greedy import greedy
from nodegraph_select.pfa import pfa
from nodegraph_select.qr import qr
from nodegraph_select.random import random
from nodegraph_select.variance import variance
from tests.plugins.recordings import quietly, real_take
from tests.studies import DATA, needs_recordings

TAKES = ("jaw", "cheeks", "take001", "actor_a", "actor_b")

pytestmark = needs_recordings


@cache
def take(name: str) -> Trajectories:
    """Optical takes as they are, the others as their weights pose the head that holds still."""
    if name in ("jaw", "cheeks"):
        marker_set = read_marker_set_yaml(DATA / "animface" / "markers.yaml")
        return replace(
            real_take(f"animface/{name}").keep(marker_set.markers), marker_set=marker_set
        )
    values, names, rate = weights(name)
    model = read_model_npz(DATA / "facecap" / "model_60_markers.npz")
    shapes = {shape.lower(): offsets for shape, offsets in zip(model.names, model.shapes)}  # noqa: B905
    known = [place for place, shape in enumerate(names) if shape.lower() in shapes]
    offsets = np.stack([shapes[names[place].lower()] for place in known])
    return Trajectories(
        positions=model.neutral + np.einsum("tk,kmc->tmc", values[:, known], offsets),
        markers=model.markers,
        rate=rate,
        marker_set=read_marker_set_yaml(DATA / "facecap" / "markers.yaml"),
    )


def weights(name: str) -> tuple[Any, tuple[str, ...], float]:
    if name == "take001":
        truth = np.load(DATA / "facecap" / "take001_truth.npz")
        return truth["weights"], tuple(map(str, truth["shape_names"])), 30.0
    file = {"actor_a": "actor_a_60fps.csv", "actor_b": "actor_b_30fps.csv"}[name]
    read = read_live_link(DATA / "livelink" / file)
    present = np.isfinite(read.values).all(axis=1)
    return read.values[present], read.names, read.rate


@cache
def recorded_selection(name: str, k: int) -> tuple[Selection, dict[str, Any]]:
    selection = quietly(pfa, quietly(take, name), k=k)
    assert selection.history is not None
    return selection, dict(zip(selection.columns, selection.history.T, strict=True))


@pytest.mark.parametrize("name", TAKES)
def test_runs_hardly_ever_agree(name: str) -> None:
    for k in (20, 30):
        _, history = recorded_selection(name, k)
        assert history["selection"].max() + 1 > 900


@pytest.mark.parametrize("name", TAKES)
def test_the_sum_favours_large_selections_the_more_the_larger_k_is(name: str) -> None:
    likeness = []
    for k in (10, 20, 30, 40):
        _, history = recorded_selection(name, k)
        likeness.append(np.corrcoef(history["sum"], history["markers"])[0, 1])
        assert np.corrcoef(history["mean"], history["markers"])[0, 1] < likeness[-1]
    assert 0.25 < likeness[0] < 0.75
    assert 0.85 < likeness[-1] < 0.98
    assert likeness == sorted(likeness)


@pytest.mark.parametrize("name", TAKES)
def test_more_clusters_choose_more_markers(name: str) -> None:
    sizes = [len(recorded_selection(name, k)[0].chosen) for k in (5, 10, 20, 40)]
    assert sizes == sorted(set(sizes))
    assert 2 * 5 >= sizes[0] >= 5


@pytest.mark.parametrize("name", ["jaw", "take001"])
def test_every_run_settles(name: str) -> None:
    assert recorded_selection(name, 20)[1]["rounds"].max() < 60


def left(recording: Trajectories, chosen: tuple[str, ...]) -> float:
    """Return the share of all motion that a regression from some markers does not predict.

    Every fourth frame is enough for it.
    """
    centred = recording.positions[::4] - recording.positions[::4].mean(axis=0)
    every = centred.reshape(len(centred), -1)
    some = recording.keep(chosen).positions[::4]
    some = (some - some.mean(axis=0)).reshape(len(centred), -1)
    rest = every - some @ np.linalg.lstsq(some, every, rcond=1e-9)[0]
    return float((rest**2).sum() / (every**2).sum())


@pytest.mark.parametrize("name", ["jaw", "cheeks"])
def test_at_ten_markers_what_avoids_repetition_beats_chance(name: str) -> None:
    recording = take(name)
    chance = np.median([left(recording, random(recording, k=10, seed=i).chosen) for i in range(20)])
    methods: tuple[Callable[..., Selection], ...] = (greedy, qr, variance)
    rest = {method: left(recording, method(recording, k=10).chosen) for method in methods}
    assert rest[qr] < chance
    assert rest[greedy] < min(chance, rest[variance])

"""Recordings of a real face without their names, and tracked again."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest

from nodegraph_mocap import read_c3d
from nodegraph_score.tracking import tracking
from nodegraph_track.assignment import assignment
from nodegraph_track.scatter import scatter

FOLDER = Path(__file__).parents[3] / ".." / "shared" / "data" / "animface"


@pytest.mark.skipif(not FOLDER.exists(), reason="the recordings are not part of the package")
@pytest.mark.parametrize("name", ["jaw", "cheeks"])
@pytest.mark.parametrize("seed", range(3))
def test_nearly_every_link_is_right(name: str, seed: int) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        take = read_c3d(FOLDER / f"{name}.c3d")
        detections, truth = scatter(take, dropout=0.02, ghosts=0.01, seed=seed)
        score = tracking(assignment(detections), truth)
    assert np.average(score["right"], weights=score["links"]) > 0.9999
    assert score["tracked"].mean() == pytest.approx(0.98, abs=0.0005)


@pytest.mark.skipif(not FOLDER.exists(), reason="the recordings are not part of the package")
@pytest.mark.parametrize("name", ["jaw", "cheeks"])
def test_without_ghosts_every_link_is_right(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        take = read_c3d(FOLDER / f"{name}.c3d")
        detections, truth = scatter(take, dropout=0.02)
        score = tracking(assignment(detections), truth)
    assert (score["right"] == 1.0).all()
    assert score["switches"].sum() == 0

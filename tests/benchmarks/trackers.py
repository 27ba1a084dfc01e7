"""trackpy, on the points that our trackers get: in its own form, with the best of its settings."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import pytest

from nodegraph_files import read_c3d
from nodegraph_mocap import Detections, Table, Trajectories
from nodegraph_score.tracking import tracking
from nodegraph_synthesize.face import synthesize_face
from nodegraph_track.points_scatter import scatter
from tests.plugins.recordings import quietly
from tests.studies import DATA

ANIMFACE = DATA / "animface"
SHORTEST = 3
"""Tracks of fewer points are left out of ours by default, and here as well."""


@dataclass(frozen=True)
class Scene:
    """Points without names, and whose they were."""

    detections: Detections
    truth: Trajectories

    def score(self, tracks: Trajectories) -> Table:
        """Return how right tracks are; see `score.tracking`."""
        return quietly(tracking, tracks, self.truth)


def scene(name: str) -> Scene:
    """Return a take with 2 % of its points dropped and 1 % ghosts added."""
    if name == "made face":
        take = synthesize_face().captured
    elif not ANIMFACE.is_dir():
        pytest.skip("the recordings are not here")
    else:
        take = read_c3d(ANIMFACE / f"{name}.c3d")
    return Scene(*scatter(take, dropout=0.02, ghosts=0.01))


@dataclass(frozen=True)
class Trackpy:
    """Settings of trackpy's linker.

    Attributes
    ----------
    search_range : float
        mm.
    memory : int
        Frames that a track waits for a point.
    predicted : bool
        Whether it links about predicted positions, by the velocity of the nearest tracks.
    """

    search_range: float
    memory: int
    predicted: bool = False

    def linker(self, detections: Detections) -> Callable[[], object]:
        """Return what links; the points are in trackpy's form already."""
        trackpy: Any = pytest.importorskip("trackpy")
        trackpy.quiet()
        points = _points(detections)
        words = {"memory": self.memory, "pos_columns": ["x", "y", "z"]}

        def run() -> object:
            predictor = trackpy.predict.NearestVelocityPredict(span=1)
            link = predictor.link_df if self.predicted else trackpy.link
            return link(points, self.search_range, **words)

        return run


def best_of_trackpy(given: Scene) -> Trackpy:
    """Return the settings by which fewest links are wrong, then most samples are tracked."""
    return max(_tried(given), key=lambda value: value[0])[1]


def recording_of(linked: Any, detections: Detections) -> Trajectories:
    """Return trackpy's particles as trajectories, without those of fewer than 3 points."""
    sizes = linked.groupby("particle")["frame"].transform("size")
    kept = linked[sizes >= SHORTEST]
    particles, column = np.unique(kept["particle"], return_inverse=True)
    positions = np.full((detections.frames, len(particles), 3), np.nan)
    positions[kept["frame"].to_numpy(dtype=np.intp), column] = kept[["x", "y", "z"]].to_numpy()
    names = tuple(f"p{particle}" for particle in particles)
    return Trajectories(positions=positions, markers=names, rate=detections.rate)


def _tried(given: Scene) -> Iterator[tuple[tuple[float, float], Trackpy]]:
    trackpy: Any = pytest.importorskip("trackpy")
    for search_range, memory in product((5.0, 8.0, 11.0, 14.0), (3, 30, 60)):
        settings = Trackpy(search_range, memory)
        try:
            linked = settings.linker(given.detections)()
        except trackpy.SubnetOversizeException:  # it gives up where too many points are near
            continue
        score = given.score(recording_of(linked, given.detections))
        yield (-score["switches"].sum(), score["tracked"].mean()), settings


def _points(detections: Detections) -> object:
    from pandas import DataFrame

    points = DataFrame(detections.points, columns=["x", "y", "z"])
    points["frame"] = np.repeat(np.arange(detections.frames), np.diff(detections.offsets))
    return points

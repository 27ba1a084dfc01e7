"""Takes whose names are taken away, and which of them are found again."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import cache, lru_cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from nodegraph_files import read_marker_set_yaml
from nodegraph_mocap import MarkerSet, Trajectories
from nodegraph_synthesize.face import SyntheticFace, synthesize_face
from tests.plugins.recordings import real_take
from tests.studies import DATA

TAKES = {"jaw": "animface", "cheeks": "animface", "take001": "facecap"}
"""The folder of each take."""


@contextmanager
def quiet() -> Iterator[None]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


@lru_cache(maxsize=4)
def face(**settings: Any) -> SyntheticFace:
    return synthesize_face(**settings)


@cache
def read_take(name: str) -> tuple[Trajectories, MarkerSet]:
    if not DATA.exists():
        pytest.skip("the recordings are not part of the package")
    folder = TAKES[name]
    return real_take(f"{folder}/{name}"), read_marker_set_yaml(DATA / folder / "markers.yaml")


def without_names(recording: Trajectories, seed: int = 0) -> Trajectories:
    """Return a recording in random order, under names that say nothing, without a marker set."""
    order = np.random.default_rng(seed).permutation(len(recording.markers))
    mixed = recording.keep([recording.markers[index] for index in order])
    names = tuple(f"t{number:03d}" for number in range(len(order)))
    return replace(mixed, markers=names, marker_set=None)


def turned(recording: Trajectories) -> Trajectories:
    """Turn a take by 40 degrees, and shift it by more than 500 mm."""
    turn = Rotation.from_rotvec(np.radians(40) * np.array([0.6, 0.64, 0.48])).as_matrix()
    shift = np.array([500.0, -300.0, 200.0])
    return replace(recording, positions=recording.positions @ turn.T + shift)


def correct(result: Trajectories, truth: Trajectories) -> NDArray[np.bool_]:
    """Return which samples of the truth are in a recording under the right name, (T, M)."""
    same = result.keep(truth.markers).positions == truth.positions
    return np.asarray(same.all(axis=2))

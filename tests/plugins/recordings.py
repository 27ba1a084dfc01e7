"""Recordings of markers m0, m1, ... with gaps anywhere, and calls without their warnings."""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Callable
from functools import cache
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nodegraph_files import read_c3d
from nodegraph_mocap import Origin, Trajectories
from tests.studies import DATA

T = TypeVar("T")


def make_recording(positions: ArrayLike, origin: Any = None, rate: float = 60.0) -> Trajectories:
    array = np.asarray(positions, dtype=np.float64)
    names = tuple(f"m{index}" for index in range(array.shape[1]))
    return Trajectories(positions=array, markers=names, rate=rate, origin=origin)


def make_gappy(seed: int, *, most_frames: int = 30, most_markers: int = 9) -> Trajectories:
    """A few markers that walk about, with gaps anywhere, and samples of every origin."""
    random = np.random.default_rng(seed)
    frames, markers = int(random.integers(1, most_frames)), int(random.integers(1, most_markers))
    places = random.normal(0, 30, (markers, 3))
    positions = places + np.cumsum(random.normal(0, 1, (frames, markers, 3)), axis=0)
    kinds = [Origin.MEASURED, Origin.MEASURED, Origin.REPAIRED, Origin.FILLED]
    origin = random.choice(kinds, (frames, markers)).astype(np.uint8)
    for _ in range(int(random.integers(0, 3 * markers))):
        marker, start = random.integers(markers), int(random.integers(-8, frames))
        origin[max(start, 0) : start + int(random.integers(1, 14)), marker] = Origin.MISSING
    if random.random() < 0.2:
        origin[:, random.integers(markers)] = Origin.MISSING
    if random.random() < 0.2:
        origin[random.integers(frames)] = Origin.MISSING
    positions[origin == Origin.MISSING] = np.nan
    return make_recording(positions, origin)


@cache
def real_take(name: str) -> Trajectories:
    """A take of the shared data, such as ``animface/jaw``."""
    return quietly(read_c3d, DATA / f"{name}.c3d")


def runs_in(hidden: NDArray[np.bool_]) -> list[tuple[int, int, int]]:
    """Marker, first frame and length of every run, found one sample after the other."""
    runs = []
    for marker in range(hidden.shape[1]):
        frame = 0
        for is_hidden, same in itertools.groupby(hidden[:, marker]):
            length = len(list(same))
            if is_hidden:
                runs.append((marker, frame, length))
            frame += length
    return runs


def quietly(call: Callable[..., T], *inputs: object, **settings: object) -> T:
    """Call what may warn, where its warnings do not matter."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return call(*inputs, **settings)

"""Where gaps may lie, and that they fit where there is room."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from nodegraph_gaps.cut import cut
from nodegraph_gaps.places import free_places
from nodegraph_mocap import Origin, Trajectories
from tests.plugins.recordings import make_recording


def recording(frames: int, markers: int, missing: float = 0.0) -> Trajectories:
    random = np.random.default_rng(frames + markers)
    positions = random.normal(0, 50, (markers, 3)) + random.normal(0, 1, (frames, markers, 3))
    origin = random.choice([1, 1, 1, 2, 3], (frames, markers)).astype(np.uint8)
    origin[random.random((frames, markers)) < missing] = Origin.MISSING
    positions[origin == Origin.MISSING] = np.nan
    return make_recording(positions, origin)


@pytest.mark.parametrize("length", [1, 2, 5])
@pytest.mark.parametrize("at_end", [False, True])
def test_free_places_equal_a_plain_search(length: int, at_end: bool) -> None:
    source = recording(40, 6, missing=0.1)
    free = free_places(source, length, at_end=at_end)
    for start, marker in np.ndindex(*free.shape):
        stop = start + length
        inside = source.measured[start:stop, marker].all()
        before = start > 0 and source.present[start - 1, marker]
        after = stop == 40 if at_end else stop < 40 and source.present[stop, marker]
        assert free[start, marker] == bool(inside and before and after)


def greatest(source: Trajectories, length: int) -> int:
    """How many gaps of one marker fit at most: each as early as it can be."""
    count = 0
    for marker in range(len(source.markers)):
        start = 1
        while start + length < source.frames:
            around = source.present[[start - 1, start + length], marker].all()
            fits = around and source.measured[start : start + length, marker].all()
            count, start = (count + 1, start + length + 1) if fits else (count, start + 1)
    return count


@pytest.mark.parametrize(("length", "missing"), [(1, 0.0), (3, 0.0), (2, 0.1), (4, 0.02)])
def test_single_gaps_fit_to_the_last_one(length: int, missing: float) -> None:
    source = recording(50, 5, missing)
    most = greatest(source, length)
    for count in (most - 1, most):
        for seed in range(5):
            result = cut(source, length=length, count=count, seed=seed)
            assert result.hidden.hidden.sum() == count * length
    with pytest.raises(
        ValueError, match=f"{most + 1} gaps of {length} frames requested, {most} fit"
    ):
        cut(source, length=length, count=most + 1)


@pytest.mark.parametrize("pattern", ["random", "contiguous", "region", "end"])
@pytest.mark.parametrize("seed", [0, 1])
def test_what_is_said_to_fit_does_fit(pattern: Any, seed: int) -> None:
    source = replace(recording(80, 13), origin=np.ones((80, 13), dtype=np.uint8))
    with pytest.raises(ValueError, match="999 gaps") as error:
        cut(source, length=7, count=999, simultaneous=3, pattern=pattern, seed=seed)
    fitting = int(re.findall(r"(\d+) fit", str(error.value))[0])
    assert fitting >= (4 if pattern == "end" else 18)
    result = cut(source, length=7, count=fitting, simultaneous=3, pattern=pattern, seed=seed)
    assert result.hidden.hidden.sum() == fitting * 7 * 3


def test_the_places_do_not_depend_on_the_movement() -> None:
    source = recording(60, 8)
    still = replace(source, positions=np.broadcast_to(source.positions[0], (60, 8, 3)))
    for pattern in ("random", "end"):
        first, second = (cut(take, count=4, length=2, pattern=pattern) for take in (source, still))
        assert np.array_equal(first.hidden.hidden, second.hidden.hidden)


def test_hidden_samples_lose_their_sigma() -> None:
    source = replace(recording(60, 8), sigma=np.ones((60, 8)))
    result = cut(source, count=3, length=2)
    assert result.gappy.sigma is not None
    np.testing.assert_array_equal(np.isnan(result.gappy.sigma), result.hidden.hidden)

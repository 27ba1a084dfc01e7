"""The strategies give what may travel, odd cases among it, and shrink to what is simple."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, find, given, settings
from hypothesis import strategies as st

from nodegraph_mocap import (
    HeadMotion,
    Mask,
    Origin,
    Trajectories,
    testing,
)
from nodegraph_mocap.testing.events import NAMES

QUICK = settings(max_examples=60, deadline=None, derandomize=True)
THOROUGH = settings(
    max_examples=3000,
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=list(HealthCheck),
)
WITHOUT_SHRINKING = settings(THOROUGH, phases=[Phase.generate])


@QUICK
@given(testing.recordings(gaps=False, processed=False, with_marker_set=False))
def test_what_is_not_asked_for_does_not_come(recording: Trajectories) -> None:
    assert np.all(recording.origin == Origin.MEASURED)
    assert (recording.sigma, recording.marker_set) == (None, None)


@QUICK
@given(testing.cuts())
def test_a_cut_hides_present_samples_and_nothing_else(
    cut: tuple[Trajectories, Trajectories, Mask],
) -> None:
    gappy, truth, mask = cut
    assert not np.any(mask.hidden & ~truth.present)
    assert np.array_equal(gappy.present, truth.present & ~mask.hidden)
    assert np.array_equal(gappy.positions[gappy.present], truth.positions[gappy.present])


@QUICK
@given(testing.recordings().flatmap(lambda value: st.tuples(st.just(value), testing.masks(value))))
def test_a_mask_belongs_to_its_recording(both: tuple[Trajectories, Mask]) -> None:
    recording, mask = both
    assert mask.markers == recording.markers
    assert not np.any(mask.hidden & ~recording.present)


@QUICK
@given(testing.head_motions(scaled=False))
def test_head_motions_turn_and_do_not_mirror(motion: HeadMotion) -> None:
    assert np.allclose(np.linalg.det(motion.rotations), 1.0)
    assert np.all(motion.scales == 1.0)


ODD: dict[str, tuple[Callable[[], st.SearchStrategy[object]], Callable[[Any], bool]]] = {
    "one frame": (testing.recordings, lambda value: value.frames == 1),
    "one marker": (testing.recordings, lambda value: len(value.markers) == 1),
    "complete": (testing.recordings, lambda value: value.origin.size > 20 and value.present.all()),
    "a gap at the start": (
        testing.recordings,
        lambda value: value.frames > 3 and not value.present[0, 0] and value.present[1:, 0].any(),
    ),
    "a gap at the end": (
        testing.recordings,
        lambda value: value.frames > 3 and not value.present[-1, 0] and value.present[:-1, 0].any(),
    ),
    "a marker never seen": (
        testing.recordings,
        lambda value: value.present.any() and not value.present.any(axis=0).all(),
    ),
    "a frame without any marker": (
        testing.recordings,
        lambda value: value.present.any() and not value.present.any(axis=1).all(),
    ),
    "all missing": (testing.recordings, lambda value: not value.present.any()),
    "filled": (testing.recordings, lambda value: bool(np.any(value.origin == Origin.FILLED))),
    "repaired": (testing.recordings, lambda value: bool(np.any(value.origin == Origin.REPAIRED))),
    "sigma": (testing.recordings, lambda value: value.sigma is not None),
    "a marker set with pairs": (
        testing.recordings,
        lambda value: value.marker_set is not None and bool(value.marker_set.pairs),
    ),
    "markers out of order": (
        testing.recordings,
        lambda value: len(value.markers) > 3 and value.markers != NAMES[: len(value.markers)],
    ),
    "a sample far off": (
        lambda: testing.recordings(gaps=False),
        lambda value: bool(np.any(np.abs(value.positions) > 200.0)),
    ),
    "a frame without points": (
        testing.detections,
        lambda value: len(value.points) > 0 and bool(np.any(np.diff(value.offsets) == 0)),
    ),
    "no point at all": (testing.detections, lambda value: len(value.points) == 0),
    "weights missing": (testing.weights, lambda value: bool(np.isnan(value.values).any())),
    "a shape that moves nothing": (
        testing.models,
        lambda value: bool(np.any(np.all(value.shapes == 0.0, axis=(1, 2)))),
    ),
    "two shapes alike": (
        testing.models,
        lambda value: len(value.names) == 2 and np.array_equal(value.shapes[0], value.shapes[1]),
    ),
    "a head that turns far": (
        testing.head_motions,
        lambda value: bool(np.any(value.rotations[:, 0, 0] < 0.0)),
    ),
}


@pytest.mark.parametrize("name", ODD)
def test_what_is_odd_comes_too(name: str) -> None:
    strategy, is_odd = ODD[name]
    assert is_odd(find(strategy(), is_odd, settings=WITHOUT_SHRINKING))


def test_an_example_shrinks_to_what_matters() -> None:
    gappy = find(testing.recordings(), lambda value: not value.present.all(), settings=THOROUGH)
    assert gappy.origin.tolist() == [[Origin.MISSING]]
    assert (gappy.marker_set, gappy.sigma) == (None, None)


def test_hypothesis_is_imported_by_those_who_ask() -> None:
    code = "import sys, nodegraph_mocap.testing; assert 'hypothesis' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)

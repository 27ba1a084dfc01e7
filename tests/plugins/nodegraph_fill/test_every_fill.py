"""What every fill does around its method."""

from __future__ import annotations

import inspect
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph import Refusal
from nodegraph.node.decorator import node_of
from nodegraph_fill import nodegraph_nodes
from nodegraph_mocap import Origin
from tests.plugins.recordings import make_gappy, make_recording, quietly

FILLS: dict[str, Any] = {fill.__name__: fill for fill in nodegraph_nodes()}
ALONG_TIME = ("akima", "cubic", "linear", "pattern", "pchip")
COMPLETE = (
    "bilinear",
    "dct",
    "dynammo",
    "gaussian_process",
    "kriging",
    "ppca",
    "soft_impute",
    "subspace_kalman",
)
"""These estimate every sample of a marker that is ever present."""
MODELS = (
    "bilinear",
    "burke_lasenby",
    "dct",
    "dynammo",
    "nearest_frames",
    "pca",
    "ppca",
    "ridge",
    "soft_impute",
)

every = pytest.mark.parametrize("name", FILLS)


def walk(frames: int = 30, markers: int = 7) -> NDArray[np.float64]:
    random = np.random.default_rng(1)
    places = random.normal(0, 10, (markers, 3))
    return np.asarray(places + np.cumsum(random.normal(0, 1, (frames, markers, 3)), axis=0))


@every
def test_what_is_left_is_counted_by_reason(name: str) -> None:
    positions = walk()
    positions[:, 2] = positions[10:15, 3] = positions[20, 4] = np.nan
    message = "^35 samples of 2 markers left missing: never measured 30, longer than max_gap 5$"
    with pytest.warns(UserWarning, match=message) as caught:
        filled = FILLS[name](make_recording(positions), max_gap=4)
    assert np.argwhere(filled.origin == Origin.FILLED).tolist() == [[20, 4]]
    assert caught[0].filename == __file__


@pytest.mark.parametrize("name", ALONG_TIME)
def test_a_gap_with_one_end_is_left_by_fills_that_need_two(name: str) -> None:
    positions = walk()
    positions[:2, 0] = positions[29:, 1] = np.nan
    message = "^3 samples of 2 markers left missing: at the take's start 2, at the take's end 1$"
    with pytest.warns(UserWarning, match=message):
        FILLS[name](make_recording(positions))


@every
@pytest.mark.parametrize("ends", ["as_published", "met"])
def test_measured_samples_keep_their_sigma_and_some_methods_leave_nothing(
    name: str, ends: str
) -> None:
    for seed in (0, 4, 6, 8):  # with and without complete frames, markers and frames never seen
        recording = make_gappy(seed)
        recording = replace(recording, sigma=np.where(recording.present, 0.5, np.nan))
        try:
            filled = quietly(FILLS[name], recording, ends=ends)
        except Refusal:
            continue
        there = recording.present
        assert filled.sigma is not None
        np.testing.assert_array_equal(filled.sigma[there], 0.5)
        if name in COMPLETE:
            seen = there.any(axis=0)
            np.testing.assert_array_equal(filled.present, np.broadcast_to(seen, there.shape))


@pytest.mark.parametrize("name", MODELS)
def test_what_ends_met_adds_is_a_straight_line(name: str) -> None:
    positions = walk(60)
    positions[10:20, 0] = positions[50:, 1] = np.nan
    free, met = (FILLS[name](make_recording(positions), ends=e) for e in ("as_published", "met"))
    shift = met.positions - free.positions
    assert np.abs(shift[10:20, 0]).max() > 1e-3
    np.testing.assert_allclose(np.diff(shift[10:20, 0], n=2, axis=0), 0.0, atol=1e-9)
    # the gap with one end has a mismatch there alone, and it fades to nothing
    rest = np.arange(10, 0, -1)[:, None] / 10
    assert np.abs(shift[50, 1]).max() > 1e-3
    np.testing.assert_allclose(shift[50:, 1], shift[50, 1] * rest, atol=1e-9)


@every
def test_takes_without_anything_to_fill_from(name: str) -> None:
    missing = np.full((4, 3, 3), np.nan)
    alone = np.zeros((4, 1, 3))
    for positions in (missing, missing[:, :1], missing[:1], missing[:0], alone, alone[:, :0]):
        filled = quietly(FILLS[name], make_recording(positions))
        np.testing.assert_array_equal(filled.positions, positions)


@every
def test_a_fill_is_called_and_documented_as_any_function(name: str) -> None:
    fill = FILLS[name]
    settings = list(inspect.signature(fill).parameters)
    assert settings[0] == "recording"
    assert {"ends", "max_gap"} <= set(settings)
    documented = inspect.getdoc(fill) or ""
    assert all(f"\n{setting}\n    " in documented for setting in settings)
    node = node_of(fill)
    assert node is not None
    assert node.doc == documented
    with pytest.raises(TypeError, match="speed"):
        fill(make_recording(walk()), speed=3)
    with pytest.raises(ValueError, match="ends must be as_published or met, got 'both'"):
        fill(make_recording(walk()), ends="both")

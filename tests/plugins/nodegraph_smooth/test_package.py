"""What every smoothing of this package does."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from nodegraph import Refusal
from nodegraph.node.decorator import node_of
from nodegraph_mocap import Trajectories
from nodegraph_smooth import nodegraph_nodes
from tests.plugins.nodegraph_smooth.plain_runs import run_by_run
from tests.plugins.recordings import make_gappy, make_recording, quietly

Positions = NDArray[np.float64]
NODES = {function.__name__: function for function in nodegraph_nodes()}
EVERY = pytest.mark.parametrize("name", NODES)


def defaults(name: str) -> dict[str, Any]:
    definition = node_of(NODES[name])
    assert definition is not None
    return {setting.name: setting.default for setting in definition.settings.values()}


def changed(name: str, factors: Mapping[str, float]) -> dict[str, object]:
    """The defaults, some of them times a factor."""
    return {
        key: factors[key] * value if key in factors else value
        for key, value in defaults(name).items()
    }


@EVERY
@settings(max_examples=15)
@given(seed=st.integers(0, 2**32 - 1))
def test_each_run_is_smoothed_by_itself(name: str, seed: int) -> None:
    recording = make_gappy(seed, most_frames=70, most_markers=5)
    try:
        smoothed = quietly(NODES[name], recording)
    except Refusal:
        return
    np.testing.assert_array_equal(smoothed.origin, recording.origin)
    np.testing.assert_allclose(
        smoothed.positions, run_by_run(NODES[name], recording), rtol=0, atol=1e-9
    )


@EVERY
def test_a_warning_names_the_line_that_called(name: str) -> None:
    with pytest.warns(UserWarning, match="nothing to smooth") as caught:
        NODES[name](make_recording(np.full((20, 2, 3), np.nan)))
    assert {warning.filename for warning in caught} == {__file__}


@EVERY
def test_what_stands_still_stays(name: str) -> None:
    still = np.tile(np.random.default_rng(1).normal(0, 300, (1, 4, 3)), (50, 1, 1))
    np.testing.assert_array_equal(NODES[name](make_recording(still)).positions, still)


@EVERY
def test_sigma_is_a_length(name: str, noisy: Trajectories) -> None:
    scaled = replace(noisy, positions=noisy.positions * 25.4)
    own = changed(name, {"noise": 25.4, "beta": 1 / 25.4})
    first, second = NODES[name](noisy), NODES[name](scaled, **own)
    if first.sigma is not None:
        assert second.sigma is not None
        np.testing.assert_allclose(second.sigma / 25.4, first.sigma, rtol=1e-9)


@EVERY
def test_time_has_no_direction_unless_no_frame_ahead_is_seen(
    name: str, noisy: Trajectories
) -> None:
    smoothed = NODES[name](noisy).positions
    backward = NODES[name](replace(noisy, positions=noisy.positions[::-1])).positions[::-1]
    apart = float(np.abs(smoothed - backward).max())
    summary = (NODES[name].__doc__ or "").partition("\n")[0]
    if "causally" in summary:
        assert apart > 0.1
    else:
        assert apart < 1e-6


@EVERY
def test_noise_is_reduced_and_movement_kept(name: str) -> None:
    random = np.random.default_rng(6)
    time = np.arange(600)[:, None, None] / 60.0
    clean = 10.0 * np.sin(2 * np.pi * 0.8 * time + random.uniform(0, 6, (1, 5, 3)))
    noise = random.normal(0, 0.5, clean.shape)
    smoothed = NODES[name](make_recording(clean + noise)).positions
    error = np.sqrt(np.mean((smoothed - clean) ** 2))
    # one that sees no frame ahead pays for less noise with its lag
    assert error < {"one_euro": 0.75, "kalman_filter": 0.45}.get(name, 0.4)
    bends = [np.abs(np.diff(value, n=2, axis=0)).mean() for value in (smoothed, noise)]
    assert bends[0] < 0.75 * bends[1]


@EVERY
def test_memory_order_precision_and_views_make_no_difference(
    name: str, noisy: Trajectories
) -> None:
    coarse = noisy.positions.astype(np.float32)
    expected = NODES[name](replace(noisy, positions=coarse.astype(np.float64))).positions
    spread = np.zeros((242, 3, 6), dtype=np.float32)
    spread[::2, :, ::2] = coarse
    layouts: tuple[Any, ...] = (coarse, np.asfortranarray(coarse), spread[::2, :, ::2])
    for positions in layouts:
        smoothed = NODES[name](replace(noisy, positions=positions)).positions
        np.testing.assert_array_equal(smoothed, expected)


@EVERY
def test_several_markers_are_smoothed_as_each_alone(name: str, noisy: Trajectories) -> None:
    together = NODES[name](noisy)
    for marker in noisy.markers:
        single = NODES[name](noisy.keep([marker]))
        np.testing.assert_allclose(
            single.positions, together.keep([marker]).positions, rtol=0, atol=1e-9
        )


@EVERY
@pytest.mark.parametrize("frames", [0, 1, 2, 3, 5, 8])
def test_takes_of_any_length_are_smoothed_or_refused(name: str, frames: int) -> None:
    take = make_recording(np.random.default_rng(frames).normal(0, 1, (frames, 2, 3)))
    try:
        smoothed = quietly(NODES[name], take)
    except Refusal as refusal:
        message = str(refusal)
    else:
        message = ""
        assert smoothed.frames == frames
        assert smoothed.present.all()
    assert not message or message.endswith(f"the longest run of present samples has {frames}")

"""What the step-wise fills share."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from nodegraph_fill.guenter import guenter
from nodegraph_fill.lin_ouhyoung import lin_ouhyoung
from nodegraph_fill.linear import linear
from nodegraph_fill.muscle import muscle
from nodegraph_fill.waters import waters
from nodegraph_mocap import Origin, Trajectories
from tests.plugins.recordings import make_gappy, make_recording, quietly

STEPWISE = [guenter, lin_ouhyoung, muscle, waters]
EVERY = [*STEPWISE, linear]
Fill = Callable[..., Trajectories]

CLOSE_GAP = st.sampled_from(["none", "ramp", "blend"])
SEED = st.integers(0, 2**32 - 1)
sweep = settings(deadline=None, max_examples=40, derandomize=True)


@sweep
@given(seed=SEED, fill=st.sampled_from(EVERY))
def test_present_samples_come_out_bit_for_bit(seed: int, fill: Fill) -> None:
    recording = make_gappy(seed)
    before = recording.positions.copy()
    filled = quietly(fill, recording)
    there = recording.present
    assert filled.positions[there].tobytes() == recording.positions[there].tobytes()
    np.testing.assert_array_equal(filled.origin[there], recording.origin[there])
    written = ~there & ~np.isnan(filled.positions[..., 0])
    np.testing.assert_array_equal(filled.origin[~there & ~written], Origin.MISSING)
    np.testing.assert_array_equal(filled.origin[written], Origin.FILLED)
    np.testing.assert_array_equal(recording.positions, before)
    assert (filled.markers, filled.rate) == (recording.markers, recording.rate)


@sweep
@given(seed=SEED, fill=st.sampled_from(STEPWISE), close_gap=CLOSE_GAP)
def test_a_rigid_motion_moves_the_answer_along(seed: int, fill: Fill, close_gap: str) -> None:
    recording = make_gappy(seed)
    turn = Rotation.from_rotvec([0.4, -0.2, 1.1]).as_matrix()
    moved = make_recording(recording.positions @ turn.T + [3, -20, 7], recording.origin)
    expected = quietly(fill, recording, close_gap=close_gap).positions @ turn.T + [3, -20, 7]
    actual = quietly(fill, moved, close_gap=close_gap).positions
    np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-9)


@sweep
@given(seed=SEED, fill=st.sampled_from([guenter, lin_ouhyoung, muscle]), close_gap=CLOSE_GAP)
def test_a_face_of_other_size_is_filled_alike(seed: int, fill: Fill, close_gap: str) -> None:
    recording = make_gappy(seed)
    larger = make_recording(recording.positions * 8, recording.origin)
    expected = quietly(fill, recording, close_gap=close_gap).positions * 8
    actual = quietly(fill, larger, close_gap=close_gap).positions
    np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-8)


@sweep
@given(seed=SEED, fill=st.sampled_from(STEPWISE), close_gap=CLOSE_GAP)
def test_the_order_of_the_markers_does_not_matter(seed: int, fill: Fill, close_gap: str) -> None:
    """Without `use_filled` no marker waits for another, and these distances have no ties."""
    recording = make_gappy(seed)
    shuffled = recording.keep(np.random.default_rng(seed).permutation(recording.markers))
    options = {"close_gap": close_gap, "use_filled": False}
    expected = quietly(fill, recording, **options).keep(shuffled.markers).positions
    actual = quietly(fill, shuffled, **options).positions
    np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-9)


@pytest.mark.parametrize("fill", EVERY)
def test_the_same_answer_twice(fill: Fill) -> None:
    for seed in range(10):
        recording = make_gappy(seed)
        first, second = quietly(fill, recording), quietly(fill, recording)
        assert first.positions.tobytes() == second.positions.tobytes()


@pytest.mark.parametrize("fill", EVERY)
def test_layout_and_precision_of_the_input_do_not_matter(fill: Fill) -> None:
    random = np.random.default_rng(3)
    single = np.cumsum(random.normal(0, 1, (20, 6, 3)), axis=0).astype(np.float32)
    single[5:9, 2] = np.nan
    expected = quietly(fill, make_recording(single.astype(np.float64)))
    for other in (single, np.asfortranarray(single), single[::-1][::-1]):
        assert (
            quietly(fill, make_recording(other)).positions.tobytes() == expected.positions.tobytes()
        )


@pytest.mark.parametrize("fill", STEPWISE)
def test_equally_near_neighbours_are_taken_in_marker_order(fill: Fill) -> None:
    """Six neighbours at one distance, of which one has moved: it counts if it is early enough."""
    places = np.array([[0, 0, 0], [9, 0, 0], [-9, 0, 0], [0, 9, 0], [0, -9, 0], [0, 0, 9]], float)
    settings = {"neighbours": 3} if fill in (guenter, lin_ouhyoung) else {}
    chosen = {guenter: 3, lin_ouhyoung: 3, muscle: 3, waters: 1}[fill]
    for moving in range(1, 6):
        positions = np.stack([places, places])
        positions[1, moving, 2] += 1
        positions[1, 0] = np.nan
        filled = quietly(fill, make_recording(positions), **settings)
        assert (filled.positions[1, 0, 2] > 0.1) == (moving <= chosen)


def test_a_nearer_neighbour_pushes_out_the_last_of_equally_near_ones() -> None:
    places = np.array([[0, 0, 0], [9, 0, 0], [-9, 0, 0], [0, 9, 0], [0, 0, 5]], dtype=float)
    for moving, height in ((1, 1), (2, 1), (3, 0), (4, 1)):
        positions = np.stack([places, places])
        positions[1, moving, 2] += 3
        positions[1, 0] = np.nan
        assert guenter(make_recording(positions)).positions[1, 0, 2] == pytest.approx(height)


def test_filled_neighbours_come_after_measured_ones() -> None:
    places = np.array([[0, 0, 0], [1, 0, 0], [50, 0, 0], [0, 60, 0], [0, 0, 70]], dtype=float)
    positions = np.stack([places, places + np.array([0, 0, 1])])
    positions[1, 1] += [0, 0, 99]
    positions[1, 0] = np.nan
    origin = np.full((2, 5), Origin.MEASURED, dtype=np.uint8)
    origin[1, 0], origin[0, 1] = Origin.MISSING, Origin.FILLED
    recording = make_recording(positions, origin)
    assert guenter(recording).positions[1, 0, 2] == pytest.approx(1)
    assert guenter(recording, neighbours=4).positions[1, 0, 2] == pytest.approx(25.75)
    assert guenter(recording, neighbours=4, use_filled=False).positions[1, 0, 2] == pytest.approx(1)


def test_a_neighbour_must_be_there_before_and_now() -> None:
    places = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [50, 0, 0]], dtype=float)
    positions = np.stack([places, places + np.array([0, 0, 1])])
    positions[1, 3, 2] = 7
    positions[1, 1] = positions[0, 2] = positions[1, 0] = np.nan
    filled = guenter(make_recording(positions), neighbours=1, use_filled=False)
    assert filled.positions[1, 0].tolist() == [0, 0, 7]
    assert filled.positions[1, 1].tolist() == [1, 0, 7]
    assert filled.positions[0, 2].tolist() == [2, 0, -6]


def test_a_broken_chain_stays_missing_until_the_marker_returns() -> None:
    positions = np.zeros((8, 2, 3))
    positions[:, 1, 0] = 5
    positions[1:6, 0] = positions[3, 1] = np.nan
    message = "^4 samples of 2 markers left missing: no usable neighbour 4$"
    with pytest.warns(UserWarning, match=message):
        filled = muscle(make_recording(positions))
    assert filled.present[:, 0].tolist() == [True, True, True, False, False, False, True, True]


def test_a_gap_at_the_start_is_filled_backward() -> None:
    positions = np.zeros((5, 2, 3))
    positions[:, 1] = np.arange(5)[:, None] * [1.0, 0, 0] + [0, 5, 0]
    positions[:3, 0] = np.nan
    filled = muscle(make_recording(positions))
    np.testing.assert_allclose(filled.positions[:, 0, 0], [-3, -2, -1, 0, 0])


def test_reasons_are_counted() -> None:
    positions = np.zeros((10, 3, 3))
    positions[:, 1, 0] = 5
    positions[:, 2] = positions[4:6, :2] = positions[8:, 0] = np.nan
    message = "14 samples of 3 markers left missing: never measured 10, no usable neighbour 4"
    with pytest.warns(UserWarning, match=f"^{message}$") as caught:
        filled = guenter(make_recording(positions))
    assert filled.present[8:, 0].all()
    assert caught[0].filename == __file__


@pytest.mark.parametrize("fill", EVERY)
def test_a_gap_longer_than_max_gap_stays(fill: Fill) -> None:
    random = np.random.default_rng(0)
    positions = np.cumsum(random.normal(0, 1, (20, 5, 3)), axis=0)
    positions[3:6, 0] = positions[10:14, 0] = np.nan
    with pytest.warns(
        UserWarning, match="4 samples of 1 marker left missing: longer than max_gap 4"
    ):
        filled = fill(make_recording(positions), max_gap=3)
    assert np.flatnonzero(~filled.present[:, 0]).tolist() == [10, 11, 12, 13]


@pytest.mark.parametrize("fill", STEPWISE)
def test_a_ramp_meets_the_end_and_a_blend_both_ends(fill: Fill) -> None:
    """All stand still but the marker, which reappears (0, 0, 6) away after 5 frames."""
    positions = np.zeros((8, 4, 3))
    positions[:, 1:] = [[20, 0, 0], [0, 20, 0], [20, 20, 0]]
    positions[6:, 0, 2] = 6
    positions[1:6, 0] = np.nan
    expected = {"none": [0, 0, 0, 0, 0], "ramp": [1, 2, 3, 4, 5], "blend": [1, 2, 3, 4, 5]}
    for close_gap, heights in expected.items():
        filled = fill(make_recording(positions), close_gap=close_gap)
        np.testing.assert_allclose(filled.positions[1:6, 0, 2], heights, rtol=0, atol=1e-12)


def test_an_unknown_way_to_close_a_gap_is_refused() -> None:
    with pytest.raises(ValueError, match="none, ramp or blend, got 'ramps'"):
        muscle(make_recording(np.zeros((2, 2, 3))), close_gap="ramps")  # type: ignore[arg-type]


@pytest.mark.parametrize("fill", EVERY)
def test_takes_without_anything_to_fill_from(fill: Fill) -> None:
    missing = np.full((4, 3, 3), np.nan)
    alone = np.zeros((4, 1, 3))
    for positions in (missing, missing[:, :1], missing[:1], missing[:0], alone, alone[:, :0]):
        filled = quietly(fill, make_recording(positions))
        np.testing.assert_array_equal(filled.positions, positions)
    alone = alone.copy()
    alone[1:3] = np.nan
    broken = pytest.warns(UserWarning, match="^2 samples of 1 marker left missing")
    with nullcontext() if fill is linear else broken:
        fill(make_recording(alone))


@pytest.mark.parametrize("fill", STEPWISE)
def test_two_markers_in_one_place(fill: Fill) -> None:
    positions = np.zeros((6, 5, 3))
    positions[:, 2:] = [[20, 0, 0], [0, 20, 0], [0, 0, 20]]
    positions[2:4, 0] = np.nan
    filled = quietly(fill, make_recording(positions))
    np.testing.assert_array_equal(filled.positions[2:4, 0], 0)


def test_sigma_of_measured_samples_is_kept() -> None:
    positions = np.zeros((3, 2, 3))
    positions[:, 1, 0] = 5
    positions[1, 0] = np.nan
    recording = replace(make_recording(positions), sigma=np.full((3, 2), 0.5))
    sigma = muscle(recording).sigma
    assert sigma is not None
    np.testing.assert_array_equal(sigma, np.where(recording.present, 0.5, np.nan))

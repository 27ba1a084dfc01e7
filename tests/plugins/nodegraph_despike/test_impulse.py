"""The impulse filter against a plain statement, and what it finds and takes for noise."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_despike.impulse import impulse
from nodegraph_mocap import Origin, Trajectories
from tests.plugins.nodegraph_despike.impulses import hit, make_gappy, make_recording
from tests.plugins.recordings import quietly

Point = tuple[float, float, float]
ORDERS = ["simultaneous", "in_place", "redetect"]


def distance(first: Point, second: Point) -> float:
    x, y, z = (a - b for a, b in zip(first, second, strict=True))
    return math.sqrt(x * x + y * y + z * z)


def midpoint(first: Point, second: Point) -> Point:
    x, y, z = ((a + b) / 2.0 for a, b in zip(first, second, strict=True))
    return x, y, z


class Plain:
    """Equations 8 to 10 for one marker, sample by sample."""

    def __init__(self, track: list[Point], factor: float) -> None:
        self.track = list(track)
        steps = [self.step(i) for i in range(1, len(track))]
        known = [value for value in steps if not math.isnan(value)]
        self.k = sum(known) / len(known) if known else 0.0
        self.bar = factor * self.k

    def step(self, i: int) -> float:
        return distance(self.track[i], self.track[i - 1])

    def is_bad(self, i: int) -> bool:
        return self.k > 0 and self.step(i) >= self.bar and self.step(i + 1) >= self.bar

    def bad(self) -> list[int]:
        return [i for i in range(1, len(self.track) - 1) if self.is_bad(i)]

    def middle(self, i: int) -> Point:
        return midpoint(self.track[i - 1], self.track[i + 1])

    def simultaneous(self) -> None:
        for i, place in [(i, self.middle(i)) for i in self.bad()]:
            self.track[i] = place

    def in_place(self) -> None:
        for i in range(1, len(self.track) - 1):
            if self.is_bad(i):
                self.track[i] = self.middle(i)

    def redetect(self) -> None:
        done: set[int] = set()
        while left := [i for i in self.bad() if i not in done]:
            worst = max(left, key=lambda i: (distance(self.track[i], self.middle(i)), -i))
            self.track[worst] = self.middle(worst)
            done.add(worst)


def plainly(recording: Trajectories, order: str, factor: float) -> list[list[Point]]:
    expected = []
    for marker in range(len(recording.markers)):
        track = [(float(x), float(y), float(z)) for x, y, z in recording.positions[:, marker]]
        plain = Plain(track, factor)
        getattr(plain, order)()
        expected.append(plain.track)
    return expected


@given(
    seed=st.integers(0, 10_000), order=st.sampled_from(ORDERS), factor=st.sampled_from([0.5, 1.5])
)
def test_equals_a_plain_statement_to_the_last_bit(seed: int, order: str, factor: float) -> None:
    recording = make_gappy(seed)
    despiked = quietly(impulse, recording, order=order, factor=factor)
    expected = np.array(plainly(recording, order, factor)).transpose(1, 0, 2)
    assert np.array_equal(despiked.positions, expected, equal_nan=True)


def test_the_plain_statement_repairs_something() -> None:
    changed = 0
    for seed in range(20):
        recording = make_gappy(seed)
        despiked = np.array(plainly(recording, "redetect", 1.5)).transpose(1, 0, 2)
        changed += int(
            np.count_nonzero(recording.present & np.any(despiked != recording.positions, axis=2))
        )
    assert changed > 20


@pytest.mark.parametrize(("width", "recall"), [(1, 1.0), (2, 0.0), (3, 0.0)])
@pytest.mark.parametrize("order", ORDERS)
def test_finds_impulses_of_one_frame_and_none_of_two_or_three(
    wavy: Trajectories, width: int, recall: float, order: str
) -> None:
    starts = range(10, 110, 20)
    frames = [start + offset for start in starts for offset in range(width)]
    despiked = quietly(impulse, hit(wavy, frames, [12.0, -9.0, 8.0]), order=order)
    actual = despiked.origin[frames] == Origin.REPAIRED
    assert actual.mean() == recall


@pytest.mark.parametrize(
    ("order", "repaired", "off"),
    [("simultaneous", [10, 11, 12], 30.0), ("in_place", [10, 12], 0.0), ("redetect", [10, 12], 0)],
)
def test_a_good_sample_between_two_impulses(order: str, repaired: list[int], off: float) -> None:
    line = np.arange(60) * 0.1
    line[[10, 12]] += 30.0
    despiked = quietly(impulse, make_recording(line), order=order)
    assert np.flatnonzero(despiked.origin[:, 0] == Origin.REPAIRED).tolist() == repaired
    error = np.linalg.norm(
        despiked.positions - make_recording(np.arange(60) * 0.1).positions, axis=2
    )
    # The good sample becomes the impulse; with the other orders nothing is left of them.
    assert error[11, 0] == pytest.approx(off, abs=1e-9)
    assert np.delete(error[:, 0], 11).max() < (0.1 if off else 1e-9)


@pytest.mark.parametrize("order", ORDERS)
def test_a_marker_that_stands_still_has_nothing_bad(order: str) -> None:
    still = make_recording(np.full(100, 3.7))
    assert impulse(still, order=order) is still


@pytest.mark.parametrize("order", ORDERS)
def test_a_sample_beside_a_gap_is_not_judged(order: str) -> None:
    line = np.arange(40) * 0.1
    line[[0, 10, 20, 39]] += 30.0
    line[[9, 21]] = np.nan
    recording = make_recording(line)
    assert impulse(recording, order=order) is recording


def test_filled_samples_count_and_steps_across_a_gap_do_not() -> None:
    steps = [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, np.nan, np.nan, np.nan, 1.0, 1.0, 1.7, 1.8, 1.0, 1.0]
    line = np.cumsum([0.0, *np.nan_to_num(steps, nan=30.0)])
    line[7:9] = np.nan
    origin = np.full((16, 1), Origin.FILLED, dtype=np.uint8)
    origin[7:9] = Origin.MISSING
    despiked = quietly(impulse, make_recording(line, origin))
    assert 1.5 * np.nanmean(steps) < 1.7 < 1.5 * 30.0
    assert np.flatnonzero(despiked.origin == Origin.REPAIRED).tolist() == [12]


def test_a_bad_sample_that_is_at_its_midpoint_already_is_not_marked() -> None:
    line = np.zeros((20, 1, 3))
    line[8:, 0, 0], line[9:, 0, 0] = 4.0, 8.0
    recording = make_recording(line)
    assert impulse(recording) is recording


@pytest.mark.parametrize(
    ("period", "share"), [(12, 0.0), (15, 0.067), (20, 0.10), (40, 0.15), (60, 0.166), (100, 0.18)]
)
def test_takes_part_of_a_clean_sinusoid_for_noise(period: int, share: float) -> None:
    wave = 10 * np.sin(2 * np.pi * np.arange(6000) / period + 0.3)
    despiked = quietly(impulse, make_recording(wave))
    assert np.mean(despiked.origin == Origin.REPAIRED) == pytest.approx(share, abs=0.003)


def test_of_a_slow_sinusoid_it_takes_what_is_faster_than_the_mean_by_half() -> None:
    wave = 10 * np.sin(2 * np.pi * np.arange(40_000) / 4001.3)
    despiked = quietly(impulse, make_recording(wave))
    # The speed is |cos|, with the mean 2 / pi.
    limit = 1 - 2 / np.pi * np.arcsin(3 / np.pi)
    assert np.mean(despiked.origin == Origin.REPAIRED) == pytest.approx(limit, abs=0.005)


def test_an_order_that_there_is_not(wavy: Trajectories) -> None:
    with pytest.raises(ValueError, match="simultaneous, in_place or redetect, got 'backward'"):
        impulse(wavy, order="backward")

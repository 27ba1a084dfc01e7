from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_files.text.table_recording import (
    positive_number,
    rate_of_times,
    warn_count,
    warn_irregular,
    warn_other_rate,
    warn_skipped,
    whole_steps,
)


@pytest.mark.parametrize("text", ["0", "-1", "nan", "inf", "-inf", "", "fast", "1_0", "59,94"])
def test_what_is_no_positive_number(text: str) -> None:
    assert positive_number(text) is None


def test_a_positive_number() -> None:
    assert positive_number("59.94") == 59.94


@pytest.mark.parametrize("rate", [23.976, 25, 29.97, 30, 59.94, 60, 100, 119.88, 120, 240, 1000])
@pytest.mark.parametrize("digits", [4, 6, 17])
def test_the_rate_does_not_suffer_from_few_digits(rate: float, digits: int) -> None:
    times = np.round(5 + np.arange(2000) / rate, digits)
    assert rate_of_times(times) == rate


def test_the_rate_of_times_in_whole_milliseconds() -> None:
    # The median step, 17 ms, would be 58.8 Hz.
    assert rate_of_times(np.round(np.arange(100) / 60, 3)) == 60


@given(st.floats(0.5, 2000), st.integers(2, 400))
def test_the_rate_of_exact_times(rate: float, frames: int) -> None:
    assert rate_of_times(np.arange(frames) / rate) == pytest.approx(rate, rel=1e-7)


def test_dropped_frames_do_not_change_the_rate() -> None:
    times = np.delete(np.arange(100) / 60, [3, 4, 50])
    assert rate_of_times(times) == 60


@pytest.mark.parametrize("times", [[], [1.0], [1.0, 1.0], [2.0, 1.0], [0.0, np.nan]])
def test_times_that_tell_no_rate(times: list[float]) -> None:
    assert rate_of_times(np.array(times)) is None


def test_where_steps_are_irregular_the_median_one_tells_the_rate() -> None:
    assert rate_of_times(np.array([0, 1, 2, 3.5, 4.5])) == 1


@pytest.mark.parametrize(
    ("values", "steps"), [([2.0, 4, 6, 10.1, 12], [1, 1, 2, 1]), ([1.0, 2, 4], [1, 2])]
)
def test_steps_are_whole_numbers_of_the_usual_one(values: list[float], steps: list[int]) -> None:
    result = whole_steps(np.array(values))
    assert result is not None
    assert result.tolist() == steps


def test_steps_that_are_no_whole_numbers() -> None:
    assert whole_steps(np.array([0, 1, 2, 3.5])) is None
    assert whole_steps(np.array([0.0, 1, 2, 2])) is None
    assert whole_steps(np.array([0.0])) is None


@pytest.mark.filterwarnings("error")
def test_nothing_is_reported_of_even_frames() -> None:
    numbers = np.arange(50.0)
    warn_irregular("time", numbers)
    warn_irregular("time", numbers[:1])
    warn_skipped("Frame#", numbers)
    warn_other_rate(np.round(numbers / 60, 2), 60, "rate")
    warn_other_rate(np.delete(numbers, [3, 4, 5, 20]) / 60, 60, "rate")
    warn_count("frames", "50", 50)
    warn_count("frames", "50.0", 50)


def test_what_contradicts_is_reported() -> None:
    with pytest.warns(UserWarning, match="2 of 4 steps of the column 'time' are irregular"):
        warn_irregular("time", np.array([0.0, 1, 2, 5, 5]))
    with pytest.warns(UserWarning, match="1 of 2 steps of Frame# are not 1"):
        warn_skipped("Frame#", np.array([0.0, 1, 3]))
    with pytest.warns(UserWarning, match=r"lasts 1 s, by rate 0\.5 s; rate counts"):
        warn_other_rate(np.arange(61) / 60, 120, "rate")
    with pytest.warns(UserWarning, match="says many frames, the file holds 3"):
        warn_count("frames", "many", 3)

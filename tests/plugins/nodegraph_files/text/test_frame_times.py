from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_files.text.table_recording import (
    rate_of_times,
    warn_count,
    warn_irregular,
    warn_other_rate,
    warn_skipped,
)


@pytest.mark.parametrize("rate", [23.976, 25, 29.97, 30, 59.94, 60, 100, 119.88, 120, 240, 1000])
@pytest.mark.parametrize("digits", [4, 6, 17])
def test_the_rate_does_not_suffer_from_few_digits(rate: float, digits: int) -> None:
    times = np.round(5 + np.arange(2000) / rate, digits)
    assert rate_of_times(times) == rate


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

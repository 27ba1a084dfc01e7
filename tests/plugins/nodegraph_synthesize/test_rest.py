from __future__ import annotations

import numpy as np
import pytest

from nodegraph_synthesize.smooth_noise import awake, rest_of


@pytest.mark.parametrize(
    ("frames", "rate", "rest"),
    [(600, 60.0, 0.3), (180, 60.0, 0.3), (60, 60.0, 0.1), (2, 60.0, 1 / 300)],
)
def test_a_take_rests_for_0_3_seconds_or_a_tenth(frames: int, rate: float, rest: float) -> None:
    assert rest_of(frames, rate) == pytest.approx(rest)
    level = awake(frames, rate)
    seconds = np.arange(frames) / rate
    np.testing.assert_array_equal(level[seconds < 0.999 * rest], 0.0)
    np.testing.assert_array_equal(level[seconds > 3.001 * rest], 1.0)
    assert (np.diff(level) >= 0.0).all()
    assert level[0] == 0.0
    assert level[-1] == 1.0

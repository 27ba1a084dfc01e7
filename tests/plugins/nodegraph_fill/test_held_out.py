"""Standard deviations scaled by the errors in gaps whose content is known."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_fill.gaps import Gaps
from nodegraph_fill.whole_take import Estimate, whole_take
from nodegraph_mocap import Trajectories
from tests.plugins.recordings import make_recording

FRAMES, MARKERS = 200, 60
LENGTHS = (3, 12)
OFF = np.random.default_rng(2).normal(size=(FRAMES, MARKERS, 3))
OFF[: FRAMES // 2] = 0.0
"""What the model is wrong by: nothing in the gaps, much half a take later."""
Positions = NDArray[np.float64]


def gappy(markers: int = MARKERS) -> Positions:
    """Markers at the origin, each with a gap: three frames, or twelve of every second one."""
    positions = np.zeros((FRAMES, markers, 3))
    for marker in range(markers):
        positions[4 + marker :][: LENGTHS[marker % 2], marker] = np.nan
    return positions


def sigma_of(recording: Trajectories, own: float) -> Positions:
    @whole_take("fill.wrong", cite="none")
    def wrong(recording: Trajectories, gaps: Gaps) -> Estimate:
        """Fill with what is wrong by a known amount."""
        return Estimate(OFF[:, : gaps.shape[1]], np.full(gaps.shape, own))

    sigma = wrong(recording).sigma
    assert sigma is not None
    return sigma


def reach(markers: range) -> float:
    """Return the 95 % quantile of the errors half a take after the gaps of some markers."""
    errors = [OFF[104 + m :][: LENGTHS[m % 2], m] for m in markers]
    return float(np.quantile(np.abs(np.concatenate(errors)), 0.95))


@pytest.mark.parametrize("own", [0.1, 5.0])
def test_95_in_100_errors_half_a_take_later_are_within(own: float) -> None:
    sigma = sigma_of(make_recording(gappy()), own)
    for marker in (0, 1, 58, 59):
        gap = sigma[4 + marker :][: LENGTHS[marker % 2], marker]
        expected = reach(range(marker % 2, MARKERS, 2))
        np.testing.assert_allclose(1.96 * gap, expected, rtol=1e-4)
    assert np.count_nonzero(~np.isnan(sigma)) == 30 * 3 + 30 * 12


def test_a_gap_is_held_out_where_the_marker_is_present_around_it() -> None:
    positions = gappy(40)
    positions[103, 0] = np.nan
    sigma = sigma_of(make_recording(positions), 1.0)
    # 19 of its length are too few: all of the next length count, too
    expected = reach(range(1, 40))
    np.testing.assert_allclose(1.96 * sigma[4, 0], expected, rtol=1e-4)


def test_of_fewer_than_ten_held_out_gaps_nothing_is_concluded() -> None:
    assert np.isnan(sigma_of(make_recording(gappy(9)), 1.0)).all()
    assert not np.isnan(sigma_of(make_recording(gappy(10)), 1.0)).all()

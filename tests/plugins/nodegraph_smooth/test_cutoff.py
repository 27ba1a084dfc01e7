"""Cut-offs and windows that cannot be are named."""

from __future__ import annotations

import math

import pytest

from nodegraph import Refusal
from nodegraph_smooth.cutoff import STIFFEST, angle, check_stiffness, frames_of


def test_angle_and_frames() -> None:
    assert angle(10.0, 60.0) == pytest.approx(math.pi / 3)
    assert frames_of(0.15, 60.0) == pytest.approx(9.0)


@pytest.mark.parametrize("cutoff", [30.0, 31.0, math.inf])
def test_a_cut_off_above_half_the_rate_is_refused(cutoff: float) -> None:
    with pytest.raises(Refusal, match="is not below 30 Hz, half the frame rate"):
        angle(cutoff, 60.0)


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan])
def test_what_is_not_positive_is_an_error(value: float) -> None:
    with pytest.raises(ValueError, match="must be a positive number of Hz"):
        angle(value, 60.0)
    with pytest.raises(ValueError, match="must be a positive number of s"):
        frames_of(value, 60.0)


def test_a_cut_off_that_cannot_be_computed_is_refused() -> None:
    check_stiffness(STIFFEST, 0.1, 60.0)
    with pytest.raises(Refusal, match=r"cut-off 0\.01 Hz is too low at 60 Hz to be computed"):
        check_stiffness(2 * STIFFEST, 0.01, 60.0)

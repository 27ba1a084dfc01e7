"""A line of a lock and what it says."""

from __future__ import annotations

import numpy as np
import pytest

from nodegraph.lock.results import Recorded


@pytest.mark.parametrize(
    "recorded",
    [
        Recorded(),
        Recorded("refused: a gap of 5 frames - too long"),
        Recorded("failed"),
        Recorded("", "0123456789", "01234567"),
        Recorded("", "", "", None, "abcdef0123"),
        Recorded("", "0123456789", "01234567", None, "abcdef0123"),
    ],
)
def test_a_line_says_all_of_a_result(recorded: Recorded) -> None:
    assert Recorded.read(recorded.text) == recorded


def test_numbers_are_part_of_the_line() -> None:
    recorded = Recorded("", "0123456789", "01234567", np.array([0.0, -1.0, 1e-9, 2.5]))
    found = Recorded.read(recorded.text)
    assert found.projections is not None
    assert np.allclose(found.projections, [0.0, -1.0, 1e-9, 2.5], rtol=1e-10)
    assert len(recorded.text) == 52


def test_a_line_that_says_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match=r"\w"):
        Recorded.read("0123456789 01234567 not-a-word")

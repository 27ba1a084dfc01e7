"""Results as lines of text."""

from __future__ import annotations

import numpy as np
import pytest

from nodegraph.lock.recorded import Recorded


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
def test_a_line_reads_back(recorded: Recorded) -> None:
    assert Recorded.read(recorded.text) == recorded


def test_projections_are_part_of_the_line() -> None:
    recorded = Recorded("", "0123456789", "01234567", np.array([0.0, -1.0, 1e-9, 2.5]))
    read = Recorded.read(recorded.text)
    assert read.projections is not None
    assert np.allclose(read.projections, [0.0, -1.0, 1e-9, 2.5], rtol=1e-10)
    assert len(recorded.text) == 52


def test_a_line_of_another_form_raises_an_error() -> None:
    with pytest.raises(ValueError, match=r"\w"):
        Recorded.read("0123456789 01234567 not-a-word")

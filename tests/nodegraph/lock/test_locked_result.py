"""Results as lines of text."""

from __future__ import annotations

import numpy as np
import pytest

from nodegraph.lock.locked_result import LockedResult


@pytest.mark.parametrize(
    "recorded",
    [
        LockedResult(),
        LockedResult("refused: a gap of 5 frames - too long"),
        LockedResult("failed"),
        LockedResult("", "0123456789", "01234567"),
        LockedResult("", "", "", None, "abcdef0123"),
        LockedResult("", "0123456789", "01234567", None, "abcdef0123"),
    ],
)
def test_a_line_reads_back(recorded: LockedResult) -> None:
    assert LockedResult.read(recorded.text) == recorded


def test_projections_are_part_of_the_line() -> None:
    recorded = LockedResult("", "0123456789", "01234567", np.array([0.0, -1.0, 1e-9, 2.5]))
    read = LockedResult.read(recorded.text)
    assert read.projections is not None
    assert np.allclose(read.projections, [0.0, -1.0, 1e-9, 2.5], rtol=1e-10)
    assert len(recorded.text) == 52


def test_a_line_of_another_form_raises_an_error() -> None:
    with pytest.raises(ValueError, match=r"\w"):
        LockedResult.read("0123456789 01234567 not-a-word")

"""The verdict follows from what moved, why, and what is concluded."""

from __future__ import annotations

import pytest

from nodegraph.lock.compare import Change, Compared, Grade, Moved, verdict
from nodegraph.lock.results import Cell

CELL = Cell("fill=hold", "only", "fill", {"fill": "hold"}, 0)
EDITED = Moved(CELL, Grade("moved", 0.1), Change(own=("code: a was edited",)))
DRIFTED = Moved(CELL, Grade("moved", 1e-6), Change(around=("numpy was 1, now 2",)))


@pytest.mark.parametrize(
    ("found", "conclusions", "changed", "expected"),
    [
        (Compared(identical=3), True, [], "identical"),
        (Compared(identical=3), True, ["a tie"], "identical, but conclusions changed"),
        (Compared(identical=3, near=1), True, [], "within tolerance"),
        (Compared(identical=3, near=1), False, [], "within tolerance"),
        (
            Compared(identical=3, near=1),
            True,
            ["a tie"],
            "within tolerance, but conclusions changed",
        ),
        (Compared([DRIFTED], identical=3), True, [], "same conclusions"),
        (Compared([DRIFTED], identical=3), True, ["b < a"], "diverged"),
        (Compared([DRIFTED], identical=3), False, [], "diverged"),
        (Compared([EDITED], identical=3), True, [], "diverged"),
        (Compared([DRIFTED, EDITED]), True, [], "diverged"),
        (Compared(identical=3, only_now=["fill"]), True, [], "diverged"),
        (Compared(identical=3, only_locked=["fill"]), True, [], "diverged"),
    ],
)
def test_a_verdict(found: Compared, conclusions: bool, changed: list[str], expected: str) -> None:
    came_to = verdict(found, conclusions, changed)
    assert came_to.text == expected
    assert came_to.holds == (expected in ("identical", "within tolerance", "same conclusions"))

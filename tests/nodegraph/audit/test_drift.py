"""How far the results of two calls are apart."""

from __future__ import annotations

import numpy as np
import pytest

from nodegraph.audit.drift import CallResult, drift
from nodegraph.plugin.hook_results import HookResults
from nodegraph.plugin.kind import Kind
from nodegraph.store import Packer

NO_HOOKS = HookResults([])
X = np.linspace(1, 2, 30)


@pytest.mark.parametrize(
    ("first", "second", "floor", "grade"),
    [
        (X, X.copy(), 0.0, "identical"),
        (X, np.asfortranarray(X + 0.0), 0.0, "identical"),
        (X, X * (1 + 1e-14), 0.0, "close"),
        (X, X * (1 + 1e-6), 0.0, "differs"),
        (X * 1e-18, X * 2e-18, 0.0, "differs"),
        (X * 1e-18, X * 2e-18, 1e-3, "close"),
        (np.array([0.0, 1.0]), np.array([-0.0, 1.0]), 0.0, "close"),
        (np.array([np.nan, 1.0]), np.array([1.0, 1.0]), 0.0, "differs"),
        (3, 4, 0.0, "differs"),
        (X.reshape(5, 6), X.reshape(6, 5), 0.0, "differs"),
    ],
)
def test_numbers_are_close_relative_to_their_size(
    first: object, second: object, floor: float, grade: str
) -> None:
    was, now = (CallResult.of((value,), Packer()) for value in (first, second))
    assert drift(was, now, ["x"], NO_HOOKS, floor).grade == grade


def test_a_drawing_is_drawn_once_and_compared_often() -> None:
    drawn: list[int] = []

    class Drawing:
        """Differs each time that it is drawn, as a figure that computes its own layout."""

        def __init__(self) -> None:
            self.count = 0

    def draw(value: Drawing) -> int:
        value.count += 1
        drawn.append(value.count)
        return value.count

    packer = Packer([Kind(Drawing, take_apart=draw, put_together=int, faithful=False)])
    first, second = (CallResult.of((Drawing(),), packer) for _ in range(2))
    assert [drift(first, other, ["x"], NO_HOOKS).grade for other in (first, second)] == [
        "identical"
    ] * 2
    assert drawn == [1, 1]

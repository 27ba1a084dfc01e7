"""Values are told apart in every part, and the place of the first difference is named."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from nodegraph import Value
from nodegraph.equality import difference, same
from nodegraph_mocap import Figure


@dataclass(frozen=True)
class Size(Value):
    length: float


def test_same_looks_into_what_values_are_made_of() -> None:
    from matplotlib.figure import Figure as Drawn
    from pandas import DataFrame

    def figure(height: float) -> Figure:
        drawn = Drawn(figsize=(1, 1))
        drawn.add_subplot().plot([0, height])
        return drawn

    nan = float("nan")
    assert same({"a": [nan, (1, "x")]}, {"a": [nan, (1, "x")]})
    assert same(np.array([1.0, nan]), np.array([1.0, nan]))
    assert same(np.array([None, "x"]), np.array([None, "x"]))
    assert same(DataFrame({"a": [1.0, nan]}), DataFrame({"a": [1.0, nan]}))
    assert same(figure(1.0), figure(1.0))
    assert same(Size(nan), Size(nan))
    assert not same(figure(1.0), figure(2.0))
    assert not same(1, 1.0)
    assert not same(np.zeros(2), np.zeros(2, np.float32))
    assert not same(np.zeros(2), np.zeros((2, 1)))


@pytest.mark.parametrize(
    ("first", "second", "text"),
    [
        (np.array([[1.0, 2.0]]), np.array([[1.0, 3.0]]), "value[0, 1]: 2.0 and 3.0"),
        ({"rate": 60}, {"rate": 30}, "value['rate']: 60 and 30"),
        ({"rate": 60}, {}, "only one of them has value['rate']"),
        ([1, 2], [1], "only one of them has value[1]"),
        (Size(1.0), Size(2.0), "value.length: 1.0 and 2.0"),
        (1, "1", "value: int and str"),
        (np.float64("nan"), np.float64(1.0), "value: np.float64(nan) and np.float64(1.0)"),
    ],
)
def test_a_difference_has_its_place(first: object, second: object, text: str) -> None:
    assert difference(first, second) == text

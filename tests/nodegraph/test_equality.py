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


def figure(height: float) -> Figure:
    from matplotlib.figure import Figure as Drawn

    drawn = Drawn(figsize=(1, 1))
    drawn.add_subplot().plot([0, height])
    return drawn


def test_same_looks_into_what_values_are_made_of() -> None:
    from pandas import DataFrame

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


def test_figures_are_the_same_that_look_the_same_whatever_they_are_made_of() -> None:
    first, second, third = figure(1.0), figure(1.0), figure(2.0)
    first.axes[0].set_gid("first")
    assert same(first, second)
    for each in (first, second, third):
        each.axes[0].xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    assert same(first, second)
    assert not same(first, third)
    second.axes[0].xaxis.set_major_formatter(lambda value, _: f"{2 * value:g}")
    assert not same(first, second)


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

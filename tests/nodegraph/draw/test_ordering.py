from __future__ import annotations

from itertools import combinations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import isotonic_regression

from nodegraph.draw.layers import Net, Segment
from nodegraph.draw.ordering import crossings, order_layers, spread


@given(st.integers(1, 12), st.data())
def test_spread_is_the_least_squares_solution(count: int, data: st.DataObject) -> None:
    numbers = st.floats(-50, 50)
    wished = np.array(data.draw(st.lists(numbers, min_size=count, max_size=count)))
    weights = data.draw(st.lists(st.floats(0.1, 9), min_size=count, max_size=count))
    apart = data.draw(st.lists(st.floats(0.1, 30), min_size=count - 1, max_size=count - 1))
    starts = np.concatenate([[0.0], np.cumsum(apart)])
    expected = isotonic_regression(wished - starts, weights=weights).x + starts
    places = spread(wished.tolist(), weights, apart)
    np.testing.assert_allclose(places, expected, atol=1e-9)
    assert all(np.diff(places) >= np.array(apart) - 1e-9)


@given(st.lists(st.tuples(st.integers(0, 5), st.integers(6, 11)), max_size=20, unique=True))
def test_crossings_are_counted_and_never_added(pairs: list[tuple[int, int]]) -> None:
    layers = [list(range(6)), list(range(6, 12))]
    net = Net(layers, [10.0] * 12, [[Segment(a, b) for a, b in pairs], []])
    by_hand = sum((a - c) * (b - d) < 0 for (a, b), (c, d) in combinations(pairs, 2))
    assert crossings(net, layers) == by_hand
    assert crossings(net, order_layers(net)) <= by_hand
    assert [sorted(layer) for layer in order_layers(net)] == layers


def test_what_need_not_cross_does_not() -> None:
    segments = [Segment(0, 5), Segment(1, 4), Segment(2, 3)]
    net = Net([[0, 1, 2], [3, 4, 5]], [10.0] * 6, [segments, []])
    assert crossings(net, net.layers) == 3
    assert crossings(net, order_layers(net)) == 0

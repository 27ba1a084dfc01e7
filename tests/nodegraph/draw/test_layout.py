from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import isotonic_regression

from nodegraph.draw.net import Net, Segment, depths_of
from nodegraph.draw.order import crossings, ordered
from nodegraph.draw.picture import Arrow
from nodegraph.draw.place import spread
from nodegraph.draw.text import clean, rows, shortened, width


def arrow(source: str, target: str) -> Arrow:
    return Arrow(source, "x", target, "x")


def test_a_box_stands_below_all_that_feeds_it() -> None:
    arrows = [arrow("a", "b"), arrow("b", "c"), arrow("a", "c")]
    assert depths_of(["c", "b", "a"], arrows) == {"a": 0, "b": 1, "c": 2}


def test_a_source_that_is_needed_late_stands_near_its_reader() -> None:
    arrows = [arrow("a", "b"), arrow("b", "c"), arrow("model", "c")]
    assert depths_of(["a", "b", "c", "model"], arrows)["model"] == 1


@settings(deadline=None)
@given(st.integers(1, 12), st.data())
def test_spread_is_the_least_squares_solution(count: int, data: st.DataObject) -> None:
    numbers = st.floats(-50, 50)
    wished = np.array(data.draw(st.lists(numbers, min_size=count, max_size=count)))
    weights = data.draw(st.lists(st.floats(0.1, 9), min_size=count, max_size=count))
    apart = data.draw(st.lists(st.floats(0.1, 30), min_size=count - 1, max_size=count - 1))
    starts = np.concatenate([[0.0], np.cumsum(apart)])
    expected = isotonic_regression(wished - starts, weights=weights).x + starts
    found = spread(wished.tolist(), weights, apart)
    np.testing.assert_allclose(found, expected, atol=1e-9)
    assert all(np.diff(found) >= np.array(apart) - 1e-9)


@settings(deadline=None)
@given(st.lists(st.tuples(st.integers(0, 5), st.integers(6, 11)), max_size=20, unique=True))
def test_crossings_are_counted_and_never_added(pairs: list[tuple[int, int]]) -> None:
    layers = [list(range(6)), list(range(6, 12))]
    net = Net(layers, [10.0] * 12, [[Segment(a, b) for a, b in pairs], []])
    by_hand = sum((a - c) * (b - d) < 0 for (a, b), (c, d) in combinations(pairs, 2))
    assert crossings(net, layers) == by_hand
    assert crossings(net, ordered(net)) <= by_hand
    assert [sorted(layer) for layer in ordered(net)] == layers


def test_what_need_not_cross_does_not() -> None:
    segments = [Segment(0, 5), Segment(1, 4), Segment(2, 3)]
    net = Net([[0, 1, 2], [3, 4, 5]], [10.0] * 6, [segments, []])
    assert crossings(net, net.layers) == 3
    assert crossings(net, ordered(net)) == 0


def test_texts_that_xml_cannot_hold_are_marked() -> None:
    assert clean("a\x00b\n c\ud800") == "a\ufffdb c\ufffd"


def test_long_texts_are_shortened() -> None:
    assert shortened("x" * 50, 10) == "x" * 9 + "…"
    assert shortened("x" * 10, 10) == "x" * 10


def test_widths_grow_with_text_and_type() -> None:
    assert width("iii", 10) < width("mmm", 10) == pytest.approx(27.6)
    assert width("abc", 10, bold=True) > width("abc", 10)
    assert width("日本", 10) == pytest.approx(21)
    assert width("il", 10, monospace=True) == pytest.approx(12.2)


def test_pieces_flow_into_rows() -> None:
    assert rows([40, 40, 40, 200, 10], limit=100, gap=5) == [[0, 1], [2], [3], [4]]
    assert rows([], limit=100, gap=5) == []

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import isotonic_regression

from nodegraph.draw.arrange import crossings, ordered, spread
from nodegraph.draw.layers import Net, Segment, depths_of, lanes
from nodegraph.draw.shape import clean, rows, shortened, width


def test_a_box_stands_below_all_that_feeds_it() -> None:
    a, b, c = 2, 1, 0
    assert depths_of(3, [(a, b), (b, c), (a, c)]) == [2, 1, 0]


def test_a_source_that_is_needed_late_stands_near_its_reader() -> None:
    a, b, c, model = range(4)
    assert depths_of(4, [(a, b), (b, c), (model, c)])[model] == 1


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


@settings(deadline=None)
@given(st.lists(st.tuples(st.integers(0, 9), st.integers(10, 19)), max_size=30, unique=True))
def test_segments_in_one_lane_stand_apart_unless_they_belong_together(
    pairs: list[tuple[int, int]],
) -> None:
    middles = [60.0 * (cell % 10) for cell in range(20)]
    segments = [Segment(upper, lower) for upper, lower in pairs]
    found = lanes(segments, middles)
    assert set(found) == {one for one in segments if middles[one.upper] != middles[one.lower]}
    for one, other in combinations(found, 2):
        places = sorted((middles[one.upper], middles[one.lower]))
        others = sorted((middles[other.upper], middles[other.lower]))
        together = one.upper == other.upper or one.lower == other.lower
        apart = places[1] < others[0] or others[1] < places[0]
        assert together or apart or found[one] != found[other]


def test_a_wire_that_comes_down_where_another_goes_down_turns_first() -> None:
    middles = [0.0, 100.0, 200.0, 100.0, 0.0]
    ends, begins = Segment(0, 3), Segment(1, 4)
    found = lanes([ends, begins], middles)
    assert found[begins] < found[ends]
    found = lanes([Segment(2, 3), Segment(1, 4)], middles)
    assert found[Segment(1, 4)] < found[Segment(2, 3)]

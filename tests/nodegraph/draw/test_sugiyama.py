from __future__ import annotations

from itertools import combinations

from hypothesis import given
from hypothesis import strategies as st

from nodegraph.draw.layers import Segment
from nodegraph.draw.sugiyama import lanes


@given(st.lists(st.tuples(st.integers(0, 9), st.integers(10, 19)), max_size=30, unique=True))
def test_segments_in_one_lane_stand_apart_unless_they_belong_together(
    pairs: list[tuple[int, int]],
) -> None:
    middles = [60.0 * (cell % 10) for cell in range(20)]
    segments = [Segment(upper, lower) for upper, lower in pairs]
    lane_of = lanes(segments, middles)
    assert set(lane_of) == {
        segment for segment in segments if middles[segment.upper] != middles[segment.lower]
    }
    for segment, other in combinations(lane_of, 2):
        places = sorted((middles[segment.upper], middles[segment.lower]))
        other_places = sorted((middles[other.upper], middles[other.lower]))
        together = segment.upper == other.upper or segment.lower == other.lower
        apart = places[1] < other_places[0] or other_places[1] < places[0]
        assert together or apart or lane_of[segment] != lane_of[other]


def test_a_wire_that_comes_down_where_another_goes_down_turns_first() -> None:
    middles = [0.0, 100.0, 200.0, 100.0, 0.0]
    ends, begins = Segment(0, 3), Segment(1, 4)
    lane_of = lanes([ends, begins], middles)
    assert lane_of[begins] < lane_of[ends]
    lane_of = lanes([Segment(2, 3), Segment(1, 4)], middles)
    assert lane_of[Segment(1, 4)] < lane_of[Segment(2, 3)]

"""Which markers one event may hide together."""

from __future__ import annotations

import numpy as np

from nodegraph_gaps.groups import AnyMarkers, contiguous, region

LINE = np.array([[0, 0, 0], [1, 0, 0], [2.5, 0, 0], [np.nan] * 3, [7, 0, 0]])


def test_contiguous_groups_are_a_marker_and_those_nearest() -> None:
    assert contiguous(LINE, 2).members.tolist() == [[0, 1], [1, 0], [2, 1], [4, 2]]
    assert contiguous(LINE, 1).members.tolist() == [[0], [1], [2], [4]]
    assert contiguous(LINE, 5).members.shape == (0, 5)


def test_a_marker_is_in_its_own_group_even_where_others_lie_in_its_place() -> None:
    groups = contiguous(np.zeros((4, 3)), 2).members
    assert groups[:, 0].tolist() == [0, 1, 2, 3]
    assert (groups[:, 0] != groups[:, 1]).all()


def test_regions_lie_on_one_side_as_long_as_it_has_enough() -> None:
    members = region(LINE, 2, np.random.default_rng(0)).members
    sides = {tuple(group) for group in members.tolist()}
    assert sides == {(0, 1), (1, 0), (1, 2), (2, 1), (2, 4), (4, 2)}


def test_a_draw_takes_only_what_is_free() -> None:
    random = np.random.default_rng(1)
    free = np.zeros((9, 5), dtype=np.bool_)
    assert AnyMarkers(2).draw(free, random) is None
    assert contiguous(LINE, 2).draw(free, random) is None
    free[3, [0, 4]] = free[5, 1] = True
    start, markers = AnyMarkers(2).draw(free, random) or (0, np.zeros(0))
    assert (start, sorted(markers)) == (3, [0, 4])
    assert contiguous(LINE, 2).draw(free, random) is None
    free[5, 0] = True
    start, markers = contiguous(LINE, 2).draw(free, random) or (0, np.zeros(0))
    assert (start, sorted(markers)) == (5, [0, 1])

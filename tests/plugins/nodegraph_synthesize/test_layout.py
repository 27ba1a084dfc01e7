from __future__ import annotations

import numpy as np
import pytest

from nodegraph_synthesize.layout import FEWEST, MOST, MarkerLayout, edges_between, make_layout
from nodegraph_synthesize.proportions import Proportions
from nodegraph_synthesize.surface import make_surface

_SURFACE = make_surface(Proportions())


def _layout(count: int) -> MarkerLayout:
    return make_layout(count, _SURFACE.places)


@pytest.mark.parametrize("count", [*range(FEWEST, MOST, 9), MOST])
def test_any_number_of_markers_is_symmetric(count: int) -> None:
    layout = _layout(count)
    markers = layout.marker_set.markers
    assert len(markers) == len(set(layout.vertices.tolist())) == count
    position = dict(zip(markers, _SURFACE.vertices[layout.vertices], strict=True))
    for left, right in layout.marker_set.pairs:
        assert left == f"L{right[1:]}"
        assert position[left][0] > 0
        np.testing.assert_array_equal(position[right], position[left] * [-1.0, 1.0, 1.0])
    assert all(position[name][0] == 0.0 for name in layout.marker_set.midline)
    paired = {name for pair in layout.marker_set.pairs for name in pair}
    assert paired.isdisjoint(layout.marker_set.midline)
    assert paired.union(layout.marker_set.midline) == set(markers)


@pytest.mark.parametrize("count", [10, 11, 60, 150])
def test_stable_markers_fix_the_head(count: int) -> None:
    layout = _layout(count)
    positions = dict(
        zip(layout.marker_set.markers, _SURFACE.vertices[layout.vertices], strict=True)
    )
    stable = np.array([positions[name] for name in layout.marker_set.stable])
    assert len(stable) >= 3
    spread = np.linalg.svd(stable - stable.mean(axis=0), compute_uv=False)
    assert spread[1] > 10.0


def test_fewer_markers_keep_their_names_and_more_come_on_top() -> None:
    usual = _layout(60)
    where = dict(zip(usual.marker_set.markers, usual.vertices.tolist(), strict=True))
    for count in (10, 37, 59):
        fewer = _layout(count)
        for name, vertex in zip(fewer.marker_set.markers, fewer.vertices.tolist(), strict=True):
            assert where[name] == vertex
    for count in (61, 90, 150):
        more = _layout(count)
        there = dict(zip(more.marker_set.markers, more.vertices.tolist(), strict=True))
        assert where.items() <= there.items()


@pytest.mark.parametrize("count", [FEWEST - 1, MOST + 1, 0, -5])
def test_other_numbers_are_refused(count: int) -> None:
    with pytest.raises(ValueError, match=f"10 to 150 of them here, got {count}"):
        _layout(count)


@pytest.mark.parametrize("count", [10, 41, 60, 150])
def test_edges_join_every_marker_and_mirror_each_other(count: int) -> None:
    layout = _layout(count)
    marker_set = edges_between(layout.marker_set, _SURFACE.vertices[layout.vertices])
    mirror = {left: right for left, right in marker_set.pairs}
    mirror |= {right: left for left, right in marker_set.pairs}
    edges = {frozenset(edge) for edge in marker_set.edges}
    assert len(edges) == len(marker_set.edges)
    assert {frozenset(mirror.get(end, end) for end in edge) for edge in edges} == edges
    assert frozenset().union(*edges) == set(marker_set.markers)
    assert marker_set.stable == layout.marker_set.stable

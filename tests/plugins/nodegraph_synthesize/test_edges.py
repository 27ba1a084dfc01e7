from __future__ import annotations

import pytest

from nodegraph_synthesize.layout import edges_between, make_layout
from nodegraph_synthesize.proportions import Proportions
from nodegraph_synthesize.surface import make_surface


@pytest.mark.parametrize("count", [10, 41, 60, 150])
def test_edges_join_every_marker_and_mirror_each_other(count: int) -> None:
    surface = make_surface(Proportions())
    layout = make_layout(count, surface.places)
    marker_set = edges_between(layout.marker_set, surface.vertices[layout.vertices])
    mirror = {left: right for left, right in marker_set.pairs}
    mirror |= {right: left for left, right in marker_set.pairs}
    edges = {frozenset(edge) for edge in marker_set.edges}
    assert len(edges) == len(marker_set.edges)
    assert {frozenset(mirror.get(end, end) for end in edge) for edge in edges} == edges
    assert frozenset().union(*edges) == set(marker_set.markers)
    assert marker_set.stable == layout.marker_set.stable

from __future__ import annotations

import networkx as nx

from nodegraph.draw.layers import depths_of


def test_a_box_stands_below_all_that_feeds_it() -> None:
    assert depths_of(nx.MultiDiGraph([(7, 8), (8, 9), (7, 9)])) == {7: 0, 8: 1, 9: 2}


def test_a_source_that_is_needed_late_stands_near_its_reader() -> None:
    model = 3
    assert depths_of(nx.MultiDiGraph([(0, 1), (1, 2), (model, 2)]))[model] == 1

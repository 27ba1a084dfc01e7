from __future__ import annotations

from pathlib import Path

import nodegraph_mocap

ROOT = Path(__file__).parents[3]


def test_the_shipped_graphs_are_found() -> None:
    graphs = list(nodegraph_mocap.nodegraph_graphs())
    assert [path.name for path in graphs] == sorted(path.name for path in graphs)
    assert (ROOT / "graphs" / "fill.yaml") in graphs

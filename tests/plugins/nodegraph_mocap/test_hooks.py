from __future__ import annotations

from pathlib import Path

import nodegraph_files
import nodegraph_mocap
from nodegraph_files import sample_folder

ROOT = Path(__file__).parents[3]


def test_the_nodes_are_named() -> None:
    from nodegraph.node.decorator import node_of

    described = [node_of(registered) for registered in nodegraph_files.nodegraph_nodes()]
    assert "read.recording" in {registered.name for registered in described if registered}
    assert None not in described


def test_samples_are_a_place() -> None:
    assert nodegraph_files.nodegraph_places()["sample"]("face") == sample_folder("face")


def test_the_shipped_graphs_are_found() -> None:
    graphs = list(nodegraph_mocap.nodegraph_graphs())
    assert [path.name for path in graphs] == sorted(path.name for path in graphs)
    assert (ROOT / "graphs" / "fill.yaml") in graphs


def test_every_public_name_is_there() -> None:
    for name in nodegraph_mocap.__all__:
        assert getattr(nodegraph_mocap, name) is not None

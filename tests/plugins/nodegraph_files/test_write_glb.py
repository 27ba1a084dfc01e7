from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import nodegraph as ng
from nodegraph_files import animation_bytes, head_bytes
from nodegraph_files.readers import read_head
from nodegraph_files.writers import write_glb
from nodegraph_mocap.specimens import animations, heads

HEAD = heads()["complete"]
COMPLETE = animations()["complete"]
GRAPH = """\
nodegraph: 1
title: A head
nodes:
  face: {use: synthesize.face, with: {seconds: 0.1}}
  out: {use: write.glb, in: {head: face.head}}
"""


def test_what_is_fed_is_written() -> None:
    both = write_glb(COMPLETE, HEAD).content
    assert both == {"animation.glb": animation_bytes(COMPLETE), "head.glb": head_bytes(HEAD)}
    assert set(write_glb(COMPLETE).content) == {"animation.glb"}
    assert set(write_glb(head=HEAD).content) == {"head.glb"}


def test_nothing_fed_is_an_error() -> None:
    with pytest.raises(ValueError, match="feed an animation or a head"):
        write_glb()


def test_a_graph_writes_a_head_that_reads_back(tmp_path: Path) -> None:
    (tmp_path / "graph.yaml").write_text(GRAPH)
    written = ng.run(ng.load(tmp_path / "graph.yaml"))["out"].value
    path = tmp_path / "head.glb"
    path.write_bytes(written.content["head.glb"])
    synthetic = ng.get_node("synthesize.face")(seconds=0.1).head
    back = read_head(path=path)
    assert (back.names, back.markers) == (synthetic.names, synthetic.markers)
    np.testing.assert_allclose(back.vertices, synthetic.vertices, rtol=1e-7, atol=1e-12)

"""What nodes of the package say when they are used together, and in a graph."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import nodegraph as ng
from nodegraph_files import head_bytes
from nodegraph_mocap import Animation, Trajectories
from nodegraph_mocap.specimens import heads

GRAPH = """\
nodegraph: 1
inputs: {head: head.glb, weights: weights.csv}
axes:
  k: [1, 2]
nodes:
  face: {use: read.head, with: {path: $head}}
  curves: {use: read.weights, with: {path: $weights}}
  parallel: {use: blendshapes.from_head, in: face}
  posed: {use: blendshapes.pose, in: {weights: curves, model: parallel}}
  model:
    in: posed
    alternatives:
      frames: {use: blendshapes.from_frames, with: {frames: {one: 1, two: 2}}}
      pca: {use: blendshapes.from_pca, with: {components: $k}}
  animation: {use: animate.mesh, in: {weights: curves, head: face}}
  files: {use: write.glb, in: animation}
"""
CURVES = """\
Timecode,BlendShapeCount,JawOpen,MouthSmileLeft,MouthSmileRight
00:00:00:01.000,3,0,0,0
00:00:00:02.000,3,1,0.5,0.25
00:00:00:03.000,3,0.5,0.75,1
00:00:00:04.000,3,0.25,1,0
"""


def test_a_graph_poses_builds_and_animates(tmp_path: Path) -> None:
    head = heads()["complete"]
    (tmp_path / "head.glb").write_bytes(head_bytes(head))
    (tmp_path / "weights.csv").write_text(CURVES)
    (tmp_path / "graph.yaml").write_text(GRAPH)
    run = ng.run(ng.load(tmp_path / "graph.yaml"))
    posed = run["posed"].value
    assert isinstance(posed, Trajectories)
    built = run["model"].at(model="frames", k=1)
    np.testing.assert_array_equal(built.neutral, posed.positions[0])
    assert len(run["model"].at(model="pca", k=2).names) == 2
    animation = run["animation"].value
    assert isinstance(animation, Animation)
    at_markers = animation.head.vertices + np.tensordot(
        animation.morph_weights, animation.head.morphs, axes=1
    )
    np.testing.assert_allclose(
        at_markers[:, head.marker_vertices], posed.positions, rtol=0, atol=1e-9
    )
    assert list(run["files"].value.content) == ["animation.glb"]

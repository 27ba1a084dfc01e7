"""What fills declare, and what a run says of a fill that breaks a promise."""

from __future__ import annotations

from pathlib import Path

from nodegraph.node.declaration import UNDECLARED
from nodegraph.node.decorator import node_of
from nodegraph_fill import nodegraph_nodes
from tests.records import read_record
from tests.studies import command

LAB = """
from dataclasses import replace

from nodegraph import node
from nodegraph_mocap import Origin, Trajectories


@node("fill.honest")
def honest(recording: Trajectories) -> Trajectories:
    \"\"\"Put every missing sample at one place.\"\"\"
    positions = recording.positions.copy()
    positions[~recording.present] = 50.0
    return recording.with_samples(positions, changed=~recording.present, origin=Origin.FILLED)


@node("fill.sly")
def sly(recording: Trajectories) -> Trajectories:
    \"\"\"Move what was measured in frames 5 and 6, too.\"\"\"
    filled = honest(recording)
    positions = filled.positions.copy()
    positions[5:7, 0] += 0.01
    return replace(filled, positions=positions)
"""
GRAPH = """
nodegraph: 1
nodes:
  capture: {use: read.recording, with: {path: "sample:face"}}
  gaps: {use: gaps.cut, in: capture, with: {length: 15}}
  fill: {in: gaps.gappy, alternatives: [fill.honest, fill.sly]}
  error: {use: score.gaps, in: {estimate: fill, truth: gaps.truth, hidden: gaps.hidden}}
"""


def test_every_fill_can_be_compared_on_equal_terms() -> None:
    for function in nodegraph_nodes():
        fill = node_of(function)
        assert fill is not None
        assert [port.name for port in fill.inputs] == ["recording"]
        assert not [setting.name for setting in fill.settings.values() if setting.required]
        assert fill.settings["ends"].default == "as_published"
        assert fill.settings["max_gap"].default is None
        assert fill.lookahead(fill.defaults) is not UNDECLARED
        assert fill.meets_ends({**fill.defaults, "ends": "met"}) is True


def test_a_run_names_the_promises_that_a_third_partys_call_breaks(tmp_path: Path) -> None:
    (tmp_path / "lab.py").write_text(LAB)
    (tmp_path / "graph.yaml").write_text(GRAPH)
    words = ("run", "graph.yaml", "--plugin", "lab.py", "--store", "store", "--out", "out")
    ended = command(*words, folder=tmp_path)
    assert ended.status == 0, ended.err
    warned = {
        step["use"]: step.get("warnings", []) for step in read_record(tmp_path / "out")["steps"]
    }
    assert warned["fill.honest"] == []
    assert warned["fill.sly"] == [
        "frame 5, marker 'M_nose1' and 1 more sample changed: write where "
        "~recording.present only (every fill.* node promises: Leave present samples bit for bit as "
        "they are, and write only missing ones)"
    ]

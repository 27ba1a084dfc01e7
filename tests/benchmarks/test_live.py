"""A stream of frames: what the engine costs, and how late a frame comes through."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import nodegraph as ng
from nodegraph.live.counts import Causes
from nodegraph.live.engine import Engine, Tap
from nodegraph.live.plan import live_plan
from nodegraph.live.session import session_of
from nodegraph_mocap import MarkerFrame, Trajectories
from tests.benchmarks.conftest import Clock
from tests.benchmarks.tables import Tables

CASE = "stream of 60 markers through a chain of 10 nodes that do nothing"
FRAMES, NODES = 20_000, 10
PLUGIN = '''
from nodegraph import StateForm, node
from nodegraph_mocap import Trajectories


class Same:
    def __init__(self, recording):
        self.header = recording

    def push(self, frame):
        return frame

    def drain(self):
        return ()


@node("chain.same", lookahead=0, live=StateForm(Same))
def same(recording: Trajectories) -> Trajectories:
    """Do nothing."""
    return recording
'''
PIPELINE = """
nodegraph: 1
title: A face, cleaned frame by frame
inputs: {recording: take.npz}
nodes:
  face: {use: synthesize.face, with: {seconds: 1}}
  capture: {use: read.recording, with: {path: $recording}}
  despike: {use: despike.hampel, in: capture}
  fill: {use: fill.muscle, in: despike}
  smooth: {use: smooth.bspline, in: fill}
  still: {use: align.procrustes, in: {recording: smooth, reference: face.neutral}}
  weights: {use: solve.weights, in: {recording: still, model: face.model}}
"""


class Nowhere:
    """A sink that keeps nothing."""

    def open(self, header: Any) -> None:
        """Do nothing."""

    def write(self, frame: ng.Frame) -> None:
        """Do nothing."""

    def close(self) -> None:
        """Do nothing."""


def ours(folder: Path) -> Callable[[], int]:
    (folder / "chain.py").write_text(PLUGIN)
    names = ["capture", *(f"n{number}" for number in range(NODES))]
    nodes = [f"  {name}: {{use: chain.same, in: {before}}}\n" for before, name in pairwise(names)]
    (folder / "chain.yaml").write_text(
        "nodegraph: 1\nnodes:\n  capture: {use: synthesize.face}\n" + "".join(nodes)
    )
    graph = ng.load(folder / "chain.yaml", plugins=[folder / "chain.py"])
    planned = live_plan(graph, "capture")
    take: Trajectories = ng.get_node("synthesize.face")(seconds=1.0).captured
    header = replace(take, positions=take.positions[:0], origin=take.origin[:0])
    frame = ng.Frame(0, 0, 0, MarkerFrame(take.positions[0], take.origin[0]))
    (last,) = planned.outputs(names[-1])

    def run() -> int:
        counted: Counter[str] = Counter()

        def count(frame: ng.Frame) -> None:
            counted["frames"] += 1

        engine = Engine(planned, header, {}, [Tap(last, count)], Causes())
        for _ in range(FRAMES):
            engine.push(frame)
        return counted["frames"]

    return run


def bare(folder: Path) -> Callable[[], int]:
    frame = np.zeros((60, 3))

    def same(value: Any) -> Any:
        return value

    def run() -> int:
        count = 0
        for _ in range(FRAMES):
            value = frame
            for _ in range(NODES):
                value = same(value)
            count += 1
        return count

    return run


def csp(folder: Path) -> Callable[[], int]:
    chain = pytest.importorskip("tests.benchmarks.engines.csp_stream").csp_chain
    run: Callable[[], int] = chain(NODES, FRAMES)
    return run


ENGINES: dict[str, Callable[[Path], Callable[[], int]]] = {
    "nodegraph": ours,
    "bare calls": bare,
    "csp": csp,
}


@pytest.mark.parametrize("name", ENGINES)
def test_chain(name: str, clock: Clock, tmp_path: Path) -> None:
    run = ENGINES[name](tmp_path)
    column = "us/node and frame"
    assert clock(CASE, name, column, run, per=FRAMES * NODES, rounds=5) == FRAMES


@pytest.mark.parametrize("rate", [240, 1000])
def test_latency(rate: int, tables: Tables, tmp_path: Path) -> None:
    take: Trajectories = ng.get_node("synthesize.face")(
        seconds=2400 / 240, rate=240.0, missing=0.05
    ).captured
    content = ng.get_node("write.npz")(take).content["recording.npz"]
    (tmp_path / "take.npz").write_bytes(content)
    (tmp_path / "graph.yaml").write_text(PIPELINE)
    graph = ng.load(tmp_path / "graph.yaml")
    source = ("recording", f"replay:{tmp_path / 'take.npz'}@{rate}")
    counts = session_of(graph, source, [("weights", Nowhere())]).run()
    assert counts.computed == counts.written["weights"] == take.frames
    case = f"{len(take.markers)} markers through despike, fill, smooth, align and solve"
    for quantile, milliseconds in counts.latencies.milliseconds().items():
        tables.put(case, f"nodegraph, {rate} Hz", f"{quantile} ms", milliseconds)

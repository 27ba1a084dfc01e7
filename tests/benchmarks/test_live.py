"""A stream of frames: what the engine costs, and how late a frame comes through."""

from __future__ import annotations

import subprocess
import sys
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
from tests.live_peers import free_port

CASE = "stream of 60 markers through a chain of 10 nodes that do nothing"
COLUMN = "us/node and frame"
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
title: A face, from points without names to weights
inputs: {recording: take.npz}
nodes:
  capture: {use: read.recording, with: {path: $recording}}
  model:   {use: read.model, with: {path: sample:face}}
  points:  {use: points.unnamed, in: capture}
  tracks:
    use: track.neighbours
    in: {detections: points, reference: model.neutral}
    with: {gate: 8, shortest: 1}
  despike: {use: despike.impulse, in: tracks, with: {calibration: 120}}
  fill:    {use: fill.muscle, in: despike}
  smooth:  {use: smooth.bspline, in: fill}
  still:   {use: align.procrustes, in: {recording: smooth, reference: model.neutral}}
  weights: {use: solve.weights, in: {recording: still, model: model}}
"""
SENDER = """
import sys, time
from dataclasses import replace
from nodegraph import Frame
from nodegraph_files import read_npz
from nodegraph_live import nodegraph_sinks
from nodegraph_mocap import MarkerFrame

file, port, rate = sys.argv[1], sys.argv[2], float(sys.argv[3])
take = read_npz(file)
sink = nodegraph_sinks()["udp"](f"127.0.0.1:{port}")
sink.open(replace(take, positions=take.positions[:0], origin=take.origin[:0]))
start = time.perf_counter()
for number in range(2 * take.frames):
    time.sleep(max(number / rate - (time.perf_counter() - start), 0.0))
    frame = min(number, 2 * take.frames - 1 - number)  # there and back
    sink.write(Frame(number, 0, 1, MarkerFrame(take.positions[frame], take.origin[frame])))
sink.close()
"""


class Nowhere:
    """A sink that keeps nothing."""

    def open(self, header: object) -> None:
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

    def same(value: object) -> Any:
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


def timeflux(folder: Path) -> Callable[[], int]:
    chain = pytest.importorskip("tests.benchmarks.engines.timeflux_stream").timeflux_chain
    run: Callable[[], int] = chain(NODES, FRAMES)
    return run


ENGINES: dict[str, Callable[[Path], Callable[[], int]]] = {
    "nodegraph": ours,
    "bare calls": bare,
    "csp": csp,
    "Timeflux": timeflux,
}


@pytest.mark.parametrize("name", ENGINES)
def test_chain(name: str, clock: Clock, tmp_path: Path) -> None:
    run = ENGINES[name](tmp_path)
    assert clock(CASE, name, COLUMN, run, per=FRAMES * NODES, rounds=5) == FRAMES


def test_chain_of_ezmsg(tables: Tables) -> None:
    chain = pytest.importorskip("tests.benchmarks.engines.ezmsg_stream").ezmsg_chain
    frames = FRAMES // 10
    rounds = [chain(NODES, frames)() for _ in range(3)]
    assert {count for count, _ in rounds} == {frames}
    fastest = min(seconds for _, seconds in rounds)
    tables.put(CASE, "ezmsg", COLUMN, fastest / (frames * NODES) * 1e6)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("stream")
    take = ng.get_node("synthesize.face")(seconds=10.0, rate=240.0, missing=0.05).captured
    (folder / "take.npz").write_bytes(ng.get_node("write.npz")(take).content["recording.npz"])
    (folder / "graph.yaml").write_text(PIPELINE)
    return folder


@pytest.mark.parametrize("rate", [240, 1000])
@pytest.mark.parametrize("way", ["a file", "loopback"])
def test_latency(way: str, rate: int, tables: Tables, folder: Path) -> None:
    graph, take, port = ng.load(folder / "graph.yaml"), folder / "take.npz", free_port()
    address = f"replay:{take}@{rate}" if way == "a file" else f"udp:{port}?timeout=60"
    session = session_of(graph, ("recording", address), [("weights", Nowhere())])
    command = [sys.executable, "-c", SENDER, str(take), str(port), str(rate)]
    frames = 2400
    if way == "a file":
        counts = session.run()
    else:
        frames *= 2
        with subprocess.Popen(command):
            counts = session.run()
    assert counts.computed == counts.received == frames
    assert counts.written["weights"] > 0
    case = "60 markers through track, despike, fill, smooth, align and solve"
    for quantile, milliseconds in counts.latencies.milliseconds().items():
        tables.put(case, f"from {way}, {rate} Hz", f"{quantile} ms", milliseconds)

"""``nodegraph live`` with packets in and packets out, on this machine."""

from __future__ import annotations

from pathlib import Path
from threading import Event

import numpy as np
import pytest

from nodegraph import Frame
from nodegraph.cli.main import main
from nodegraph_files import read_npz
from nodegraph_live import nodegraph_sinks, nodegraph_sources
from nodegraph_mocap import MarkerFrame, Trajectories
from tests.live_peers import HOST, free_port, in_thread, wave

NODES = '''
from dataclasses import replace

import numpy as np
from nodegraph import node
from nodegraph_mocap import Trajectories, Weights


@node("test.twice", live="frame")
def twice(recording: Trajectories) -> Trajectories:
    """Double all positions."""
    return replace(recording, positions=2.0 * recording.positions)


@node("test.weights", live="frame")
def weights(recording: Trajectories) -> Weights:
    """Take x for a weight."""
    return Weights(
        values=recording.positions[..., 0], names=recording.markers, rate=recording.rate
    )
'''
GRAPH = """
nodegraph: 1
title: Twice
inputs: {take: "sample:face"}
nodes:
  capture: {use: read.recording, with: {path: $take}}
  twice: {use: test.twice, in: capture}
  weights: {use: test.weights, in: twice}
"""
RECORDING = Trajectories(positions=wave(40, 3), markers=("JawOpen", "TongueOut", "c"), rate=5)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "nodes.py").write_text(NODES)
    (tmp_path / "graph.yaml").write_text(GRAPH)
    return tmp_path


def live(folder: Path, source: str, *options: str) -> int:
    graph, nodes = str(folder / "graph.yaml"), str(folder / "nodes.py")
    store = str(folder / "store")
    return main(
        [
            "live",
            graph,
            "--plugin",
            nodes,
            "--store",
            store,
            "--source",
            f"capture={source}",
            *options,
        ]
    )


def test_what_comes_in_packets_goes_out_in_packets_and_plays_again(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    port, markers, weights = free_port(), free_port(), free_port()
    results: list[Frame] = []
    shapes: list[Frame] = []
    done = Event()

    def send(ended: Event) -> None:
        sink = nodegraph_sinks()["udp"](f"{HOST}:{port}?bytes=8")
        sink.open(RECORDING)
        number = 0
        while not done.wait(0.001) and number < 5000:
            payload = MarkerFrame(RECORDING.positions[number % 40], RECORDING.origin[number % 40])
            sink.write(Frame(number, number, 1, payload))
            number += 1
        sink.close()

    def receive_markers(ended: Event) -> None:
        source = nodegraph_sources()["udp"](str(markers))
        header = source.open()
        for packet in source.packets():
            results.extend(source.frames(packet, 1, header))
        source.close()

    def receive_weights(ended: Event) -> None:
        source = nodegraph_sources()["vmc"](f"{weights}?rate=5")
        header = source.open()
        for packet in source.packets():
            shapes.extend(source.frames(packet, 1, header))
            if len(shapes) >= 30:
                break
        source.close()
        done.set()

    with in_thread(receive_weights), in_thread(receive_markers), in_thread(send):
        status = live(
            folder,
            f"udp:{port}",
            *("--sink", f"twice=udp:{HOST}:{markers}?bytes=8"),
            *("--sink", f"weights=vmc:{HOST}:{weights}"),
            *("--record", str(folder / "packets")),
        )
    assert status == 0
    assert "undecodable" not in capsys.readouterr().out
    assert len(shapes) >= 30
    numbers = [frame.index for frame in results]
    assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
    for frame in results:
        np.testing.assert_array_equal(
            frame.payload.positions, 2 * RECORDING.positions[frame.index % 40]
        )
    output = folder / "again.npz"
    assert live(folder, f"replay:{folder / 'packets'}@0", "--sink", f"twice=file:{output}") == 0
    again = read_npz(output)
    assert again.markers == RECORDING.markers
    sent = [frame.payload.positions for frame in results]
    expected = [positions for positions in sent if not np.isnan(positions).any()]
    whole = again.positions[~np.isnan(again.positions).any(axis=(1, 2))]
    start = int(np.argmax((whole == expected[0]).all(axis=(1, 2))))
    np.testing.assert_array_equal(whole[start : start + len(expected)], expected)


def test_a_source_of_another_type_or_that_is_not_there_ends_in_a_message(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert live(folder, f"vmc:{free_port()}?rate=60&timeout=0.2") == 2
    assert "no complete VMC frame" in capsys.readouterr().err
    assert live(folder, "vmc:x") == 2
    assert "expected vmc:[HOST:]PORT?rate=HZ" in capsys.readouterr().err

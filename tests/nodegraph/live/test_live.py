"""A graph on a stream gives what it gives of the whole take, whatever happens on the way."""

from __future__ import annotations

import json
import os
import signal
import struct
import subprocess
import sys
import tracemalloc
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import nodegraph as ng
from nodegraph import NodegraphError
from nodegraph.cli.main import main
from nodegraph.graph import Graph
from nodegraph.live.session import session_of
from nodegraph.testing import difference
from nodegraph_files import read_npz
from nodegraph_mocap import MarkerFrame, Trajectories
from tests.texts import edit

NODES = '''
import struct
from dataclasses import replace

import numpy as np

from nodegraph import Frame, FrameForm, NodegraphError, Refusal, StateForm, WindowForm
from nodegraph import fold, hookimpl, node
from nodegraph_files import read_npz
from nodegraph_mocap import BlendshapeModel, MarkerFrame, Origin, Trajectories, Weights


def half(settings):
    return None if settings["width"] is None else settings["width"] // 2


def result(positions, frame):
    missing = np.isnan(positions[:, 0])
    origin = np.where(frame.origin == Origin.MISSING, np.uint8(Origin.FILLED), frame.origin)
    return MarkerFrame(positions, np.where(missing, np.uint8(0), origin))


def mean_at(window, *, width):
    frames, now = window.frames, window.now
    total = np.zeros_like(frames.positions[now])
    for positions in frames.positions:
        total = total + positions
    return result(total / width, MarkerFrame(total, frames.origin[now]))


MEAN = WindowForm(mean_at, before=half, after=half)


@node("avg.mean", lookahead=half, live=MEAN)
def mean(recording: Trajectories, *, width: int | None = 3) -> Trajectories:
    """Average the frames around each.

    Parameters
    ----------
    recording
        Any.
    width
        Of the window.
    """
    return fold(MEAN, recording, width=width)


class HoldLive:
    def __init__(self, recording):
        self.header = recording
        self.last = np.full((len(recording.markers), 3), np.nan)

    def push(self, frame):
        if frame.positions[0, 0] > 1e6:
            raise Refusal(f"{frame.positions[0, 0]:.0f} mm is too far away")
        self.last = np.where(np.isnan(frame.positions), self.last, frame.positions)
        return result(self.last, frame)

    def drain(self):
        return ()


HOLD = StateForm(HoldLive)


@node("avg.hold", lookahead=0, live=HOLD)
def hold(recording: Trajectories) -> Trajectories:
    """Hold the last position."""
    return fold(HOLD, recording)


@node("avg.restore", live=FrameForm(streams=("recording", "other")))
def restore(recording: Trajectories, other: Trajectories) -> Trajectories:
    """Take what is missing from another recording."""
    missing = ~recording.present & other.present
    positions = np.where(missing[..., None], other.positions, recording.positions)
    return recording.with_samples(positions, changed=missing, origin=Origin.FILLED)


@node("avg.model")
def model_of(recording: Trajectories) -> BlendshapeModel:
    """Take the mean of a recording as a model at rest."""
    neutral = np.nan_to_num(np.nanmean(recording.positions, axis=0))
    return BlendshapeModel(
        neutral=neutral,
        shapes=np.zeros((1, *neutral.shape)),
        names=("jawOpen",),
        markers=recording.markers,
    )


@node("avg.towards", live="frame")
def towards(recording: Trajectories, model: BlendshapeModel) -> Trajectories:
    """Go half the way to a model at rest."""
    model = model.neutral
    return recording.with_samples(
        (recording.positions + model) / 2.0,
        changed=np.zeros(recording.origin.shape, dtype=bool),
        origin=Origin.FILLED,
    )


def at_end(window, *, ahead):
    if np.isnan(window.frames.positions[-1]).all():
        raise Refusal("its last frame is missing")
    return MarkerFrame(*(None if part is None else part[0].copy() for part in window.frames))


LATE = WindowForm(at_end, before=0, after=lambda settings: settings["ahead"])


@node("avg.late", lookahead=lambda settings: settings["ahead"], live=LATE)
def late(recording: Trajectories, *, ahead: int = 5) -> Trajectories:
    """Leave a recording as it is, if what is ahead is there."""
    return fold(LATE, recording, ahead=ahead)


class Wire:
    """Sends frames of a file by their numbers; x is garbage, ! a lost connection.

    After !2 the connection cannot be made again twice; after ~ the source comes at twice the rate.
    """

    def __init__(self, address):
        file, _, script = address.partition("?")
        self.take = read_npz(file)
        self.script = iter(script.split(","))
        self.away = 0

    def open(self):
        if self.away:
            self.away -= 1
            raise NodegraphError("nobody answers")
        return replace(self.take, positions=self.take.positions[:0], origin=self.take.origin[:0])

    def packets(self):
        for word in self.script:
            if word == "~":
                self.take = replace(self.take, rate=2 * self.take.rate)
                raise ConnectionResetError("gone")
            if word[0] == "!":
                self.away = int(word[1:] or 0)
                raise ConnectionResetError("gone")
            first, _, last = word.partition("-")
            if word == "x":
                yield b"garbage"
            else:
                for number in range(int(first), int(last or first) + 1):
                    yield struct.pack("<q", number)

    def frames(self, packet, arrived, header):
        if len(packet) != 8:
            raise ValueError("garbage")
        (number,) = struct.unpack("<q", packet)
        frame = number % self.take.frames
        yield Frame(
            number, 0, arrived, MarkerFrame(self.take.positions[frame], self.take.origin[frame])
        )

    def close(self):
        pass


@hookimpl
def nodegraph_sources():
    return {"wire": Wire}
'''
GRAPH = """
nodegraph: 1
title: Branches
inputs: {take: take.npz, length: 0.1}
nodes:
  capture: {use: read.recording, with: {path: $take}}
  face: {use: synthesize.face, with: {seconds: $length}}
  avg:
    in: capture
    alternatives:
      narrow: {use: avg.mean, with: {width: 3}}
      wide: {use: avg.mean, with: {width: 9}}
  held: {use: avg.hold, in: avg}
  both: {use: avg.restore, in: {recording: capture, other: held}}
  near: {use: avg.towards, in: {recording: both, model: face.model}}
  shapes: {use: avg.model, in: capture}
  beside: {use: avg.towards, in: {recording: held, model: shapes}}
  far: {use: avg.hold, in: capture}
  late: {use: avg.late, in: held}
  joined: {use: avg.restore, in: {recording: capture, other: late}}
  endless: {use: avg.mean, in: capture, with: {width: null}}
  spectra: {use: plot.spectra, in: {recordings: near}}
"""
FRAMES = 50


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("live")
    (folder / "nodes.py").write_text(NODES)
    (folder / "graph.yaml").write_text(GRAPH)
    recording: Trajectories = ng.get_node("synthesize.face")(seconds=1.0, missing=0.2).captured
    recording = replace(
        recording, positions=recording.positions[:FRAMES], origin=recording.origin[:FRAMES]
    )
    (folder / "take.npz").write_bytes(ng.get_node("write.npz")(recording).content["recording.npz"])
    return folder


@pytest.fixture(scope="module")
def graph(folder: Path) -> Graph:
    return ng.load(folder / "graph.yaml", plugins=[folder / "nodes.py"])


@pytest.fixture(scope="module")
def take(folder: Path) -> Trajectories:
    return read_npz(folder / "take.npz")


class Box:
    """A sink that keeps what it is given, and is away for a while if that is wanted."""

    def __init__(self, away: int = 0) -> None:
        self.frames: list[ng.Frame] = []
        self.away = away

    def open(self, header: Any) -> None:
        self.header = header

    def write(self, frame: ng.Frame) -> None:
        if self.away:
            self.away -= 1
            raise ConnectionRefusedError("nobody there")
        self.frames.append(frame)

    def close(self) -> None:
        pass


def play(graph: Graph, folder: Path, script: str, sink: str, **options: Any) -> tuple[Any, Box]:
    """Run a graph on the frames of a script; the counts, and what a sink got."""
    box = Box(options.pop("away", 0))
    source = ("take", f"wire:{folder / 'take.npz'}?{script}")
    session = session_of(graph, source, [(sink, box)], **options)
    return session.run(), box


def recording_of(box: Box) -> Trajectories:
    header: Trajectories = box.header
    return replace(
        header,
        positions=np.stack([frame.payload.positions for frame in box.frames]),
        origin=np.stack([frame.payload.origin for frame in box.frames]),
    )


def test_every_branch_gives_what_the_whole_take_gives(
    folder: Path, graph: Graph, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    nodes = ("avg", "held", "both", "near")
    command = ["live", str(folder / "graph.yaml"), "--plugin", str(folder / "nodes.py")]
    command += ["--source", f"take=replay:{folder / 'take.npz'}@0", "--out", str(tmp_path)]
    for name in nodes:
        command += ["--sink", f"{name}=file:{tmp_path}/{name}_{{avg}}.npz"]
    assert main([*command, "--store", str(tmp_path / "store")]) == 0
    run = ng.run(graph, cache=False)
    for name in nodes:
        for label in ("narrow", "wide"):
            streamed = read_npz(tmp_path / f"{name}_{label}.npz")
            assert not difference(streamed, run[name].at(avg=label)), (name, label)
    counts = json.loads((tmp_path / "live.json").read_text())
    assert counts["received"] == counts["computed"] == FRAMES
    assert set(counts["written"].values()) == {FRAMES}
    assert counts["behind"]["near(avg=wide)"] == 4
    assert f"{FRAMES} received, {FRAMES} computed" in capsys.readouterr().out


def test_what_goes_wrong_on_the_way_is_counted(
    folder: Path, graph: object, take: Trajectories
) -> None:
    narrow = graph_with(folder, only={"avg": "narrow"})
    counts, box = play(narrow, folder, "0-9,12-14,11,14,x,15-19", "held")
    numbers = counts.as_json()
    assert (numbers["missing"], numbers["late"], numbers["repeated"]) == (2, 1, 1)
    assert (numbers["undecodable"], numbers["resets"]) == (1, 0)
    assert [frame.index for frame in box.frames] == list(range(20))
    positions, origin = take.positions[:20].copy(), take.origin[:20].copy()
    positions[10:12], origin[10:12] = np.nan, 0
    damaged = replace(take, positions=positions, origin=origin)
    nodes = narrow.registry
    averaged = nodes.find("avg.mean").node.function(damaged, width=3)
    assert not difference(recording_of(box), nodes.find("avg.hold").node.function(averaged))


def test_a_stream_that_returns_or_jumps_begins_anew(folder: Path) -> None:
    announced: list[str] = []
    narrow = graph_with(folder, only={"avg": "narrow"})
    counts, box = play(narrow, folder, "5-9,!,5-9,90000-90004", "held", announce=announced.append)
    assert (counts.reconnected, counts.resets, counts.missing) == (1, 2, 0)
    assert [frame.index for frame in box.frames] == [*range(5, 10)] * 2 + [*range(90000, 90005)]
    assert not difference(box.frames[0].payload, box.frames[5].payload)
    assert "gone" in announced[1]
    assert "after frame 9 comes 90000" in announced[2]


def test_a_file_has_dropped_frames_as_missing_and_a_new_stream_is_another(
    folder: Path, tmp_path: Path
) -> None:
    narrow = graph_with(folder, only={"avg": "narrow"})
    source = ("take", f"wire:{folder / 'take.npz'}?5-9,!,12-14,90000-90004")
    counts = session_of(narrow, source, [("far", f"file:{tmp_path}/far.npz")]).run()
    assert (counts.computed, counts.missing) == (13, 0)
    present = read_npz(tmp_path / "far.npz").present
    assert len(present) == 10
    assert np.flatnonzero(~present.any(axis=1)).tolist() == [5, 6]
    assert read_npz(tmp_path / "far_2.npz").frames == 5
    assert "far_2.npz" in next(iter(counts.as_json()["warnings"]))


def test_counts_are_printed_and_kept_whatever_fails(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["live", str(folder / "graph.yaml"), "--plugin", str(folder / "nodes.py")]
    command += ["--only", "avg=narrow", "--sink", f"held=file:{tmp_path}/held.npz"]
    source = f"take=wire:{folder / 'take.npz'}?0-9"
    assert main([*command, "--source", f"{source},broken", "--out", str(tmp_path)]) == 2
    output, errors = capsys.readouterr()
    assert "frames: 10 received, 10 computed" in output
    assert "wire:" in errors
    kept = json.loads((tmp_path / "live.json").read_text())
    assert kept["computed"] == 10
    assert "invalid literal" in kept["error"]
    (tmp_path / "held.npz").unlink()
    assert main([*command, "--source", source, "--out", str(folder / "take.npz")]) == 2
    output, errors = capsys.readouterr()
    assert "frames: 10 received, 10 computed" in output
    assert "take.npz" in errors


def test_recorded_packets_play_the_same_again(folder: Path, graph: object, tmp_path: Path) -> None:
    narrow = graph_with(folder, only={"avg": "narrow"})
    packets = tmp_path / "packets"
    first, box = play(narrow, folder, "0-9,13-14,12,!,20-29,x", "near", record=packets)
    replayed = Box()
    counts = session_of(narrow, ("take", f"replay:{packets}@0"), [("near", replayed)]).run()
    assert [frame[:2] for frame in replayed.frames] == [frame[:2] for frame in box.frames]
    assert not difference(recording_of(replayed), recording_of(box))
    assert (counts.resets, counts.missing, counts.late, counts.undecodable) == (1, 3, 1, 1)
    assert (first.resets, first.missing, first.late, first.undecodable) == (1, 3, 1, 1)
    packets.write_bytes(packets.read_bytes()[:-3])
    counts = session_of(narrow, ("take", f"replay:{packets}@0"), [("held", Box())]).run()
    assert counts.undecodable == 0
    assert "ends in the middle of a packet" in next(iter(counts.as_json()["warnings"]))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"source": {"udp": 1}}, "source: input should be a valid string"),
        ({"source": None}, "source: input should be a valid string"),
        ({"sizes": [-1]}, "sizes: input should be greater than or equal to 0"),
        ({"sizes": [1 << 70]}, "header: "),
        ({"sizes": [1 << 40]}, "header: "),
        ({"header": "[" * 100_000}, "header: it is not what such a file begins with"),
        ({"header": '["tuple"]', "sizes": []}, "values of type tuple cannot be streamed"),
        ({"header": "3", "sizes": []}, "values of type int cannot be streamed"),
        ({"more": 1}, "more: extra inputs are not permitted"),
        ({"source": "wire"}, "'wire': write SCHEME:"),
        ({"source": "replay:packets@0"}, "is the source of its own packets"),
        ({"source": "replay:{take}@0"}, "is another than was recorded: header.rate: 30.0 and 60.0"),
    ],
)
def test_a_damaged_packet_file_is_refused_with_what_is_wrong(
    folder: Path,
    tmp_path: Path,
    change: dict[str, object],
    message: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    narrow = graph_with(folder, only={"avg": "narrow"})
    packets = tmp_path / "packets"
    play(narrow, folder, "0-9", "near", record=packets)
    magic, head, rest = packets.read_bytes().split(b"\n", 2)
    other = replace(read_npz(folder / "take.npz"), rate=30.0)
    (tmp_path / "take.npz").write_bytes(ng.get_node("write.npz")(other).content["recording.npz"])
    monkeypatch.chdir(tmp_path)
    text = json.dumps({**json.loads(head), **change}).replace("{take}", "take.npz")
    packets.write_bytes(b"\n".join([magic, text.encode(), rest]))
    with pytest.raises(NodegraphError, match="packets: is damaged: ") as caught:
        session_of(narrow, ("take", "replay:packets@0"), [("near", Box())]).run()
    assert message in str(caught.value)


@pytest.mark.parametrize("head", [b"", b"{}", b"[" * 100_000, b"\xff", b'{"source": 1e999}'])
def test_a_packet_file_without_its_head_is_refused(
    folder: Path, tmp_path: Path, head: bytes
) -> None:
    (tmp_path / "packets").write_bytes(b"nodegraph packets 1\n" + head + b"\n")
    narrow = graph_with(folder, only={"avg": "narrow"})
    with pytest.raises(NodegraphError, match="packets: is damaged: "):
        session_of(narrow, ("take", f"replay:{tmp_path / 'packets'}@0"), [("near", Box())])


@pytest.mark.parametrize(
    ("record", "computed"),
    [
        (struct.pack("<BqI", 2, 10**9, 8), None),
        (struct.pack("<BqI", 0, -1, 8), None),
        (struct.pack("<BqI", 0, (1 << 63) - 1, 8), None),
        (struct.pack("<BqI", 0, 10**9, (1 << 32) - 1), 1),  # more than there is
        (struct.pack("<BqI", 1, 10**18, 8), 3),  # years later, by a new connection
    ],
)
def test_a_damaged_record_of_a_packet_ends_the_replay(
    folder: Path, tmp_path: Path, record: bytes, computed: int | None
) -> None:
    narrow = graph_with(folder, only={"avg": "narrow"})
    packets = tmp_path / "packets"
    play(narrow, folder, "0", "near", record=packets)
    content = packets.read_bytes()
    first = len(content) - 21
    frames = [struct.pack("<q", number) for number in range(3)]
    records = [struct.pack("<BqI", 0, 10**9, 8), record, record]
    content = content[:first] + b"".join(
        each for pair in zip(records, frames, strict=True) for each in pair
    )
    packets.write_bytes(content)
    session = session_of(narrow, ("take", f"replay:{packets}@0"), [("near", Box())])
    if computed is None:
        with pytest.raises(
            NodegraphError, match=f"damaged: no packet begins at byte {first + 21}$"
        ):
            session.run()
    else:
        assert session.run().computed == computed
    assert session.counts.computed == (computed or 1)


@pytest.mark.parametrize(
    ("number", "captured"), [(-1, 0), (1 << 63, 0), (1, 1 << 63), (1, -(10**22))]
)
def test_frames_with_impossible_numbers_are_undecodable(
    folder: Path, take: Trajectories, number: int, captured: int
) -> None:
    class Odd:
        def open(self) -> Trajectories:
            return replace(take, positions=take.positions[:0], origin=take.origin[:0])

        def packets(self) -> Iterator[bytes]:
            yield from (b"sound", b"odd")

        def frames(self, packet: bytes, arrived: int, header: object) -> Iterator[ng.Frame]:
            payload = MarkerFrame(take.positions[0], take.origin[0])
            at = (0, 0) if packet == b"sound" else (number, captured)
            yield ng.Frame(*at, arrived, payload)

        def close(self) -> None:
            pass

    box = Box()
    narrow = graph_with(folder, only={"avg": "narrow"})
    counts = session_of(narrow, ("take", Odd()), [("far", box)]).run()
    assert (counts.computed, counts.undecodable, len(box.frames)) == (1, 1, 1)


def test_a_frame_that_a_node_refuses_is_missing_and_counted(
    folder: Path, take: Trajectories
) -> None:
    positions = take.positions.copy()
    positions[7:9, 0] = [[2e6], [3e6]]
    origin = take.origin.copy()
    origin[7:9, 0] = 1
    far = replace(take, positions=positions, origin=origin)
    (folder / "far.npz").write_bytes(ng.get_node("write.npz")(far).content["recording.npz"])
    box = Box()
    graph = graph_with(folder, only={"avg": "narrow"}, set={"take": str(folder / "far.npz")})
    counts = session_of(graph, ("take", f"replay:{folder / 'far.npz'}@0"), [("far", box)]).run()
    assert dict(counts.refused) == {"far: 3000000 mm is too far away": 2}
    assert [frame.index for frame in box.frames] == list(range(FRAMES))
    assert all(np.isnan(box.frames[number].payload.positions).all() for number in (7, 8))


def test_a_sink_that_was_away_is_opened_again(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("nodegraph.live.addresses.RETRY_SECONDS", 0.0)
    narrow = graph_with(folder, only={"avg": "narrow"})
    counts, box = play(narrow, folder, "0-9", "held", away=3)
    assert counts.unsent == {"held": 3}
    assert [frame.index for frame in box.frames] == list(range(3, 10))


def test_the_newest_frames_are_taken_if_too_many_wait(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("nodegraph.live.session._BACKLOG", 0)
    narrow = graph_with(folder, only={"avg": "narrow"})
    counts, box = play(narrow, folder, "0-900", "held", policy="newest")
    assert counts.received == 901
    assert counts.dropped == 901 - len(box.frames) > 0
    assert counts.missing == 0
    assert box.frames[-1].index == 900


def test_a_source_that_does_not_answer_at_once_is_waited_for(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("nodegraph.live.session.RETRY_SECONDS", 0.0)
    narrow = graph_with(folder, only={"avg": "narrow"})
    counts, box = play(narrow, folder, "0-4,!2,0-4", "held")
    assert counts.reconnected == 1
    assert [frame.index for frame in box.frames] == [*range(5), *range(5)]


def test_a_source_that_returns_with_another_rate_ends_the_stream(folder: Path) -> None:
    narrow = graph_with(folder, only={"avg": "narrow"})
    with pytest.raises(NodegraphError, match=r"another stream: header\.rate: 60\.0 and 120\.0"):
        play(narrow, folder, "0-4,~,0-4", "held")


class Meter(Box):
    """Measures the memory that is in use after some frames, and keeps none of them."""

    def write(self, frame: ng.Frame) -> None:
        if frame.index == 300:
            tracemalloc.start()
        if frame.index in (600, 900):
            self.used.append(tracemalloc.get_traced_memory()[0])

    def open(self, header: object) -> None:
        self.used: list[int] = []


def test_memory_does_not_grow_with_the_frames(folder: Path) -> None:
    narrow = graph_with(folder, only={"avg": "narrow"})
    meter = Meter()
    try:
        session_of(narrow, ("take", f"wire:{folder / 'take.npz'}?0-900"), [("held", meter)]).run()
    finally:
        tracemalloc.stop()
    first, second = meter.used
    assert second - first < 16 * 300  # bytes: not even a number is kept of each frame


class Broken(Box):
    """Fails after some frames."""

    def write(self, frame: ng.Frame) -> None:
        if frame.index == 300:
            raise RuntimeError("out of order")


def test_a_failure_in_the_middle_ends_the_stream(folder: Path) -> None:
    narrow = graph_with(folder, only={"avg": "narrow"})
    session = session_of(
        narrow, ("take", f"wire:{folder / 'take.npz'}?0-90000"), [("held", Broken())]
    )
    with pytest.raises(NodegraphError, match="held: failed: RuntimeError: out of order"):
        session.run()
    assert session.counts.computed == 301


def test_numbers_that_begin_again_are_a_new_stream(folder: Path) -> None:
    announced: list[str] = []
    narrow = graph_with(folder, only={"avg": "narrow"})
    counts, box = play(narrow, folder, "0-59,0-59", "held", announce=announced.append)
    assert (counts.repeated, counts.resets, counts.computed) == (15, 1, 105)
    assert box.frames[-1].index == 59
    assert announced[-1].endswith("numbers begin again at 0")


@pytest.mark.parametrize("last", [0, 2, 9])
def test_frames_refused_at_the_end_are_missing_and_counted(folder: Path, last: int) -> None:
    narrow = graph_with(folder, only={"avg": "narrow"})
    counts, box = play(narrow, folder, f"0-{last}", "joined")
    assert dict(counts.refused) == {"late(avg=narrow): its last frame is missing": min(last + 1, 5)}
    assert [frame.index for frame in box.frames] == list(range(last + 1))


def test_an_input_that_feeds_no_frames_cannot_be_a_source(folder: Path) -> None:
    graph = graph_with(folder, only={"avg": "narrow"})
    with pytest.raises(NodegraphError, match="'length' cannot be a stream: no node takes frames"):
        session_of(graph, ("length", "replay:take.npz"))


def test_what_cannot_be_a_stream_is_answered_with_what_can(folder: Path, tmp_path: Path) -> None:
    file = tmp_path / "whole.yaml"
    file.write_text(
        "nodegraph: 1\nnodes:\n  face: {use: synthesize.face}\n"
        "  noise: {use: noise.add, in: face.captured}\n"
    )
    with pytest.raises(NodegraphError, match=r"needs the whole take: noise \(noise\.add\)$"):
        session_of(ng.load(file), ("", "replay:take.npz"))
    edit(file, "noise.add", "score.realism")
    # other scores run on a stream, of an estimate and its truth
    with pytest.raises(NodegraphError, match=r"noise \(score\.realism\)$"):
        session_of(ng.load(file), ("", "replay:take.npz"))
    edit(file, "score.realism", "gaps.cut")
    for source in ("", "face.captured"):
        with pytest.raises(NodegraphError, match=r"gaps\.cut, .* on a stream: gaps\.dropout"):
            session_of(ng.load(file), (source, "replay:take.npz"), [("noise", "file:a.npz")])
    graph = graph_with(folder, only={"avg": "narrow"})
    with pytest.raises(NodegraphError, match=r"for a file 'replay:take\.npz'"):
        session_of(graph, ("take", "take.npz"), [("held", "file:held.npz")])


def test_two_sinks_have_two_addresses(folder: Path, tmp_path: Path) -> None:
    narrow = graph_with(folder, only={"avg": "narrow"})
    source = ("take", f"replay:{folder / 'take.npz'}@0")
    session_of(narrow, source, [("held", f"file:{tmp_path / '{avg}.npz'}")]).run()
    assert (tmp_path / "narrow.npz").is_file()
    text = session_of(narrow, source, [("held", f"file:{tmp_path / 'held.txt'}")])
    with pytest.raises(
        NodegraphError, match=r"held\.txt: .*Trajectories cannot be written as \.txt, "
    ):
        text.run()
    other = f"file:{tmp_path / 'other.npz'}"
    with pytest.raises(NodegraphError, match=r"held.*near.*several sinks"):
        session_of(narrow, source, [("held", other), ("near", other)])


@pytest.mark.parametrize(
    ("sink", "choices", "words"),
    [
        ("beside", {}, ["beside", "it needs shapes, which needs the whole take"]),
        ("spectra", {}, ["spectra cannot run on the stream", "needs the whole take"]),
        ("face", {}, ["face cannot run", "it does not depend on the stream"]),
        ("endless", {}, ["avg.mean", "without bound", "set width: 1"]),
        ("held", {"axis": {}}, []),
    ],
)
def test_what_cannot_run_on_a_stream_is_refused_before_it_begins(
    folder: Path, sink: str, choices: Any, words: list[str]
) -> None:
    if "axis" in choices:
        choices = {"axis": {"take": [str(folder / "take.npz"), str(folder / "graph.yaml")]}}
    graph = graph_with(folder, only={"avg": "narrow"}, **choices)
    if not words:  # the stream stands in place of the axis
        counts, box = play(graph, folder, "0-9", sink)
        assert len(box.frames) == counts.computed == 10
        return
    with pytest.raises(ng.NodegraphError) as caught:
        play(graph, folder, "0-9", sink)
    assert all(word in str(caught.value) for word in words), caught.value


def test_a_check_shows_how_far_behind_each_way_is(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["check", str(folder / "graph.yaml"), "--plugin", str(folder / "nodes.py")]
    assert main([*command, "--live", "100"]) == 2
    assert "18: endless: avg.mean looks ahead without bound" in capsys.readouterr().err
    graph = (folder / "graph.yaml").read_text().replace("{width: null}", "{width: 5}")
    (folder / "bounded.yaml").write_text(graph)
    assert main(["check", str(folder / "bounded.yaml"), *command[2:], "--live", "100"]) == 0
    output = " ".join(capsys.readouterr().out.split())
    assert "avg > held > both > near(avg=wide) 4 40.0 avg(avg=wide) (4)" in output
    assert "computed once: face" in output
    assert "not on the stream: shapes, spectra: needs the whole take" in output


def test_what_is_held_is_computed_once_from_what_the_graph_reads(folder: Path) -> None:
    narrow = graph_with(folder, only={"avg": "narrow"})
    _, box = play(narrow, folder, f"0-{FRAMES - 1}", "beside", hold=["shapes"])
    run = ng.run(narrow, cache=False, until=["beside"])
    assert not difference(recording_of(box), run["beside"].value)


def test_an_interruption_ends_the_stream_and_writes_what_there_is(
    folder: Path, tmp_path: Path
) -> None:
    code = "from nodegraph.cli.main import main; import sys; sys.exit(main())"
    command = [sys.executable, "-c", code, "live", str(folder / "graph.yaml")]
    command += ["--plugin", str(folder / "nodes.py"), "--only", "avg=narrow", "--json"]
    command += ["--source", f"take=replay:{folder / 'take.npz'}@5"]
    command += ["--sink", f"held=file:{tmp_path / 'held.npz'}", "--record", str(tmp_path / "raw")]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    pipes: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(command, **pipes, env=environment, cwd=tmp_path) as process:
        assert process.stderr is not None
        assert "running" in process.stderr.readline()
        process.send_signal(signal.SIGINT)
        output, errors = process.communicate(timeout=30)
    assert process.returncode == 0, errors
    counts = json.loads(output)
    assert counts["computed"] < FRAMES
    assert read_npz(tmp_path / "held.npz").frames == counts["computed"]


def graph_with(folder: Path, **choices: Any) -> Graph:
    return ng.load(folder / "graph.yaml", plugins=[folder / "nodes.py"], **choices)

"""Frames in this package's format, by its sink and by what was written from the description."""

from __future__ import annotations

import json
import struct
import zlib
from threading import Event

import numpy as np
import pytest

from nodegraph import Frame, NodegraphError
from nodegraph_live import nodegraph_sinks, nodegraph_sources
from nodegraph_mocap import HeadMotion, MarkerFrame, Origin, Trajectories, Weights
from tests.live_peers import HOST, free_port, in_thread, received, sending, wave

SOURCE = nodegraph_sources()["udp"]
SINK = nodegraph_sinks()["udp"]
POSITIONS = wave(30, 4)
RECORDING = Trajectories(positions=POSITIONS, markers=("a", "b", "ç", "d"), rate=10)
HEADER = Trajectories(positions=POSITIONS[:0], markers=RECORDING.markers, rate=10)


def payload(number: int) -> MarkerFrame:
    return MarkerFrame(RECORDING.positions[number % 30], RECORDING.origin[number % 30])


def packet(kind: int, content: bytes, *, width: int = 4, stream: int = 0, number: int = 0) -> bytes:
    """Return a packet as the description of the format says."""
    parts = [b"NGL1", struct.pack("<BBHI", kind, width, 0, stream), struct.pack("<Qq", number, -5)]
    check = zlib.crc32(parts[0] + parts[1] + bytes(4) + parts[2] + content)
    return parts[0] + parts[1] + struct.pack("<I", check) + parts[2] + content


@pytest.mark.parametrize("width", [4, 8])
def test_a_recording_arrives_as_it_was_sent(width: int) -> None:
    port = free_port()
    sink = SINK(f"{HOST}:{port}?bytes={width}")

    def send(ended: Event) -> None:
        while not ended.is_set():  # whoever misses a stream's start waits for the next
            sink.open(HEADER)
            for number in range(30):
                sink.write(Frame(number, 10 * number, 1, payload(number)))
                ended.wait(0.001)
            sink.close()

    with in_thread(send):
        header, frames, refused = received(SOURCE(str(port)), 20)
    assert (header.markers, header.rate, header.frames, refused) == (RECORDING.markers, 10, 0, 0)
    first = frames[0].index
    assert [frame.index for frame in frames] == list(range(first, first + 20))
    for frame in frames:
        expected = POSITIONS[frame.index].astype(np.float32 if width == 4 else np.float64)
        np.testing.assert_array_equal(frame.payload.positions, expected)
        missing = frame.payload.origin == Origin.MISSING
        np.testing.assert_array_equal(missing, np.isnan(expected[:, 0]))
        assert frame.captured == 10 * frame.index


def test_a_program_written_from_the_description_is_understood() -> None:
    content = json.dumps({"weights": ["JawOpen", "x"], "rate": 60, "started": 1}).encode()
    stream = zlib.crc32(content)
    frames = [
        packet(1, struct.pack("<2d", 0.5, np.nan), width=8, stream=stream, number=n)
        for n in range(5)
    ]
    port = free_port()
    with sending([packet(0, content, stream=stream), *frames], port):
        header, arrived, refused = received(SOURCE(str(port)), 5)
    assert isinstance(header, Weights)
    assert (header.names, refused) == (("JawOpen", "x"), 0)
    assert [(frame.index, frame.captured) for frame in arrived] == [(n, -5) for n in range(5)]
    np.testing.assert_array_equal(arrived[0].payload, [0.5, np.nan])


def stream_of(started: int) -> list[bytes]:
    """Return the packets of a stream: description, frames 0 and 1, end."""
    content = json.dumps({"markers": [*"abçd"], "rate": 10, "started": started}).encode()
    stream = zlib.crc32(content)
    frames = [packet(1, bytes(48), stream=stream, number=number) for number in range(2)]
    return [packet(0, content, stream=stream), *frames, packet(2, b"", stream=stream)]


def test_a_stream_ends_and_a_sender_that_starts_again_is_noticed() -> None:
    port = free_port()
    source = SOURCE(str(port))
    first, second = stream_of(1), stream_of(2)
    with sending(first[:3], port):
        assert source.open().markers == RECORDING.markers
    packets = source.packets()
    with sending(second[:3], port), pytest.raises(ConnectionResetError, match="started again"):
        numbers = [frame.index for each in packets for frame in source.frames(each, 1, HEADER)]
    source.close()
    with sending(second, port):
        source.open()
        numbers = [
            frame.index for each in source.packets() for frame in source.frames(each, 1, HEADER)
        ]
    assert numbers == [0, 1]
    source.close()


def test_another_sender_at_the_port_ends_nothing_and_is_counted() -> None:
    port = free_port()
    source = SOURCE(str(port))
    own = stream_of(1)
    others = [
        json.dumps(each).encode()
        for each in (
            {"markers": ["other"], "rate": 10},
            {"markers": [*"abçd"], "rate": 20},
            {"weights": [*"abçd"], "rate": 10},
            {},
            "not a description",
        )
    ]
    foreign = [packet(0, each, stream=zlib.crc32(each)) for each in others]
    foreign += [packet(kind, bytes(12), stream=9) for kind in (1, 2)]
    with sending(own[:3], port):
        assert source.open().markers == RECORDING.markers
    arrived: list[int] = []
    refused: set[bytes] = set()
    with sending([*foreign, *own[:3]], port):
        for each in source.packets():
            try:
                arrived += [frame.index for frame in source.frames(each, 1, HEADER)]
            except ValueError:
                refused.add(each)
            if len(arrived) > 10 and len(refused) == 6:
                break
    source.close()
    assert refused == {*foreign[:-1]}  # the end of another stream is nothing
    assert set(arrived) == {0, 1}


@pytest.mark.parametrize(
    "content",
    [
        b"[]",
        b"{}",
        b"\xff",
        b"[" * 60_000,
        b'{"markers": ["a"]}',
        b'{"markers": ["a"], "rate": 1e999}',
        b'{"markers": ["a"], "rate": ' + b"9" * 400 + b"}",
        b'{"markers": [], "rate": 60}',
        b'{"markers": ["a", "a"], "rate": 60}',
        b'{"markers": [1], "rate": 60}',
        b'{"markers": ["a"], "weights": ["a"], "rate": 60}',
    ],
)
def test_a_wrong_description_is_refused(content: bytes) -> None:
    described = packet(0, content, stream=zlib.crc32(content))
    with pytest.raises(ValueError):  # noqa: PT011  # many kinds of damage, one answer
        SOURCE("1").frames(described, 1, HEADER)


def test_frames_of_another_stream_or_size_are_refused() -> None:
    content = json.dumps({"markers": [*"abçd"], "rate": 10}).encode()
    stream = zlib.crc32(content)
    source = SOURCE("1")
    whole = packet(1, bytes(48), stream=stream)
    with pytest.raises(ValueError, match="of which no description has come"):
        source.frames(whole, 1, HEADER)
    assert not list(source.frames(packet(0, content, stream=stream), 1, HEADER))
    assert len(list(source.frames(whole, 1, HEADER))) == 1
    for damaged, message in (
        (packet(1, bytes(44), stream=stream), "44 bytes, not 12 numbers of 4 bytes"),
        (packet(1, bytes(48), width=5, stream=stream), "numbers of 5 bytes is unknown"),
        (packet(1, bytes(48), stream=stream + 1), "of which no description has come"),
        (packet(1, struct.pack("<12f", *[1e30] * 12), stream=stream), "beyond 1e9 mm"),
        (b"NGL2" + whole[4:], "does not begin with NGL1"),
    ):
        with pytest.raises(ValueError, match=message):
            source.frames(damaged, 1, HEADER)


def test_what_cannot_be_sent_is_refused() -> None:
    with pytest.raises(NodegraphError, match="carries recordings and weights, not HeadMotion"):
        SINK(f"{HOST}:1").open(HeadMotion.still(0))
    names = tuple(map(str, range(6000)))
    many = Trajectories(positions=np.empty((0, 6000, 3)), markers=names, rate=60)
    with pytest.raises(NodegraphError, match="6000 markers take 72032 bytes; a packet holds 65507"):
        SINK(f"{HOST}:1").open(many)


@pytest.mark.parametrize("scheme", ["udp", "vmc", "livelink"])
def test_a_sink_at_an_unknown_host_is_refused(scheme: str) -> None:
    sink = nodegraph_sinks()[scheme]("nosuchhost.invalid:9000")
    with pytest.raises(NodegraphError, match=r"no host 'nosuchhost\.invalid'"):
        sink.open(Weights(values=np.empty((0, 1)), names=("JawOpen",), rate=60))
    sink.close()

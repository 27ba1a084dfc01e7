"""Packets of Live Link Face, as two programs that read them describe them; no phone available."""

from __future__ import annotations

import socket
import struct

import numpy as np
import pytest

from nodegraph import Frame, NodegraphError
from nodegraph_live import nodegraph_sinks, nodegraph_sources
from nodegraph_live.livelink import SHAPES
from nodegraph_mocap import Weights
from tests.live_peers import HOST, free_port, received, sending

SOURCE = nodegraph_sources()["livelink"]
SINK = nodegraph_sinks()["livelink"]
DEVICE = "C0FFEE00-1234-5678-9ABC-DEF012345678"
FACE = np.arange(61, dtype=np.float32) / 61


def names(device: str, subject: str) -> bytes:
    """Return the start of a packet: a byte, then names after lengths of four bytes."""
    head = struct.pack(">Bi", 6, len(device)) + device.encode()
    return head + struct.pack(">i", len(subject)) + subject.encode()


def names_after_dollar(device: str, subject: str) -> bytes:
    """Return it as others read it: four bytes from the lowest, and a device that begins with $."""
    head = struct.pack("<I", 6) + f"${device}".encode()
    return head + struct.pack("!i", len(subject)) + subject.encode()


def face(frame: int, rate: int = 60, *, subject: str = "phone", start: object = names) -> bytes:
    assert callable(start)
    time = struct.pack(">ifii", frame, 0.25, rate, 1)
    return bytes(start(DEVICE, subject)) + time + struct.pack(">B61f", 61, *FACE)


@pytest.mark.parametrize("start", [names, names_after_dollar])
def test_weights_have_the_numbers_of_the_timecode(start: object) -> None:
    port = free_port()
    no_face = names(DEVICE, "phone")
    packets = [no_face, face(7, start=start), face(8, start=start), no_face, face(10, start=start)]
    with sending(packets, port):
        header, frames, refused = received(SOURCE(f"{HOST}:{port}"), 3)
    assert isinstance(header, Weights)
    assert (header.names[:2], len(header.names)) == (("EyeBlinkLeft", "EyeLookDownLeft"), 52)
    assert (header.rate, refused) == (60, 0)
    assert [frame.index for frame in frames] in ([7, 8, 10], [8, 10, 7], [10, 7, 8])
    for frame in frames:
        np.testing.assert_array_equal(frame.payload, FACE[:52])
        assert frame.captured == (4 * frame.index + 1) * 1_000_000_000 // 240


def test_parts_of_a_frame_count_where_the_app_sends_more_often_than_its_timecode() -> None:
    header = Weights(values=np.empty((0, 52)), names=SHAPES, rate=60)
    source = SOURCE("11111?rate=60")
    whole = face(7, rate=30)
    time = struct.pack(">ifii", 7, 0.25, 30, 1)
    packets = [whole.replace(time, struct.pack(">ifii", 7, part, 30, 1)) for part in (0.0, 0.5)]
    numbers = [frame.index for each in packets for frame in source.frames(each, 1, header)]
    assert numbers == [14, 15]


def test_the_rate_of_the_address_and_midnight() -> None:
    header = Weights(values=np.empty((0, 52)), names=SHAPES, rate=30)
    source = SOURCE("11111?rate=30")
    day = 24 * 3600 * 60
    numbers = [
        frame.index
        for timecode in (day - 4, day - 2, 0, 2)
        for frame in source.frames(face(timecode), 1, header)
    ]
    assert numbers == [day // 2 - 2, day // 2 - 1, day // 2, day // 2 + 1]


@pytest.mark.parametrize(
    ("packet", "message"),
    [
        (b"\7" + face(1)[1:], "version 7 of Live Link Face is not known, only 6"),
        (face(1)[:-1], "61 values in 243 bytes"),
        (face(1) + b"\0", "61 values in 245 bytes"),
        (face(-1), "is not a time"),
        (face(1, rate=0), "is not a time"),
        (face(1, subject="tablet"), "it is of 'tablet', the stream of 'phone'"),
        (face(1)[:-4] + struct.pack(">f", np.inf), "infinite"),
    ],
)
def test_other_packets_are_refused(packet: bytes, message: str) -> None:
    header = Weights(values=np.empty((0, 52)), names=SHAPES, rate=60)
    source = SOURCE("11111")
    assert list(source.frames(face(0), 1, header))
    with pytest.raises(ValueError, match=message):
        source.frames(packet, 1, header)


def test_weights_are_sent_by_the_names_of_the_app() -> None:
    shapes = ("jawOpen", "EyeBlink_L", "cheekPuff_L", "cheekPuff_R")
    weights = Weights(values=np.empty((0, 4)), names=shapes, rate=29.97)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind((HOST, 0))
        receiver.settimeout(5)
        sink = SINK(f"{HOST}:{receiver.getsockname()[1]}")
        sink.open(weights)
        sink.write(Frame(3, 0, 1, np.array([0.5, 0.75, 1, 0.25])))
        sink.write(Frame(4, 0, 1, np.array([0.5, np.nan, 1, 1])))
        sink.close()
        packet, without_face = receiver.recv(2048), receiver.recv(2048)
    start = len(names("nodegraph", "nodegraph"))
    assert packet[:start] == names("nodegraph", "nodegraph")
    frame, _, numerator, denominator, count, *sent = struct.unpack_from(">ifiiB61f", packet, start)
    assert (frame, count, numerator / denominator) == (3, 61, pytest.approx(29.97))
    assert {place: value for place, value in enumerate(sent) if value} == {
        0: 0.75,
        17: 0.5,
        46: 0.625,
    }
    assert struct.unpack_from(">ifiiB", without_face, start)[4] == 0

    with pytest.raises(NodegraphError, match="grin are not shapes of Live Link Face"):
        SINK("127.0.0.1").open(Weights(values=np.empty((0, 1)), names=("grin",), rate=60))


def test_a_phone_that_sees_no_face_ends_in_a_message() -> None:
    port = free_port()
    with (
        sending([names(DEVICE, "phone")], port),
        pytest.raises(NodegraphError, match=r"no complete Live Link Face packet with a face"),
    ):
        SOURCE(f"{port}?timeout=0.3").open()

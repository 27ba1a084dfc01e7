"""Packets of every protocol: recorded ones decode again, damaged ones are refused or sound."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from threading import Event, Thread
from typing import Any, NamedTuple

import numpy as np
import pytest

from nodegraph import Frame, NodegraphError, Source
from nodegraph_live import nodegraph_sinks, nodegraph_sources
from nodegraph_mocap import HeadMotion, MarkerFrame, Trajectories, Weights
from tests.live_peers import HOST, NatNetServer, QtmServer, free_port, in_thread, wave

SOURCES, SINKS = nodegraph_sources(), nodegraph_sinks()
POSITIONS = wave(8, 3)
RECORDING = Trajectories(positions=POSITIONS, markers=("a", "b", "c"), rate=60)
WEIGHTS = Weights(
    values=np.random.default_rng(3).random((8, 3)),
    names=("JawOpen", "TongueOut", "CheekPuff"),
    rate=60,
)


class Taken(NamedTuple):
    """What was received of a protocol."""

    header: Any
    packets: list[bytes]
    frames: list[Frame]


def sink_to(scheme: str, address: str, value: Trajectories | Weights) -> Callable[[Event], None]:
    def send(ended: Event) -> None:
        sink = SINKS[scheme](address)
        payloads: list[object]
        if isinstance(value, Trajectories):
            payloads = [
                MarkerFrame(*each) for each in zip(value.positions, value.origin, strict=True)
            ]
        else:
            payloads = list(value.values)
        sink.open(value)
        number = 0
        while not ended.wait(0.001):
            sink.write(Frame(number, number, 1 + number, payloads[number % 8]))
            number += 1
        sink.close()

    return send


@contextmanager
def streaming(scheme: str) -> Iterator[Source]:
    """Let the other side of a protocol stream; return a source for it."""
    port = free_port()
    work: Callable[[Event], None]
    if scheme == "qtm":
        qtm = QtmServer(RECORDING.markers, POSITIONS, 60)
        work, address = qtm.serve, f"{HOST}:{qtm.port}"
    elif scheme == "natnet":
        metres = np.nan_to_num(POSITIONS) / 1000
        natnet = NatNetServer({"face": RECORDING.markers}, metres, (3, 1), 60)
        work, address = natnet.serve, f"{HOST}:{natnet.port}"
    elif scheme == "lsl":
        work, address = sink_to("lsl", "packets", RECORDING), "packets"
    else:
        value = RECORDING if scheme == "udp" else WEIGHTS
        work = sink_to(scheme, f"{HOST}:{port}", value)
        address = f"{port}?rate=60" if scheme == "vmc" else str(port)
    with in_thread(work):
        yield SOURCES[scheme](address)


@cache
def taken(scheme: str) -> Taken:
    """Receive some packets of a protocol."""
    with streaming(scheme) as source:
        header = source.open()
        packets: list[bytes] = []
        frames: list[Frame] = []
        for packet in source.packets():
            packets.append(packet)
            frames += source.frames(packet, 9, header)
            if len(frames) == 12:
                break
        source.close()
    return Taken(header, packets, frames)


def unopened(scheme: str) -> Source:
    return SOURCES[scheme](f"{HOST}:5000?rate=60" if scheme == "vmc" else f"{HOST}:5000")


def same(first: Frame, second: Frame) -> bool:
    payloads = first.payload, second.payload
    here, there = (each.positions if isinstance(each, MarkerFrame) else each for each in payloads)
    return first[:3] == second[:3] and np.array_equal(here, there, equal_nan=True)


@pytest.mark.parametrize("scheme", sorted(SOURCES))
def test_a_source_that_was_never_opened_decodes_recorded_packets(scheme: str) -> None:
    header, packets, frames = taken(scheme)
    source = unopened(scheme)
    again = [frame for packet in packets for frame in source.frames(packet, 9, header)]
    assert len(frames) == len(again) == 12
    assert all(map(same, frames, again))


@pytest.mark.filterwarnings("ignore:the weight:UserWarning")
@pytest.mark.parametrize("scheme", sorted(SOURCES))
def test_damaged_packets_are_refused_or_sound(scheme: str) -> None:
    header, packets, _ = taken(scheme)
    source = unopened(scheme)
    for packet in packets:
        list(source.frames(packet, 9, header))
    refused = 0
    for damaged in damage(packets, np.random.default_rng(11)):
        try:
            frames = list(source.frames(damaged, 9, header))
        except ValueError:
            refused += 1
            continue
        for frame in frames:
            check_sound(header, frame)
        # one that is damaged is not a frame where a checksum tells
        assert scheme != "udp" or not frames or damaged in packets
    assert refused > 100


@pytest.mark.parametrize("scheme", sorted(SOURCES))
def test_a_header_of_another_type_is_refused(scheme: str) -> None:
    with pytest.raises(NodegraphError, match=f"^{scheme}:.*: carries .*, not HeadMotion$"):
        list(unopened(scheme).frames(b"", 9, HeadMotion.still(0)))


def test_weights_of_other_names_are_not_those_of_the_app() -> None:
    with pytest.raises(NodegraphError, match="the names are not those of the app"):
        list(unopened("livelink").frames(b"", 9, WEIGHTS))


def damage(packets: list[bytes], random: np.random.Generator) -> Iterator[bytes]:
    for _ in range(300):
        packet = packets[random.integers(len(packets))]
        place = int(random.integers(len(packet)))
        other = bytearray(packet)
        other[place] ^= 1 << random.integers(8)
        yield bytes(other)
        yield packet[:place]
        yield packet + random.bytes(1 + place % 70)
        other[place : place + 4] = b"\xff\xff\xff\x7f"
        yield bytes(other)
        yield packet[:place] + random.bytes(len(packet) - place)
    yield b""
    yield random.bytes(65507)


def check_sound(header: Trajectories | Weights, frame: Frame) -> None:
    assert isinstance(frame.index, int)
    assert isinstance(frame.captured, int)
    if isinstance(header, Trajectories):
        positions, origin, _ = frame.payload
        assert positions.shape == (len(header.markers), 3)
        missing = np.isnan(positions).all(axis=1)
        assert (np.abs(positions[~missing]) <= 1e9).all()
        np.testing.assert_array_equal(origin == 0, missing)
    else:
        assert frame.payload.shape == (len(header.names),)
        assert not np.isinf(frame.payload).any()


@pytest.mark.parametrize("scheme", sorted(SOURCES))
def test_closing_from_another_thread_ends_the_packets(scheme: str) -> None:
    with streaming(scheme) as source:
        source.open()
        arrived = Event()

        def receive() -> None:
            for _ in source.packets():
                arrived.set()

        thread = Thread(target=receive, daemon=True)
        thread.start()
        assert arrived.wait(5)
        source.close()
        thread.join(5)
        assert not thread.is_alive()

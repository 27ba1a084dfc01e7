"""Weights by the Virtual Motion Capture Protocol, with python-osc on the other side."""

from __future__ import annotations

import socket

import numpy as np
import pytest
from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder
from pythonosc.osc_message import OscMessage
from pythonosc.osc_message_builder import OscMessageBuilder
from pythonosc.osc_packet import OscPacket

from nodegraph import Frame, NodegraphError
from nodegraph_live import nodegraph_sinks, nodegraph_sources
from nodegraph_mocap import Weights
from tests.live_peers import HOST, free_port, received, sending

SOURCE = nodegraph_sources()["vmc"]
SINK = nodegraph_sinks()["vmc"]
NAMES = ("JawOpen", "笑い", *(f"shape {number}" for number in range(50)))


def message(address: str, *arguments: str | float) -> OscMessageBuilder:
    builder = OscMessageBuilder(address)
    for argument in arguments:
        builder.add_arg(argument)
    return builder


def values(number: int) -> dict[str, float]:
    return {name: (number + place) % 8 / 8 for place, name in enumerate(NAMES)}


def frame_messages(number: int) -> list[OscMessageBuilder]:
    weights = values(number).items()
    return [
        message("/VMC/Ext/OK", 1),
        message("/VMC/Ext/T", number / 4),
        message("/VMC/Ext/Bone/Pos", "Head", *([0.0] * 7)),
        *(message("/VMC/Ext/Blend/Val", name, value) for name, value in weights),
        message("/VMC/Ext/Blend/Apply"),
    ]


def single(number: int) -> list[bytes]:
    return [builder.build().dgram for builder in frame_messages(number)]


def bundled(number: int) -> list[bytes]:
    bundle = OscBundleBuilder(IMMEDIATELY)
    for builder in frame_messages(number):
        bundle.add_content(builder.build())
    return [bundle.build().dgram]


@pytest.mark.parametrize("packets_of", [single, bundled])
def test_frames_of_python_osc_arrive_whole(packets_of: object) -> None:
    assert callable(packets_of)
    port = free_port()
    packets = [packet for number in range(8) for packet in packets_of(number)]
    with sending(packets, port):
        header, frames, refused = received(SOURCE(f"{port}?rate=60"), 10)
    assert (set(header.names), header.rate, refused) == (set(NAMES), 60, 0)
    assert [frame.index for frame in frames] == list(range(10))
    for frame in frames:
        number = frame.captured * 4 // 1_000_000_000
        expected = values(number)
        np.testing.assert_array_equal(frame.payload, [expected[name] for name in header.names])


def test_python_osc_reads_what_is_sent_in_packets_that_networks_do_not_split() -> None:
    weights = Weights(values=np.empty((0, 52)), names=NAMES, rate=60)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind((HOST, 0))
        receiver.settimeout(5)
        sink = SINK(f"{HOST}:{receiver.getsockname()[1]}")
        sink.open(weights)
        sent = np.linspace(0, 1, 52)
        sent[3] = np.nan
        sink.write(Frame(0, 0, 10**9, sent))
        sink.write(Frame(1, 0, 3 * 10**9, sent))
        sink.close()
        messages: list[OscMessage] = []
        while [each.address for each in messages].count("/VMC/Ext/Blend/Apply") < 2:
            packet = receiver.recv(65536)
            assert len(packet) <= 1472
            messages += [each.message for each in OscPacket(packet).messages]
    half = len(messages) // 2
    assert [each.params for each in messages if each.address == "/VMC/Ext/T"] == [[0.0], [2.0]]
    assert messages[half - 1].address == "/VMC/Ext/Blend/Apply"
    levels = dict(each.params for each in messages[1 : half - 1])
    expected = zip(NAMES, sent.astype(np.float32), strict=True)
    assert levels == {name: value for name, value in expected if name != NAMES[3]}


def test_lost_and_unknown_weights() -> None:
    whole = bundled(1)[0]
    lacking = [*single(2)[:3], *single(2)[4:]]  # without JawOpen
    other = message("/VMC/Ext/Blend/Val", "other", 0.5).build().dgram
    not_finite = message("/VMC/Ext/Blend/Val", "JawOpen", float("nan")).build().dgram
    source = SOURCE("39539?rate=60")
    header = Weights(values=np.empty((0, 52)), names=NAMES, rate=60)
    (first,) = source.frames(whole, 1, header)
    assert not np.isnan(first.payload).any()
    (second,) = [frame for each in lacking for frame in source.frames(each, 1, header)]
    assert np.flatnonzero(np.isnan(second.payload)).tolist() == [0]
    with pytest.warns(UserWarning, match="'other' was not in the first frames"):
        (third,) = [
            frame for each in (other, *single(3)) for frame in source.frames(each, 1, header)
        ]
    assert not np.isnan(third.payload).any()
    with pytest.raises(ValueError, match="a weight of nan"):
        source.frames(not_finite, 1, header)


def test_a_source_that_cannot_be_opened_says_why() -> None:
    with pytest.raises(NodegraphError, match=r"does not send its rate; expected vmc:\[HOST:\]PORT"):
        SOURCE("39539")
    port = free_port()
    with (
        sending([message("/VMC/Ext/OK", 1).build().dgram, b"/garbage"], port),
        pytest.raises(
            NodegraphError, match=r"no complete VMC frame .* in 0\.3 s; \d+ packets could"
        ),
    ):
        SOURCE(f"{port}?rate=60&timeout=0.3").open()

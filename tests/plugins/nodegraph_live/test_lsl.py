"""Streams of Lab Streaming Layer, with pylsl on the other side."""

from __future__ import annotations

from collections.abc import Sequence
from threading import Event

import numpy as np
import pylsl
import pytest

from nodegraph import Frame, NodegraphError
from nodegraph_live import nodegraph_sinks, nodegraph_sources
from nodegraph_mocap import MarkerFrame, Trajectories, Weights
from tests.live_peers import in_thread, received, wave

SOURCE = nodegraph_sources()["lsl"]
SINK = nodegraph_sinks()["lsl"]


def outlet(name: str, channels: Sequence[dict[str, str]], rate: float = 100) -> pylsl.StreamOutlet:
    info = pylsl.StreamInfo(name, "MoCap", len(channels), rate, pylsl.cf_float32, name)
    parent = info.desc().append_child("channels")
    for channel in channels:
        child = parent.append_child("channel")
        for field, value in channel.items():
            child.append_child_value(field, value)
    return pylsl.StreamOutlet(info)


def positions(axes: str, unit: str) -> list[dict[str, str]]:
    """Return channels of two markers as the specification of XDF has them."""
    return [
        {"label": f"{marker}{axis}", "marker": marker, "type": f"Position{axis}", "unit": unit}
        for marker in ("chin", "brow")
        for axis in axes
    ]


@pytest.mark.parametrize(("unit", "scale"), [("meters", 1000), ("centimetres", 10), ("mm", 1)])
def test_markers_arrive_in_millimetres_whatever_the_order_of_axes(unit: str, scale: float) -> None:
    samples = np.arange(6, dtype=np.float32).reshape(2, 3) / 4
    samples[1, 1] = np.nan
    stream = outlet(f"order-{unit}", positions("ZXY", unit))

    def send(ended: Event) -> None:
        while not ended.wait(0.002):
            stream.push_sample(samples.ravel().tolist())

    with in_thread(send):
        header, frames, refused = received(SOURCE(f"order-{unit}"), 3)
    assert (header.markers, header.rate, refused) == (("chin", "brow"), 100, 0)
    expected = samples[:, [1, 2, 0]] * scale
    expected[1] = np.nan  # a marker that lacks a coordinate is missing
    for number, frame in enumerate(frames):
        assert frame.index == number
        np.testing.assert_array_equal(frame.payload.positions, expected)
        assert frame.payload.origin.tolist() == [1, 0]
    assert frames[0].captured < frames[-1].captured


def test_what_is_sent_is_what_others_receive_and_what_comes_back() -> None:
    recording = Trajectories(positions=wave(40, 3), markers=("a", "b ö", "c"), rate=120)
    sink = SINK("face%20cap")
    payloads = [
        MarkerFrame(*each) for each in zip(recording.positions, recording.origin, strict=True)
    ]
    sink.open(recording)
    (description,) = pylsl.resolve_byprop("name", "face cap", timeout=5)
    inlet = pylsl.StreamInlet(description)
    assert inlet.info().get_channel_units() == ["mm"] * 9
    inlet.open_stream()

    def send(ended: Event) -> None:
        number = 0
        while not ended.wait(0.001):
            sink.write(Frame(number, 0, 1, payloads[number % 40]))
            number += 1
        sink.close()

    with in_thread(send):
        sample, _ = inlet.pull_sample(timeout=5)
        header, frames, _ = received(SOURCE("face%20cap"), 5)
    np.testing.assert_array_equal(np.reshape(sample, (3, 3)), recording.positions[0])
    assert (header.markers, header.rate) == (recording.markers, 120)
    start = next(
        number
        for number, payload in enumerate(payloads)
        if np.array_equal(payload.positions, frames[0].payload.positions, equal_nan=True)
    )
    for number, frame in enumerate(frames):
        expected = payloads[(start + number) % 40]
        np.testing.assert_array_equal(frame.payload.positions, expected.positions)


def test_weights_are_named_by_their_labels_and_a_lost_sender_is_found_again() -> None:
    weights = Weights(values=np.empty((0, 2)), names=("JawOpen", "LookX"), rate=60)
    sink = SINK("weights")
    source = SOURCE("weights?timeout=5")
    sink.open(weights)
    for _ in range(2):
        header = source.open()
        assert isinstance(header, Weights)
        assert header.names == weights.names
        packets = source.packets()
        sink.write(Frame(7, 0, 1, np.array([0.25, np.nan])))
        (frame,) = source.frames(next(packets), 5, header)
        np.testing.assert_array_equal(frame.payload, [0.25, np.nan])
        sink.close()
        with pytest.raises(ConnectionResetError, match="'weights' was lost"):
            next(packets)
        source.close()
        sink.open(weights)
    assert frame.index == 1  # counting continues
    sink.close()


@pytest.mark.parametrize(
    ("channels", "rate", "message"),
    [
        (positions("XY", "mm"), 100, "no channel for chin Z, brow Z"),
        (positions("XYZ", "parsec"), 100, "the unit 'parsec'; known are um, mm"),
        (positions("XYZ", "mm"), 0, "no regular rate"),
        ([{"label": "a"}, {"label": "a"}], 100, "'a' is there twice|duplicate|a"),
    ],
)
def test_a_stream_that_is_no_recording_is_refused(
    channels: list[dict[str, str]], rate: float, message: str
) -> None:
    name = f"bad-{len(channels)}-{rate}-{channels[0].get('unit')}"
    stream = outlet(name, channels, rate)
    with pytest.raises(NodegraphError, match=f"lsl:{name}: .*({message})"):
        SOURCE(name).open()
    del stream


def test_a_stream_that_is_not_there_is_named_with_those_that_are() -> None:
    stream = outlet("present", positions("XYZ", "mm"))
    with pytest.raises(
        NodegraphError, match=r"no stream of this name in 0\.5 s; there is .*present"
    ):
        SOURCE("absent?timeout=0.5").open()
    del stream

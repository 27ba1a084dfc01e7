"""Marker sets by NatNet: an emulator on the other side, which the package natnet reads too."""

from __future__ import annotations

import natnet
import numpy as np
import pytest

from nodegraph import NodegraphError
from nodegraph_live import nodegraph_sources
from tests.live_peers import HOST, NatNetServer, free_port, in_thread, received, wave

SOURCE = nodegraph_sources()["natnet"]
SETS = {"face": ("chin", "brow"), "hand": ("brow",), "all": ("face_chin", "face_brow", "hand_brow")}
METRES = np.nan_to_num(wave(12, 3)) / 1000


@pytest.mark.parametrize("protocol", [(3, 0), (4, 0), (4, 1), (4, 2)])
def test_marker_sets_become_a_recording_in_millimetres(protocol: tuple[int, int]) -> None:
    server = NatNetServer(SETS, METRES, protocol, 120)
    with in_thread(server.serve):
        header, frames, refused = received(SOURCE(f"{HOST}:{server.port}"), 12)
    assert (header.markers, header.rate) == (("chin", "face:brow", "hand:brow"), 120)
    assert refused == 0
    first = frames[0].index
    assert [frame.index for frame in frames] == list(range(first, first + 12))
    for frame in frames:
        expected = METRES.astype(np.float32)[frame.index % 12].astype(np.float64) * 1000
        expected[~expected.any(axis=1)] = np.nan
        np.testing.assert_array_equal(frame.payload.positions, expected)
        assert frame.captured == round(frame.index / 120 * 1e9)


def test_an_independent_client_reads_the_same_from_the_emulator() -> None:
    server = NatNetServer(SETS, METRES, (3, 1), 120)
    client = natnet.NatNetClient(HOST, HOST, command_port=server.port, use_multicast=False)
    described: list[natnet.DataDescriptions] = []
    frames: list[natnet.DataFrame] = []
    client.on_data_description_received_event.handlers.append(described.append)
    client.on_data_frame_received_event.handlers.append(frames.append)
    with in_thread(server.serve), client:
        client.request_modeldef()
        while not (described and frames):
            client.update_sync()
    assert {each.name: each.marker_names for each in described[0].marker_sets} == SETS
    number = frames[0].prefix.frame_number
    positions = [each for part in frames[0].marker_sets[:2] for each in part.marker_pos_list]
    np.testing.assert_array_equal(positions, METRES.astype(np.float32)[number % 12])
    assert frames[0].suffix.timestamp == number / 120


def test_what_another_server_says_of_itself_is_refused() -> None:
    server = NatNetServer(SETS, METRES, (4, 1), 120)
    body = NatNetServer({"body": ("hip",)}, METRES[:, :1], (4, 1), 120)
    old = NatNetServer(SETS, METRES, (3, 0), 120)
    with in_thread(server.serve), in_thread(body.serve), in_thread(old.serve):
        source = SOURCE(f"{HOST}:{server.port}")
        header = source.open()
        source.close()
    with pytest.raises(ValueError, match="a description of other markers"):
        source.frames(body.model(), 1, header)
    with pytest.raises(ValueError, match=r"protocol \(3, 0\), after one by \(4, 1\)"):
        source.frames(old.server_info(), 1, header)
    (frame,) = source.frames(server.frame(5), 1, header)
    assert frame.index == 5


@pytest.mark.parametrize(
    ("sets", "protocol", "message"),
    [
        ({}, (4, 1), "has described no marker sets"),
        (SETS, (2, 9), r"protocol 2\.9; protocols from 3\.0 \(Motive 2\.0\) are read"),
        ({"face": ("a", "a")}, (4, 1), "markers: named twice: face:a"),
    ],
)
def test_what_cannot_be_a_recording_is_refused(
    sets: dict[str, tuple[str, ...]], protocol: tuple[int, int], message: str
) -> None:
    server = NatNetServer(sets, METRES, protocol, 120)
    with in_thread(server.serve), pytest.raises(NodegraphError, match=message):
        SOURCE(f"{HOST}:{server.port}?timeout=0.5").open()


def test_a_server_that_does_not_answer_ends_in_a_message() -> None:
    port = free_port()
    with pytest.raises(NodegraphError, match=rf"no server at {HOST}:{port} .* set it to unicast"):
        SOURCE(f"{HOST}:{port}?timeout=0.3").open()

"""Markers of Qualisys Track Manager: an emulator on the other side, which qtm-rt reads too."""

from __future__ import annotations

import asyncio
import socket
from concurrent.futures import ThreadPoolExecutor
from threading import Event

import numpy as np
import pytest
import qtm_rt

from nodegraph import NodegraphError
from nodegraph_live import nodegraph_sources
from tests.live_peers import HOST, QtmServer, free_port, in_thread, received, wave

SOURCE = nodegraph_sources()["qtm"]
NAMES = ("chin", "brow L", "brow R")
POSITIONS = wave(12, 3)


def test_markers_have_the_numbers_names_and_times_of_the_server() -> None:
    server = QtmServer(NAMES, POSITIONS, 240)
    with in_thread(server.serve):
        header, frames, refused = received(SOURCE(f"//{HOST}:{server.port}"), 30)
    assert (header.markers, header.rate, header.frames, refused) == (NAMES, 240, 0, 0)
    assert [frame.index for frame in frames] == list(range(1, 31))
    assert [frame.captured for frame in frames] == [1_000_000 * number for number in range(1, 31)]
    for number, frame in enumerate(frames):
        expected = POSITIONS.astype(np.float32)[number % 12]
        np.testing.assert_array_equal(frame.payload.positions, expected)
        assert frame.payload.origin.tolist() == (~np.isnan(expected[:, 0])).tolist()


def test_the_official_client_reads_the_same_from_the_emulator() -> None:
    server = QtmServer(NAMES, POSITIONS, 240)

    async def read() -> tuple[bytes, list[list[float]]]:
        connection = await qtm_rt.connect(HOST, server.port)
        xml = await connection.get_parameters(["general", "3d"])
        packets: asyncio.Queue[qtm_rt.QRTPacket] = asyncio.Queue()
        await connection.stream_frames(components=["3d"], on_packet=packets.put_nowait)
        _, markers = (await packets.get()).get_3d_markers()
        connection.disconnect()
        return xml, [[marker.x, marker.y, marker.z] for marker in markers]

    # in a thread, as the loop of a browser may be that of this one
    with in_thread(server.serve), ThreadPoolExecutor(1) as thread:
        xml, markers = thread.submit(asyncio.run, read()).result()
    assert b"<Name>brow L</Name>" in xml
    np.testing.assert_array_equal(markers, POSITIONS.astype(np.float32)[0])


def test_a_connection_that_breaks_can_be_opened_again() -> None:
    server = QtmServer(NAMES, POSITIONS, 240)
    server.frames_per_connection = 3
    source = SOURCE(f"{HOST}:{server.port}")
    with in_thread(server.serve):
        for start in (1, 4):
            header = source.open()
            packets = source.packets()
            for number in range(start, start + 3):
                assert [each.index for each in source.frames(next(packets), 1, header)] == [number]
            with pytest.raises(ConnectionError):
                next(packets)
            source.close()


def test_nobody_and_a_stranger_end_in_a_message() -> None:
    port = free_port(socket.SOCK_STREAM)
    with pytest.raises(NodegraphError, match=rf"no stream from {HOST}:{port} .*nobody listens"):
        SOURCE(f"{HOST}:{port}?timeout=0.3").open()

    listener = socket.create_server((HOST, 0))
    port = listener.getsockname()[1]

    def answer(ended: Event) -> None:
        listener.settimeout(0.05)
        with listener:
            while not ended.is_set():
                try:
                    client, _ = listener.accept()
                except TimeoutError:
                    continue
                with client:
                    client.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n")
                    ended.wait(0.1)

    with in_thread(answer), pytest.raises(NodegraphError, match="does not speak QTM's protocol"):
        SOURCE(f"{HOST}:{port}?timeout=0.5").open()

"""The other side of streams, on this machine: servers as QTM and Motive are, and free ports."""

from __future__ import annotations

import socket
import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from threading import Event, Thread
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nodegraph import Frame, Source

HOST = "127.0.0.1"
_POLL = 0.05


def free_port(kind: int = socket.SOCK_DGRAM) -> int:
    """Return a port at which nobody listens."""
    with socket.socket(socket.AF_INET, kind) as probe:
        probe.bind((HOST, 0))
        return int(probe.getsockname()[1])


@contextmanager
def in_thread(work: Callable[[Event], None]) -> Iterator[None]:
    """Do work in another thread, until the event is set at the end of the block."""
    ended = Event()
    thread = Thread(target=work, args=(ended,), daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join(5)
        assert not thread.is_alive()


@contextmanager
def sending(packets: Sequence[bytes], port: int) -> Iterator[None]:
    """Send packets to a port over and over, half a millisecond between them."""

    def send(ended: Event) -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as endpoint:
            while True:
                for packet in packets:
                    endpoint.sendto(packet, (HOST, port))
                    if ended.wait(0.0005):
                        return

    with in_thread(send):
        yield


def received(source: Source, count: int) -> tuple[Any, list[Frame], int]:
    """Return the header, so many frames of a source, and how many packets it has refused."""
    header = source.open()
    frames: list[Frame] = []
    refused = 0
    try:
        for packet in source.packets():
            try:
                frames += source.frames(packet, 1, header)
            except ValueError:
                refused += 1
            if len(frames) >= count:
                break
    finally:
        source.close()
    return header, frames, refused


class QtmServer:
    """Speaks QTM's real-time protocol as far as labelled markers need it.

    Parameters
    ----------
    names
    positions
        (T, M, 3) millimetres, sent over and over with growing numbers.
    rate
        Hz.
    """

    def __init__(self, names: Sequence[str], positions: NDArray[np.generic], rate: float) -> None:
        labels = "".join(f"<Label><Name>{name}</Name></Label>" for name in names)
        self._xml = (
            f"<QTM_Parameters_Ver_1.25><General><Frequency>{rate:g}</Frequency></General>"
            f"<The_3D><Labels>{len(names)}</Labels>{labels}</The_3D></QTM_Parameters_Ver_1.25>"
        )
        self._positions = positions.astype("<f4")
        self._number = 0
        self._listener = socket.create_server((HOST, 0))
        self._listener.settimeout(_POLL)
        self.port = self._listener.getsockname()[1]
        self.frames_per_connection = 1 << 60

    def serve(self, ended: Event) -> None:
        """Serve one client after the other."""
        with self._listener:
            while not ended.is_set():
                try:
                    client, _ = self._listener.accept()
                except TimeoutError:
                    continue
                with client:
                    try:
                        self._talk(client, ended)
                    except OSError:
                        continue

    def _talk(self, client: socket.socket, ended: Event) -> None:
        client.settimeout(_POLL)
        client.sendall(_qtm(1, b"QTM RT Interface connected\0"))
        while not ended.is_set():
            try:
                head = client.recv(8, socket.MSG_WAITALL)
            except TimeoutError:
                continue
            if not head:
                return
            size = struct.unpack("<ii", head)[0] - 8
            command = client.recv(size, socket.MSG_WAITALL).rstrip(b"\0").decode().lower()
            if command.startswith("version"):
                client.sendall(_qtm(1, b"Version set to 1.25\0"))
            elif command.startswith("getparameters"):
                client.sendall(_qtm(2, self._xml.encode() + b"\0"))
            elif command.startswith("streamframes"):
                self._stream(client, ended)
                return
            else:
                client.sendall(_qtm(0, b"Parse error\0"))

    def _stream(self, client: socket.socket, ended: Event) -> None:
        for _ in range(self.frames_per_connection):
            positions = self._positions[self._number % len(self._positions)]
            self._number += 1
            content = struct.pack("<Ihh", len(positions), 0, 0) + positions.tobytes()
            component = struct.pack("<ii", 8 + len(content), 1) + content
            head = struct.pack("<qii", 1000 * self._number, self._number, 1)
            # in two pieces, and with an event between: a client has to put them together
            message = _qtm(6, b"\3") + _qtm(3, head + component)
            client.sendall(message[:20])
            client.sendall(message[20:])
            if ended.wait(0.001):
                return


def _qtm(kind: int, content: bytes) -> bytes:
    return struct.pack("<ii", 8 + len(content), kind) + content


class NatNetServer:
    """Answers and streams as Motive does in unicast.

    Parameters
    ----------
    marker_sets
        Names by marker set.
    positions
        (T, M, 3) metres of all of them, sent over and over with growing numbers.
    protocol
        Major and minor number.
    """

    def __init__(
        self,
        marker_sets: Mapping[str, Sequence[str]],
        positions: NDArray[np.generic],
        protocol: tuple[int, int],
        rate: float,
    ) -> None:
        self._sets = marker_sets
        self._positions = positions.astype("<f4")
        self._protocol = protocol
        self._rate = rate
        self._endpoint = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._endpoint.bind((HOST, 0))
        self._endpoint.settimeout(0.002)
        self.port = self._endpoint.getsockname()[1]

    def serve(self, ended: Event) -> None:
        """Answer requests, and stream to whoever keeps asking."""
        number = 0
        client = None
        with self._endpoint:
            while not ended.is_set():
                try:
                    packet, client = self._endpoint.recvfrom(2048)
                except TimeoutError:
                    if client is not None:
                        number += 1
                        self._endpoint.sendto(self.frame(number), client)
                    continue
                answer = self._answer(packet)
                if answer:
                    self._endpoint.sendto(answer, client)

    def server_info(self) -> bytes:
        """Return what it says of itself."""
        versions = bytes((3, 1, 0, 0, *self._protocol, 0, 0))
        return _natnet(1, b"Emulator".ljust(256, b"\0") + versions + struct.pack("<Q", 10**9))

    def model(self) -> bytes:
        """Return the description of the marker sets, and of a camera if descriptions have sizes."""
        has_sizes = self._protocol >= (4, 1)
        described = []
        for name, markers in self._sets.items():
            content = _zero(name) + struct.pack("<I", len(markers)) + b"".join(map(_zero, markers))
            described.append((0, content))
        described.insert(1 if has_sizes else len(described), (5, _zero("camera") + bytes(28)))
        parts = [
            struct.pack("<I", kind) + (struct.pack("<I", len(each)) if has_sizes else b"") + each
            for kind, each in described
        ]
        return _natnet(5, struct.pack("<I", len(parts)) + b"".join(parts))

    def frame(self, number: int) -> bytes:
        """Return a frame, with a rigid body and a labelled marker in it too."""
        has_sizes = self._protocol >= (4, 1)
        positions = self._positions[number % len(self._positions)]
        sets, start = [], 0
        for name, markers in self._sets.items():
            piece = positions if name == "all" else positions[start : start + len(markers)]
            start += len(markers) if name != "all" else 0
            sets.append(_zero(name) + struct.pack("<I", len(piece)) + piece.tobytes())
        body = struct.pack("<I7ffH", 1, *([0.5] * 7), 0.1, 1)
        label = struct.pack("<I3ffHf", 7, *([0.25] * 3), 0.01, 0, 0.0)
        plate = struct.pack("<III2f", 1, 1, 2, 1.0, 2.0)
        sections = [sets, [bytes(12)], [body], [struct.pack("<II", 3, 1) + body], [], [label]]
        if not has_sizes:
            del sections[4]  # assets came with protocol 4.1
        content = struct.pack("<i", number)
        for section in [*sections, [plate], []]:
            joined = b"".join(section)
            content += struct.pack("<I", len(section))
            content += struct.pack("<I", len(joined)) * has_sizes + joined
        ticks = (number,) * 3
        content += struct.pack("<IIdQQQH", 0, 0, number / self._rate, *ticks, 0)
        return _natnet(7, content + bytes(4))

    def _answer(self, packet: bytes) -> bytes:
        number = struct.unpack_from("<H", packet)[0]
        if number == 0:
            return self.server_info()
        if number == 4:
            return self.model()
        if number == 2 and packet[4:].rstrip(b"\0") == b"FrameRate":
            return _natnet(3, struct.pack("<f", self._rate))
        return b""


def _natnet(number: int, content: bytes) -> bytes:
    return struct.pack("<HH", number, len(content)) + content


def _zero(text: str) -> bytes:
    return text.encode() + b"\0"


def wave(frames: int, markers: int) -> NDArray[np.float64]:
    """Return (T, M, 3) positions within 100, of which some are missing."""
    random = np.random.default_rng(7)
    positions = random.uniform(-100, 100, (frames, markers, 3)).round(3)
    positions[1::3, 1] = np.nan
    return positions

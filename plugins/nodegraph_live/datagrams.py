"""UDP packets: receiving them until the source is closed, and where they are sent."""

from __future__ import annotations

import errno
import socket
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from threading import Event
from time import monotonic
from typing import Any

from nodegraph import Frame, NodegraphError, quoted
from nodegraph_live.address import EVERY_HOST, HOST, Settings

TIMEOUT = 10.0
"""Seconds of silence after which a source is taken for gone, unless the address says so."""
_POLL = 0.2  # seconds: how soon a receiver notes that it was closed
_LARGEST = 65536  # bytes
_BUFFER = 4 << 20  # bytes, of the operating system: packets that wait while we compute
LARGEST_UNSPLIT = 1472
"""Bytes of a packet that Ethernet carries in one piece: its 1500 without the headers."""


def datagram_socket() -> socket.socket:
    """Return a socket for a `DatagramReceiver`."""
    endpoint = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    endpoint.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFER)
    endpoint.settimeout(_POLL)
    return endpoint


def bound_socket(settings: Settings, host: str, port: int) -> socket.socket:
    """Return a socket that receives what is sent to a port.

    Raises
    ------
    NodegraphError
        If the host is not this machine, or the port is in use.
    """
    endpoint = datagram_socket()
    try:
        endpoint.bind((host, port))
    except OSError as error:
        endpoint.close()
        if error.errno == errno.EADDRINUSE:
            raise settings.error(f"another program receives at port {port}") from error
        raise settings.error(
            f"cannot receive at {host}: {error.strerror}; HOST is an address of this machine, or "
            f"{EVERY_HOST} for all that it has"
        ) from error
    return endpoint


def resolved(settings: Settings, host: str, port: int) -> tuple[str, int]:
    """Return the address of a host.

    Raises
    ------
    NodegraphError
        If it is unknown.
    """
    try:
        return socket.gethostbyname(host), port
    except OSError as error:
        raise settings.error(f"no host {quoted(host)}: {error.strerror}") from error


class DatagramReceiver:
    """Receives packets until it is closed.

    Parameters
    ----------
    settings
        ``timeout`` is how many seconds of silence are waited for.
    """

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._closed = Event()
        self._endpoint: socket.socket | None = None

    def close(self) -> None:
        """Stop receiving; another thread may call it."""
        self._closed.set()
        if self._endpoint is not None:
            self._endpoint.close()

    def _receive(self, at_intervals: Callable[[], object] = lambda: None) -> Iterator[bytes]:
        """Yield packets as they arrive.

        Parameters
        ----------
        at_intervals
            Called about five times per second.

        Raises
        ------
        TimeoutError
            If nothing has come for that time.
        """
        assert self._endpoint is not None
        seconds = self._settings["timeout"]
        deadline = monotonic() + seconds
        next_call = monotonic()
        while not self._closed.is_set():
            if monotonic() >= next_call:
                at_intervals()
                next_call = monotonic() + _POLL
            try:
                packet = self._endpoint.recv(_LARGEST)
            except TimeoutError:
                if monotonic() > deadline:
                    raise TimeoutError(f"nothing has come for {seconds:g} s") from None
                continue
            except OSError:
                if self._closed.is_set():
                    return
                raise
            deadline = monotonic() + seconds
            yield packet


class DatagramSource(DatagramReceiver):
    """Receives packets at a port; each protocol says what is in them.

    Parameters
    ----------
    settings
        Has the setting ``timeout``.
    port
        Where the address names none.
    what
        The packets, for messages: ``Live Link packets``.
    """

    def __init__(self, settings: Settings, port: int, what: str) -> None:
        super().__init__(settings)
        self._host, self._port = settings.endpoint(port)
        self._what = what
        self._first: list[bytes] = []

    def describe(self, packet: bytes) -> object:
        """Return the header, or None while more packets are needed for it.

        The packets so far are ``self._first``; it may remove those that `frames` is not to see.

        Raises
        ------
        ValueError
            If the packet is not such a packet.
        """
        raise NotImplementedError

    def frames(self, packet: bytes, arrived: int, header: Any) -> Iterable[Frame]:
        """Return the frames in a packet."""
        raise NotImplementedError

    def open(self) -> Any:
        """Receive packets until the header is known; these are given again by `packets`."""
        self._bind()
        return self._wait_for_header()

    def packets(self) -> Iterator[bytes]:
        """Yield packets as they arrive."""
        yield from self._first
        yield from self._receive()

    def _bind(self) -> None:
        self._closed.clear()
        self._first = []
        self._endpoint = bound_socket(self._settings, self._host, self._port)

    def _wait_for_header(self) -> Any:
        refused = 0
        reason = ""
        deadline = monotonic() + self._settings["timeout"]
        with suppress(TimeoutError):
            for packet in self._receive():
                self._first.append(packet)
                try:
                    header = self.describe(packet)
                except ValueError as error:
                    self._first.pop()
                    refused, reason = refused + 1, str(error)
                else:
                    if header is not None:
                        return header
                if monotonic() > deadline:
                    break
        self.close()
        hint = ""
        if refused:
            hint = f"; {refused} packets could not be decoded, the last because {reason}"
        elif not self._first and self._host == HOST:
            hint = (
                f"; {HOST} receives from this machine only, {EVERY_HOST}:{self._port} from others "
                "as well"
            )
        raise NodegraphError(
            f"{self._settings.address}: no complete {self._what} at {self._host}:{self._port} in "
            f"{self._settings['timeout']:g} s{hint}"
        )


class DatagramSink:
    """Sends packets to a port; whether anybody receives them is not known.

    Parameters
    ----------
    settings
    port
        Where the address names none.
    """

    def __init__(self, settings: Settings, port: int) -> None:
        self._settings = settings
        self._target = settings.endpoint(port)
        self._address: tuple[str, int] | None = None
        self._endpoint: socket.socket | None = None

    def connect(self) -> None:
        """Make the socket.

        Raises
        ------
        NodegraphError
            If the host is unknown.
        """
        if self._address is None:  # once, since names may not be known while a network is away
            self._address = resolved(self._settings, *self._target)
        self._endpoint = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def send(self, packet: bytes) -> None:
        """Send a packet."""
        assert self._endpoint is not None
        assert self._address is not None
        self._endpoint.sendto(packet, self._address)

    def close(self) -> None:
        """Close the socket."""
        if self._endpoint is not None:
            self._endpoint.close()

"""Virtual Motion Capture Protocol: weights of blendshapes by OSC over UDP.

``/VMC/Ext/Blend/Val name value`` says a weight, ``/VMC/Ext/Blend/Apply`` ends a frame, and
``/VMC/Ext/T seconds`` is the sender's time. Other messages, such as bones, are left out.
Source: protocol.vmc.info.

Tested against python-osc as sender and receiver, not against an avatar program.
"""

from __future__ import annotations

import struct
import warnings
from collections.abc import Iterable

import numpy as np

from nodegraph import Frame, NodegraphError, quoted
from nodegraph_live import osc
from nodegraph_live.address import Settings
from nodegraph_live.datagrams import LARGEST_UNSPLIT, TIMEOUT, DatagramSink, DatagramSource
from nodegraph_live.payloads import weights_header, weights_only
from nodegraph_mocap import Weights

PORT = 39539
_VALUE, _APPLY, _TIME = "/VMC/Ext/Blend/Val", "/VMC/Ext/Blend/Apply", "/VMC/Ext/T"
_MOST_SHAPES = 10_000
_FLOAT = struct.Struct(">f")


class VmcSource(DatagramSource):
    """Receives weights: ``vmc:[HOST:]PORT?rate=HZ``.

    The protocol says neither rate nor frame numbers: the address gives the rate, and frames are
    numbered as they come, so that a lost one is not noticed. The names are those of the first
    complete frames, until one has no new name; a weight that comes only later is left out, with a
    warning, and one that does not come is missing from a frame.
    """

    def __init__(self, address: str) -> None:
        form = "vmc:[HOST:]PORT?rate=HZ[&timeout=SECONDS], such as vmc:39539?rate=60"
        settings = Settings("vmc", address, form, {"rate": 0.0, "timeout": TIMEOUT})
        if not settings["rate"]:
            raise settings.error("the protocol does not send its rate")
        super().__init__(settings, PORT, "VMC frame")
        self._rate = settings["rate"]
        self._names: dict[str, None] = {}
        self._count = -1
        """Number of names after the last complete frame; -1 before it."""
        self._places: dict[str, int] = {}
        self._starts: dict[bytes, int] = {}
        """Of messages as they come in every frame: all but the value, which is the last."""
        self._values = np.empty(0)
        self._unknown: set[str] = set()
        self._index = 0
        self._captured = 0

    def open(self) -> Weights:
        """Wait for complete frames, from one ``Apply`` to the next."""
        self._names, self._count = {}, -1
        header: Weights = super().open()
        return header

    def describe(self, packet: bytes) -> Weights | None:
        """Return the names as soon as a frame has no new one."""
        for address, arguments in map(osc.decode, osc.elements(packet)):
            if address == _VALUE and self._count >= 0 and len(self._names) < _MOST_SHAPES:
                self._names[_weight(arguments)[0]] = None
            elif address == _APPLY and 0 < self._count == len(self._names):
                return weights_header(tuple(self._names), self._rate)
            elif address == _APPLY:
                if self._count < 0:
                    self._first.clear()  # the end of a frame of which the start is not known
                self._count = len(self._names)
        return None

    def frames(self, packet: bytes, arrived: int, header: object) -> Iterable[Frame]:
        """Return the frames that a packet completes."""
        header = weights_only(self._settings.address, header)
        if len(self._places) != len(header.names):
            self._places = {name: place for place, name in enumerate(header.names)}
            self._values = np.full(len(header.names), np.nan)
        frames = []
        for element in osc.elements(packet):
            place = self._starts.get(element[:-4])
            if place is not None:
                self._values[place] = _finite(_FLOAT.unpack(element[-4:])[0])
                continue
            address, arguments = osc.decode(element)
            if address == _VALUE:
                name, value = _weight(arguments)
                if name not in self._places:
                    self._warn_of_unknown(name)
                    continue
                self._values[self._places[name]] = value
                if element == osc.message(_VALUE, name, value):
                    self._starts[element[:-4]] = self._places[name]
            elif address == _TIME and arguments and isinstance(arguments[0], float):
                self._captured = _nanoseconds(arguments[0])
            elif address == _APPLY:
                frames.append(Frame(self._index, self._captured, arrived, self._values))
                self._index += 1
                self._values = np.full(len(header.names), np.nan)
        return frames

    def _warn_of_unknown(self, name: str) -> None:
        if name not in self._unknown and len(self._unknown) < _MOST_SHAPES:
            self._unknown.add(name)
            warnings.warn(
                f"the weight {quoted(name)} was not in the first frames and is left out",
                stacklevel=3,
            )


def _weight(arguments: tuple[object, ...]) -> tuple[str, float]:
    match arguments:
        case (str(name), float() | int() as value):
            return name, _finite(float(value))
    raise ValueError(f"{_VALUE} has a name and a number")


def _finite(value: float) -> float:
    if not -np.inf < value < np.inf:
        raise ValueError(f"a weight of {value}")
    return value


def _nanoseconds(seconds: float) -> int:
    if not abs(seconds) < 1e9:
        raise ValueError(f"a time of {seconds} s")
    return int(seconds * 1e9)


class VmcSink(DatagramSink):
    """Sends weights: ``vmc:HOST:PORT``.

    The messages of a frame are in bundles of at most 1472 bytes, which networks do not split. A
    missing weight is not sent, so that the receiver may keep the last.
    """

    def __init__(self, address: str) -> None:
        settings = Settings("vmc", address, "vmc:HOST[:PORT], such as vmc:127.0.0.1:39539", {})
        super().__init__(settings, PORT)

    def open(self, header: object) -> None:
        """Prepare the messages."""
        header = weights_only(self._settings.address, header)
        longest = max(map(len, header.names), default=0)
        if longest > 255:
            raise NodegraphError(
                f"{self._settings.address}: a name of {longest} letters is too long"
            )
        # all but the value, which is the last four bytes
        self._starts = [osc.message(_VALUE, name, 0.0)[:-4] for name in header.names]
        self._apply = osc.message(_APPLY)
        self._start_time = 0
        self.connect()

    def write(self, frame: Frame) -> None:
        """Send a frame."""
        self._start_time = self._start_time or frame.arrived
        time = osc.message(_TIME, (frame.arrived - self._start_time) / 1e9)
        values = frame.payload.astype(">f4")
        numbers = values.tobytes()
        weights = [
            self._starts[place] + numbers[4 * place : 4 * place + 4]
            for place in np.flatnonzero(np.isfinite(values)).tolist()
        ]
        for packet in osc.bundles([time, *weights, self._apply], LARGEST_UNSPLIT):
            self.send(packet)

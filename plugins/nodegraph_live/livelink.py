"""Live Link Face: an app by Epic Games sends 52 weights and 9 angles per frame, over UDP.

A packet of version 6, numbers beginning with their highest byte: version (1 byte); device and
subject, each as a length (4 bytes) and UTF-8; frame of the timecode since midnight (4 bytes), part
of a frame (float32), rate as numerator and denominator (4 bytes each); how many values follow
(1 byte), 61; the values (float32). While no face is seen, the packet ends after the subject or
says that none follow. Programs that read a version of 4 bytes and a device that begins with ``$``
read the same bytes: the length of a device of 36 characters ends in that character.

Tested against an emulator of this package only, not against the app.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterable
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nodegraph import Frame, NodegraphError, listed, quoted
from nodegraph_live.address import Settings
from nodegraph_live.datagrams import TIMEOUT, DatagramSink, DatagramSource
from nodegraph_live.packet_reader import PacketReader
from nodegraph_live.payloads import weights_frame, weights_header, weights_only
from nodegraph_mocap import Weights
from nodegraph_mocap.shape_names import matched, sides_as

if TYPE_CHECKING:
    from numpy.typing import NDArray

PORT = 11111
VERSION = 6
SHAPES = (
    "EyeBlinkLeft", "EyeLookDownLeft", "EyeLookInLeft",
    "EyeLookOutLeft", "EyeLookUpLeft", "EyeSquintLeft",
    "EyeWideLeft", "EyeBlinkRight", "EyeLookDownRight",
    "EyeLookInRight", "EyeLookOutRight", "EyeLookUpRight",
    "EyeSquintRight", "EyeWideRight", "JawForward",
    "JawLeft", "JawRight", "JawOpen",
    "MouthClose", "MouthFunnel", "MouthPucker",
    "MouthLeft", "MouthRight", "MouthSmileLeft",
    "MouthSmileRight", "MouthFrownLeft", "MouthFrownRight",
    "MouthDimpleLeft", "MouthDimpleRight", "MouthStretchLeft",
    "MouthStretchRight", "MouthRollLower", "MouthRollUpper",
    "MouthShrugLower", "MouthShrugUpper", "MouthPressLeft",
    "MouthPressRight", "MouthLowerDownLeft", "MouthLowerDownRight",
    "MouthUpperUpLeft", "MouthUpperUpRight", "BrowDownLeft",
    "BrowDownRight", "BrowInnerUp", "BrowOuterUpLeft",
    "BrowOuterUpRight", "CheekPuff", "CheekSquintLeft",
    "CheekSquintRight", "NoseSneerLeft", "NoseSneerRight",
    "TongueOut",
)  # fmt: skip
"""In the order of the packet; nine angles follow them: yaw, pitch, roll of head and eyes."""
VALUES = len(SHAPES) + 9
_DAY = 24 * 3600
_LONGEST_NAME = 1024  # bytes


class Face(NamedTuple):
    """The content of a packet.

    Attributes
    ----------
    subject : str
    frame : float
        The frame of the timecode, since midnight, with the part of a frame.
    rate : Fraction
        Frames of the timecode per second.
    values : (61,) array of float64, or None
        None where no face was seen.
    """

    subject: str
    frame: float
    rate: Fraction
    values: NDArray[np.float64] | None


def decode(packet: bytes) -> Face:
    """Return what a packet says; one that is damaged or of another version is a ValueError."""
    reader = PacketReader(packet, ">")
    (version,) = reader.numbers("B")
    if version != VERSION:
        raise ValueError(f"version {version} of Live Link Face is not known, only {VERSION}")
    _name(reader)
    subject = _name(reader)
    if not reader.left:
        return Face(subject, 0, Fraction(60), None)
    frame, part, numerator, denominator, count = reader.numbers("ifiiB")
    if frame < 0 or not 0 <= part <= 1 or numerator <= 0 or denominator <= 0:
        raise ValueError(f"frame {frame} + {part:g} at {numerator}/{denominator} Hz is not a time")
    if count not in (0, VALUES) or reader.left != 4 * count:
        raise ValueError(f"{count} values in {reader.left} bytes, not {VALUES}")
    values = weights_frame(reader.floats(count)) if count else None
    return Face(subject, frame + part, Fraction(numerator, denominator), values)


def encode(face: Face, device: str = "nodegraph") -> bytes:
    """Return the packet of a face."""
    values = () if face.values is None else face.values
    parts = [struct.pack(">B", VERSION)]
    for name in (device, face.subject):
        content = name.encode()
        parts += [struct.pack(">i", len(content)), content]
    part, frame = math.modf(face.frame)
    rate = face.rate
    parts.append(struct.pack(">ifii", int(frame), part, rate.numerator, rate.denominator))
    parts += [struct.pack(">B", len(values)), np.asarray(values, dtype=">f4").tobytes()]
    return b"".join(parts)


def _name(reader: PacketReader) -> str:
    (length,) = reader.numbers("i")
    if not 0 <= length <= _LONGEST_NAME:
        raise ValueError(f"a name of {length} bytes")
    return reader.bytes(length).decode()


class LiveLinkSource(DatagramSource):
    """Receives weights from the app: ``livelink:[HOST:]PORT``.

    The rate is the timecode's unless the address says at which the app sends: then frames are
    numbered by it. Frames without a face have no weights: they are missing. Angles are left out.
    """

    def __init__(self, address: str) -> None:
        form = "livelink:[HOST:]PORT[?rate=HZ][&timeout=SECONDS], such as livelink:0.0.0.0:11111"
        settings = Settings("livelink", address, form, {"rate": 0.0, "timeout": TIMEOUT})
        super().__init__(settings, PORT, "Live Link Face packet with a face")
        self._rate = settings["rate"]
        self._subject: str | None = None
        self._last = -1.0
        self._days = 0

    def describe(self, packet: bytes) -> Weights | None:
        """Return the names of the weights and the rate, as soon as a face is seen."""
        face = decode(packet)
        if face.values is None:
            return None
        return weights_header(SHAPES, self._rate or float(face.rate))

    def frames(self, packet: bytes, arrived: int, header: object) -> Iterable[Frame]:
        """Return the weights of a packet, if it has any."""
        header = weights_only(self._settings.address, header)
        if header.names != SHAPES:
            raise NodegraphError(f"{self._settings.address}: the names are not those of the app")
        face = decode(packet)
        if face.values is None:
            return ()
        if self._subject is None:
            self._subject = face.subject
        if face.subject != self._subject:
            raise ValueError(
                f"it is of {quoted(face.subject)}, the stream of {quoted(self._subject)}"
            )
        per_day = round(face.rate * _DAY)
        # a timecode begins again at midnight
        if self._last - face.frame > per_day // 2:
            self._days += 1
        self._last = face.frame
        seconds = (Fraction(face.frame) + self._days * per_day) / face.rate
        number = math.floor(float(seconds) * header.rate + 0.5)
        captured = int(seconds * 1_000_000_000)
        return (Frame(number, captured, arrived, face.values[: len(SHAPES)]),)


class LiveLinkSink(DatagramSink):
    """Sends weights as the app does: ``livelink:HOST:PORT``.

    Weights of which the names are not ARKit shapes are refused; of the two sides of one that has
    none, the mean is sent. Shapes without weights are 0, and so are the angles. A frame in which a
    weight is missing is sent as one without a face.
    """

    def __init__(self, address: str) -> None:
        settings = Settings("livelink", address, "livelink:HOST[:PORT]", {})
        super().__init__(settings, PORT)

    def open(self, header: object) -> None:
        """Find the place of each weight in the packet."""
        header = weights_only(self._settings.address, header)
        self._sides = sides_as(header.names, SHAPES)
        names = self._sides.names
        shape_of = matched(names, SHAPES)
        unknown = [name for name in names if name not in shape_of]
        if unknown:
            raise NodegraphError(
                f"{self._settings.address}: {listed(unknown)} are not shapes of Live Link Face; "
                f"there is {listed(SHAPES)}"
            )
        self._places = [SHAPES.index(shape_of[name]) for name in names]
        self._rate = Fraction(header.rate).limit_denominator(1001)
        self.connect()

    def write(self, frame: Frame) -> None:
        """Send a frame."""
        values = None
        if np.isfinite(frame.payload).all():
            values = np.zeros(VALUES)
            values[self._places] = self._sides.of(frame.payload)
        number = frame.index % max(round(self._rate * _DAY), 1)
        self.send(encode(Face("nodegraph", number, self._rate, values)))

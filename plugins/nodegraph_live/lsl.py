"""Lab Streaming Layer: streams of markers or weights, found by their name.

A stream of markers has channels of the types PositionX, PositionY and PositionZ, or channels with
a unit of length and labels that end with X, Y and Z, as in ``LipTop_X``. The channels of any other
stream are weights, named by their labels. Metadata are those of the XDF specification.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Iterable, Iterator
from threading import Event
from time import monotonic
from urllib.parse import unquote
from xml.etree import ElementTree

import numpy as np
import pylsl
from numpy.typing import NDArray
from pylsl.util import LostError

from nodegraph import Frame, NodegraphError, quoted
from nodegraph_files.units import MILLIMETRES, unit_named
from nodegraph_live.address import Settings
from nodegraph_live.datagrams import TIMEOUT
from nodegraph_live.payloads import (
    count_of_numbers,
    numbers_of,
    payload_of,
    recording_header,
    recording_or_weights,
    weights_header,
)
from nodegraph_mocap import Trajectories, Weights

_POLL = 0.2  # seconds
_LOOK = 0.02
_HEAD = struct.Struct("<Qd")
_POSITION = re.compile(r"position([xyz])", re.IGNORECASE)
_LABEL = re.compile(r"(.+?)[_.: -]?([xyzXYZ])")


class LslSource:
    """Receives a stream: ``lsl:NAME``.

    Each sample becomes a packet: its number (8 bytes), its time (float64), and the channels that
    are used, as float64, lengths in millimetres. The layer loses none, so they are counted.
    """

    def __init__(self, address: str) -> None:
        form = "lsl:NAME[?timeout=SECONDS], NAME of the stream"
        self._settings = Settings("lsl", address, form, {"timeout": TIMEOUT})
        self._name = _name(self._settings)
        self._closed = Event()
        self._index = 0

    def open(self) -> Trajectories | Weights:
        """Find the stream, and read what its channels are."""
        self._closed.clear()
        seconds = self._settings["timeout"]
        try:
            self._inlet = pylsl.StreamInlet(self._resolve(), recover=False)
            described = self._inlet.info(timeout=seconds)
            header, self._places, self._scales = _channels(described.as_xml())
            self._inlet.open_stream(timeout=seconds)
        except RuntimeError as error:  # of pylsl: lost, or too late
            raise ConnectionError(f"the stream {quoted(self._name)} was lost: {error}") from error
        except ValueError as error:
            raise NodegraphError(f"{self._settings.address}: {error}") from error
        return header

    def packets(self) -> Iterator[bytes]:
        """Yield samples."""
        try:
            yield from self._samples()
        except LostError as error:
            raise ConnectionResetError(f"the stream {quoted(self._name)} was lost") from error
        finally:
            self._inlet.close_stream()

    def frames(self, packet: bytes, arrived: int, header: object) -> Iterable[Frame]:
        """Return the frame in a packet."""
        header = recording_or_weights(self._settings.address, header)
        count = count_of_numbers(header)
        if len(packet) != _HEAD.size + 8 * count:
            raise ValueError(f"{len(packet)} bytes, not {count} numbers")
        number, seconds = _HEAD.unpack_from(packet)
        if not abs(seconds) < 1e9:
            raise ValueError(f"a time of {seconds} s")
        numbers = np.frombuffer(packet, np.float64, count, _HEAD.size).copy()
        return (Frame(number, round(seconds * 1e9), arrived, payload_of(header, numbers)),)

    def close(self) -> None:
        """Let `packets` end, which holds the connection."""
        self._closed.set()

    def _samples(self) -> Iterator[bytes]:
        deadline = monotonic() + self._settings["timeout"]
        while not self._closed.is_set():
            sample, seconds = self._inlet.pull_sample(timeout=_POLL)
            if sample is None or seconds is None:
                if monotonic() > deadline:
                    raise TimeoutError(f"no sample for {self._settings['timeout']:g} s")
                continue
            deadline = monotonic() + self._settings["timeout"]
            numbers = np.array(sample, dtype=np.float64)[self._places] * self._scales
            yield _HEAD.pack(self._index, seconds) + numbers.tobytes()
            self._index += 1

    def _resolve(self) -> pylsl.StreamInfo:
        deadline = monotonic() + self._settings["timeout"]
        resolver = pylsl.ContinuousResolver()
        seen: list[pylsl.StreamInfo] = []
        streams: list[pylsl.StreamInfo] = []
        while not streams and monotonic() < deadline and not self._closed.wait(_LOOK):
            seen = resolver.results()
            streams = [stream for stream in seen if stream.name() == self._name]
        if not streams:
            others = ", ".join(sorted({stream.name() for stream in seen}))
            raise NodegraphError(
                f"{self._settings.address}: no stream of this name in "
                f"{self._settings['timeout']:g} s; there is {others or 'none'}"
            )
        if len(streams) > 1:
            hosts = ", ".join(sorted(stream.hostname() for stream in streams))
            raise NodegraphError(
                f"{self._settings.address}: {len(streams)} streams have this name, at {hosts}; "
                "rename one"
            )
        return streams[0]


class LslSink:
    """Offers recordings, in millimetres, or weights as a stream: ``lsl:NAME``."""

    def __init__(self, address: str) -> None:
        settings = Settings("lsl", address, "lsl:NAME, NAME for the stream", {})
        self._name = _name(settings)
        self._address = settings.address
        self._outlet: pylsl.StreamOutlet | None = None

    def open(self, header: object) -> None:
        """Offer the stream."""
        header = recording_or_weights(self._address, header)
        if isinstance(header, Trajectories):
            kind = "MoCap"
            channels = [
                {"label": f"{name}_{axis}", "marker": name, "type": f"Position{axis}", "unit": "mm"}
                for name in header.markers
                for axis in "XYZ"
            ]
        else:
            kind = "Face"
            channels = [{"label": name, "type": "Weight"} for name in header.names]
        info = pylsl.StreamInfo(
            self._name,
            kind,
            len(channels),
            header.rate,
            pylsl.cf_double64,
            f"nodegraph:{self._name}",
        )
        parent = info.desc().append_child("channels")
        for channel in channels:
            child = parent.append_child("channel")
            for name, value in channel.items():
                child.append_child_value(name, value)
        self._outlet = pylsl.StreamOutlet(info)

    def write(self, frame: Frame) -> None:
        """Send a frame."""
        assert self._outlet is not None
        self._outlet.push_sample(numbers_of(frame.payload).tolist())

    def close(self) -> None:
        """End the stream."""
        self._outlet = None


def _name(settings: Settings) -> str:
    if not settings.before:
        raise settings.error("no name")
    return unquote(settings.before)


def _channels(xml: str) -> tuple[Trajectories | Weights, list[int], NDArray[np.float64]]:
    """Return the header, which channels it takes in its order, and their factors to millimetres.

    Raises
    ------
    ValueError
        If the stream has no rate, a marker lacks a coordinate, or its unit is not known.
    """
    root = ElementTree.fromstring(xml)
    rate = float(root.findtext("nominal_srate") or 0)
    if not rate:
        raise ValueError("the stream has no regular rate")
    if root.findtext("channel_format") == "string":
        raise ValueError("the channels are texts, not numbers")
    count = int(root.findtext("channel_count") or 0)
    channels = [
        {field.tag: (field.text or "").strip() for field in channel}
        for channel in root.iterfind("desc/channels/channel")
    ]
    if len(channels) != count:
        raise ValueError(f"the stream describes {len(channels)} of {count} channels")
    coordinates = [_coordinate(channel) for channel in channels]
    if not any(coordinates):
        names = [channel.get("label", "") for channel in channels]
        return weights_header(names, rate), list(range(count)), np.ones(count)
    places = {each: place for place, each in enumerate(coordinates) if each}
    markers = list(dict.fromkeys(marker for marker, _ in places))
    wanted = [(marker, axis) for marker in markers for axis in "xyz"]
    lacking = [
        f"{marker} {axis.upper()}" for marker, axis in wanted if (marker, axis) not in places
    ]
    if lacking:
        raise ValueError(f"the stream has no channel for {', '.join(lacking)}")
    order = [places[each] for each in wanted]
    scales = np.array([_millimetres(channels[place]) for place in order])
    return recording_header(markers, rate), order, scales


def _coordinate(channel: dict[str, str]) -> tuple[str, str] | None:
    """Return marker and axis of a channel that holds a position."""
    by_type = _POSITION.fullmatch(channel.get("type", ""))
    label = _LABEL.fullmatch(channel.get("label", ""))
    if by_type:
        named = channel.get("marker") or (label[1] if label else "")
        if not named:
            raise ValueError(
                f"the channel {quoted(channel.get('label', ''))} does not name its marker"
            )
        return named, by_type[1].lower()
    if label and unit_named(channel.get("unit", "")):
        return label[1], label[2].lower()
    return None


def _millimetres(channel: dict[str, str]) -> float:
    unit = unit_named(channel.get("unit", ""))
    if unit is None:
        raise ValueError(
            f"the channel {quoted(channel.get('label', ''))} has the unit "
            f"{quoted(channel.get('unit', ''))}; known are {', '.join(MILLIMETRES)}, also "
            "written out"
        )
    return MILLIMETRES[unit]

"""The parts of a stream: frames, types whose values become frames, sources and sinks."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol, runtime_checkable

from nodegraph.plugin.hook_types import CheckedRecord

JUMP = 1000
"""A source whose numbers jump by more has restarted; at a smaller jump, frames are missing."""


class Frame(NamedTuple):
    """One frame of a stream.

    Attributes
    ----------
    index : int
        Its number in the stream, as the source counts.
    captured : int
        Nanoseconds on the source's clock; 0 where the source has none.
    arrived : int
        Nanoseconds on this machine's `time.perf_counter_ns`.
    payload : Any
        The content of the frame: an array, or a NamedTuple of arrays, as the value's `Streamable`
        splits it.
    """

    index: int  # type: ignore[assignment]  # the field, not the method of tuples
    captured: int
    arrived: int
    payload: Any


@dataclass(frozen=True)
class Streamable(CheckedRecord):
    """Splits values of one type into frames and joins them again.

    A payload is an array, or a NamedTuple of arrays and None. A payload of which windows are
    taken has the same shapes in every frame.

    Attributes
    ----------
    header : callable
        ``header(value)`` returns the value without frames: what does not change from frame to
        frame. If frames come at a rate, its attribute ``rate`` is in Hz.
    split : callable
        ``split(value)`` returns a payload per frame.
    join : callable
        ``join(header, payloads)`` returns the value; the payloads may be none.
    missing : callable
        ``missing(header)`` returns the payload of a frame that never arrived.
    """

    header: Callable[[Any], object]
    split: Callable[[Any], Sequence[object]]
    join: Callable[[Any, Sequence[Any]], object]
    missing: Callable[[Any], object]


@dataclass(frozen=True)
class LiveView(CheckedRecord):
    """Shows values of one type on the page of a stream, frame by frame.

    Attributes
    ----------
    begin : callable
        ``begin(values)`` returns what a script needs before the first frame, as data for
        `json_script`, or None to be called again with a later frame. ``values`` maps the labels
        of what stands side by side to values of one frame.
    pack : callable
        ``pack(payload)`` returns the bytes of a frame. It is called at most 30 times per second,
        beside the thread that computes the stream, which waits meanwhile.
    module : str
        The module of a script whose ``show(element, begun, labels)`` returns a promise of an
        object that draws into the element: ``draw(frames)`` takes an ArrayBuffer for each label,
        ``close()`` is called when nothing more is drawn there.
    scripts, styles : tuple of str
        JavaScript and CSS that the view needs.
    """

    begin: Callable[[Mapping[str, Any]], object]
    pack: Callable[[Any], bytes]
    module: str
    scripts: tuple[str, ...] = ()
    styles: tuple[str, ...] = ()


@runtime_checkable
class Source(Protocol):
    """A source of frames.

    An error that a user can correct is a `nodegraph.NodegraphError`, a lost connection an
    OSError: the stream is then opened again until it is back.
    """

    def open(self) -> Any:
        """Connect, and return the header: a value without frames.

        It may be called again after `close`.
        """

    def packets(self) -> Iterator[bytes]:
        """Yield what arrives, as it arrives, until the stream ends or `close` is called."""

    def frames(self, packet: bytes, arrived: int, header: object) -> Iterable[Frame]:
        """Return the frames in a packet.

        It needs no connection: recorded packets are decoded by a source that was never opened. A
        packet that cannot be decoded raises ValueError; it is dropped and counted.

        Parameters
        ----------
        packet
        arrived
            Nanoseconds, for `Frame.arrived`.
        header
            The header that `open` returned.
        """

    def close(self) -> None:
        """Disconnect; called from another thread than `packets`, which then ends within 1 s."""


@runtime_checkable
class Sink(Protocol):
    """A sink of frames."""

    def open(self, header: object) -> None:
        """Connect, before the first frame; the header is a value without frames."""

    def write(self, frame: Frame) -> None:
        """Send a frame, without waiting for whoever receives it."""

    def close(self) -> None:
        """Disconnect; also after an interruption."""

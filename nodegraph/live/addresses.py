"""Addresses, the sources and sinks that they name, and sinks at work."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, TypeVar

from nodegraph.errors import NodegraphError, listed, message_of, quoted
from nodegraph.formatting import labels_of, name_at
from nodegraph.live.counts import Counts
from nodegraph.live.plan import LivePlan
from nodegraph.node.ports import Label
from nodegraph.plan import Output
from nodegraph.plugin.formats import current_registry
from nodegraph.plugin.loading import error_text
from nodegraph.plugin.streaming import Frame, Sink, Source

T = TypeVar("T")

RETRY_SECONDS = 1.0
"""Seconds before a lost connection is opened again."""


def source_of(address: str) -> Source:
    """Return the source of an address, ``scheme:rest``.

    Raises
    ------
    NodegraphError
        If no plugin has the scheme, or the address is not valid.
    """
    source: Source = _create_end(address, "sources")
    return source


def sink_of(address: str) -> Sink:
    """Return the sink of an address, ``scheme:rest``.

    Raises
    ------
    NodegraphError
        If no plugin has the scheme, or the address is not valid.
    """
    sink: Sink = _create_end(address, "sinks")
    return sink


def _create_end(address: str, kind: str) -> Any:
    scheme, colon, rest = address.partition(":")
    known = current_registry().hooks.of(kind)
    if not colon:
        file = "replay" if kind == "sources" else "file"
        instead = quoted(f"{file}:{address}")
        raise NodegraphError(f"{quoted(address)}: write SCHEME:..., for a file {instead}")
    if scheme not in known:
        raise NodegraphError(
            f"{quoted(address)}: no {kind[:-1]} {quoted(scheme)}; there is "
            f"{listed(f'{name}:' for name in sorted(known))}"
        )
    return known[scheme](rest.removeprefix("//"))


class Outlet:
    """A sink at work, which is opened again when its connection is lost.

    Parameters
    ----------
    name
        As counts name it.
    output
        Whose frames it takes.
    sink
    address
        The address of the sink, if it was made from one.
    """

    def __init__(self, name: str, output: Output, sink: Sink, address: str = "") -> None:
        self.name = name
        self.output = output
        self.address = address
        self._sink = sink
        self._header: object = None
        self._retry_at: float | None = None
        """When to open it again, if the connection is lost."""

    def open(self, header: object) -> None:
        """Open the sink.

        Raises
        ------
        NodegraphError
            If that is not possible.
        """
        self._header = header
        open_end(self.name, self._sink.open, header)

    def write(self, counts: Counts, frame: Frame) -> None:
        """Write a frame, or count it as unsent."""
        try:
            if self._is_connected():
                self._sink.write(frame)
                counts.written[self.name] += 1
                return
        except OSError:
            self._sink.close()
            self._retry_at = time.monotonic() + RETRY_SECONDS
        except NodegraphError:
            raise
        except Exception as error:
            raise NodegraphError(f"{self.name}: failed: {error_text(error)}") from error
        counts.unsent[self.name] += 1

    def close(self) -> None:
        """Close the sink."""
        self._sink.close()

    def _is_connected(self) -> bool:
        if self._retry_at is None:
            return True
        if time.monotonic() < self._retry_at:
            return False
        try:
            self._sink.open(self._header)
        except NodegraphError as error:  # it could be opened before, so that it may be again
            raise ConnectionError(str(error)) from error
        self._retry_at = None
        return True


def outlets_of(planned: LivePlan, node: str, sink: str | Sink) -> Iterator[Outlet]:
    """Yield the sinks of the frames of a node: one for each of the alternatives side by side.

    Raises
    ------
    NodegraphError
        If the node does not run on the stream, or the address is not valid or not one for each.
    """
    outputs = planned.outputs(node)
    if not isinstance(sink, str):
        if len(outputs) > 1:
            raise NodegraphError(f"{node} has {len(outputs)} streams, and there is one sink")
        yield Outlet(node, next(iter(outputs)), sink)
        return
    steps = planned.plan.steps
    addresses = {output: _filled(sink, steps[output.step].labels) for output in outputs}
    if len(set(addresses.values())) < len(addresses):
        axes = "".join(f"{{{axis}}}" for axis in next(iter(outputs.values())))
        raise NodegraphError(
            f"{node} has {len(addresses)} streams: write {axes} into the address {sink!r}, or "
            f"choose with --only: {listed(map(labels_of, outputs.values()))}"
        )
    for output, address in addresses.items():
        name = f"{name_at(node, outputs[output])}={address}"
        yield Outlet(name, output, sink_of(address), address)


def check_addresses(outlets: Sequence[Outlet]) -> None:
    """Raise `NodegraphError` if two sinks have the same address."""
    addresses = [outlet.address for outlet in outlets if outlet.address]
    for address in addresses:
        if addresses.count(address) > 1:
            names = listed(outlet.name for outlet in outlets if outlet.address == address)
            raise NodegraphError(f"{names}: frames of several sinks go to {address}; name another")


def _filled(address: str, labels: Mapping[str, Label]) -> str:
    for axis, label in labels.items():
        address = address.replace(f"{{{axis}}}", str(label))
    return address


def open_end(name: str, opening: Callable[..., T], *arguments: object) -> T:
    """Call what opens a source or a sink.

    Raises
    ------
    NodegraphError
        If it fails.
    """
    try:
        return opening(*arguments)
    except NodegraphError:
        raise
    except OSError as error:
        raise NodegraphError(f"{name}: cannot be opened: {reason_of(error)}") from error
    except Exception as error:
        raise NodegraphError(f"{name}: failed: {error_text(error)}") from error


def reason_of(error: OSError) -> str:
    """Return why a connection is lost, or cannot be opened."""
    return error.strerror or message_of(error) or type(error).__name__

"""Sources and sinks of live mode: a network protocol each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from importlib import import_module
from typing import Any

from nodegraph import NodegraphError, Sink, Source, hookimpl

_SOURCES = {
    "livelink": "LiveLinkSource",
    "lsl": "LslSource",
    "natnet": "NatNetSource",
    "qtm": "QtmSource",
    "udp": "UdpSource",
    "vmc": "VmcSource",
}
_SINKS = {
    "livelink": "LiveLinkSink",
    "lsl": "LslSink",
    "udp": "UdpSink",
    "vmc": "VmcSink",
}


@hookimpl
def nodegraph_sources() -> Mapping[str, Callable[[str], Source]]:
    """Return what receives frames, by the scheme of the address."""
    return {scheme: partial(_make, scheme, name) for scheme, name in _SOURCES.items()}


@hookimpl
def nodegraph_sinks() -> Mapping[str, Callable[[str], Sink]]:
    """Return what sends frames, by the scheme of the address."""
    return {scheme: partial(_make, scheme, name) for scheme, name in _SINKS.items()}


def _make(scheme: str, name: str, address: str) -> Any:
    """Return a source or a sink; the packages for its protocol are imported when it is used."""
    try:
        module = import_module(f"nodegraph_live.{scheme}")
    except ModuleNotFoundError as error:
        if error.name != "pylsl":
            raise
        raise NodegraphError(
            f"{scheme}: needs a package that is not installed; pip install 'nodegraph[live]'"
        ) from error
    return getattr(module, name)(address)

"""The plugin ``nodegraph``: what this package itself adds through the hooks that plugins use."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from nodegraph.plugin.hooks import hookimpl
from nodegraph.plugin.kind import Kind
from nodegraph.plugin.streaming import Sink, Source


@hookimpl
def nodegraph_executors() -> Mapping[str, Callable[..., object]]:
    """Return the executors of this package."""
    # imported late: most commands run nothing
    from nodegraph.execute.processes import processes
    from nodegraph.execute.threads import serial, threads

    return {"serial": serial, "threads": threads, "processes": processes}


@hookimpl
def nodegraph_sources() -> Mapping[str, Callable[[str], Source]]:
    """Return the source that replays files."""
    from nodegraph.live.files import replay

    return {"replay": replay}


@hookimpl
def nodegraph_sinks() -> Mapping[str, Callable[[str], Sink]]:
    """Return the sink that writes files."""
    from nodegraph.live.files import FileSink

    return {"file": FileSink}


@hookimpl
def nodegraph_kinds() -> Iterable[Kind]:
    """Return how running numbers are split into frames, and how they appear in a report."""
    from nodegraph.live.running_numbers import KIND

    return [KIND]


@hookimpl
def nodegraph_places() -> Mapping[str, Callable[[str], Path]]:
    """Return the resolver of files at web addresses."""
    from nodegraph.remote import SCHEMES, remote_file

    def finder(scheme: str) -> Callable[[str], Path]:
        return lambda name: remote_file(f"{scheme}:{name}")

    return {scheme: finder(scheme) for scheme in SCHEMES}

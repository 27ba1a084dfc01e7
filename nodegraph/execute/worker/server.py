"""The side that makes calls: the program of a worker process."""

from __future__ import annotations

import importlib
import os
import signal
import sys
import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext, suppress
from dataclasses import replace
from functools import partial
from io import BufferedReader, BufferedWriter
from pathlib import Path
from queue import SimpleQueue

from nodegraph.cache_key import code_of
from nodegraph.errors import NodegraphError, UnknownNodeError
from nodegraph.execute.call import Call, Outcome, collecting_warnings, perform
from nodegraph.execute.numeric_threads import SharedContext, one_thread_each
from nodegraph.execute.threads import in_time
from nodegraph.execute.worker.protocol import (
    Environment,
    NodeAddress,
    Request,
    Response,
    ResponseKind,
    read_frames,
    write_frames,
)
from nodegraph.node.decorator import Node, node_of
from nodegraph.plugin.registry import Registry
from nodegraph.state import State
from nodegraph.store import Packer, Unreadable, Unstorable

_lock = threading.RLock()
_finders: dict[bytes, NodeFinder] = {}
_plugin_files: set[str] = set()


class MissingNodeError(NodegraphError):
    """The node of a request is not in this process; the text says what it "has" instead."""


def finder_for(environment: bytes) -> NodeFinder:
    """Return the resolver of nodes for the requests of an environment, created once for each."""
    with _lock:  # threads of one process would import a plugin twice
        finder = _finders.get(environment)
        if finder is None:
            decoded = Environment.decode(environment)
            _forget_plugin_files({Path(path).stem for path, _ in decoded.files})
            finder = _finders[environment] = NodeFinder(decoded)
        return finder


def _forget_plugin_files(names: set[str]) -> None:
    """Have plugin files imported again: earlier ones of the same names may be different."""
    for name in names & _plugin_files:
        sys.modules.pop(name, None)
        _finders.clear()  # their values would be of the classes of the new module
    _plugin_files.update(names)


class NodeFinder:
    """Finds nodes among the installed plugins, and in the plugin files of an environment.

    Attributes
    ----------
    registry : Registry
    packer : Packer
    differences : str
        Versions here that are not those of the environment.
    """

    def __init__(self, environment: Environment) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the run itself warns of plugins that are broken
            self.registry = Registry.installed(environment.plugin_files())
        self._known: dict[bytes, Node] = {}
        # requests may name a node in any module, so values may be of classes of any module
        self.packer = Packer(self.registry.hooks.storages, lambda package: True)
        self.differences = "; ".join(environment.differences(Environment()))
        self._code = code_of(self.registry)

    def find(self, address: bytes) -> Node:
        """Return the node at an address.

        Raises
        ------
        MissingNodeError
            If this process does not have it, or another version of it.
        """
        node = self._known.get(address)
        if node is None:
            with _lock:
                node = self._known[address] = self._find(NodeAddress.decode(address))
        return node

    def _find(self, address: NodeAddress) -> Node:
        try:
            registered = self.registry.find(f"{address.plugin}:{address.node}")
        except UnknownNodeError:
            return self._imported(address)
        if registered.distribution != address.distribution:
            theirs = registered.distribution or "a file"
            ours = address.distribution or "a file"
            raise MissingNodeError(f"has {theirs}, here it is {ours}, for {address.node}")
        if address.code:
            here = self._code.of(registered.node.function)
            names = sorted({*address.code, *here.units})
            other = [name for name in names if address.code.get(name) != here.units.get(name)]
            if other or here.unstable:
                raise MissingNodeError(
                    f"has other code of {other[0] if other else address.node} than here, for "
                    f"{address.node}; install the same version there, and restart its workers"
                )
        return registered.node

    def _imported(self, address: NodeAddress) -> Node:
        """Return a node of no plugin, from the module that defines it."""
        try:
            value: object = importlib.import_module(address.module)
            for part in address.qualname.split("."):
                value = getattr(value, part)
        except (Exception, SystemExit) as error:
            raise MissingNodeError(self._why_missing(address)) from error
        node = node_of(value)
        if node is None or node.name != address.node:
            raise MissingNodeError(self._why_missing(address))
        return node

    def _why_missing(self, address: NodeAddress) -> str:
        plugin = f"plugin {address.plugin!r}"
        for broken in self.registry.broken:
            if broken.name == address.plugin:
                return f"has left out the {plugin}, which defines {address.node}: {broken.reason}"
        distributions = {loaded.name: loaded.distribution for loaded in self.registry.loaded}
        distribution = distributions.get(address.plugin)
        if distribution is None:
            version = f" ({address.distribution})" if address.distribution else ""
            return f"has no {plugin}, which defines {address.node}; install it there{version}"
        versions = f" (it has {distribution}, here it is {address.distribution})"
        return f"has no node {address.node} in its {plugin}{versions if distribution else ''}"


def respond(request: Request, timeout: float | None = None) -> Response:
    """Find the node of a request, call it, and return the response.

    Parameters
    ----------
    request
    timeout
        Seconds that the call may take; one that takes longer continues until this process ends.
    """
    try:
        finder = finder_for(request.environment)
    except Exception as error:  # a plugin file does not import here
        return _failure(ResponseKind.MISSING, f"cannot use a plugin file: {error}")
    return replace(_response(finder, request, timeout), differences=finder.differences)


def _response(finder: NodeFinder, request: Request, timeout: float | None) -> Response:
    try:
        node = finder.find(request.address)
        inputs, settings = finder.packer.unpack(request.head.decode(), request.buffers)
    except MissingNodeError as error:
        return _failure(ResponseKind.MISSING, str(error))
    except Unreadable as error:
        return _failure(ResponseKind.UNSENDABLE, str(error))
    plugin = NodeAddress.decode(request.address).plugin
    call = Call(0, node, plugin, inputs, settings, registry=finder.registry, timeout=timeout)
    with _warnings.entered(), one_thread_each():
        outcome = in_time(perform, call)
    try:
        packed = finder.packer.pack(outcome.values)
    except Unstorable as error:
        return _failure(ResponseKind.UNSENDABLE, str(error))
    if not packed.faithful:
        return _failure(ResponseKind.UNSENDABLE, "only a stand-in of a value can be sent")
    return Response(
        ResponseKind.OUTCOME,
        replace(outcome, values=()),
        head=packed.head.encode(),
        buffers=packed.buffers,
    )


def _failure(kind: ResponseKind, reason: str) -> Response:
    return Response(kind, Outcome(State.FAILED, reason=reason))


_warnings = SharedContext(collecting_warnings)


def main() -> None:
    """Respond on standard output to requests from standard input."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    limit = float(sys.argv[1]) if sys.argv[1:] else None
    limited_memory = nullcontext if limit is None else partial(_limited_memory, limit)
    requests, responses = _pipes()
    reader = _Reader(requests)
    threading.Thread(target=reader.read, daemon=True).start()
    is_ready = False
    with one_thread_each():  # also of libraries that plugins load
        while (request := reader.requests.get()) is not None:
            if not is_ready:
                # plugins are loaded before the time of the first call begins
                with suppress(Exception):  # to be reported in response to the call
                    finder_for(request.environment)
                try:
                    write_frames(responses, [b"ready"])
                except BrokenPipeError:
                    os._exit(1)
                is_ready = True
            with limited_memory():
                response = respond(request)
            frames = response.frames()
            sys.stdout.flush()
            reader.is_busy = False
            try:
                write_frames(responses, frames)
            except BrokenPipeError:  # the run has ended
                os._exit(1)
            del request, response, frames


@contextmanager
def _limited_memory(gigabytes: float) -> Iterator[None]:
    """Limit the memory of this process to what it has now and some gigabytes more."""
    import resource

    _, most = resource.getrlimit(resource.RLIMIT_DATA)
    pages = int(Path("/proc/self/statm").read_text().split()[5])  # of data and stack
    limit = pages * resource.getpagesize() + int(gigabytes * 1e9)
    if most != resource.RLIM_INFINITY:
        limit = min(limit, most)
    resource.setrlimit(resource.RLIMIT_DATA, (limit, most))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, (most, most))


class _Reader:
    """Reads requests in a thread of its own, to notice the end of the run during a call.

    Attributes
    ----------
    requests : SimpleQueue of Request
        None is the last one.
    is_busy : bool
        Whether a request has no response yet.
    """

    def __init__(self, stream: BufferedReader) -> None:
        self._stream = stream
        self.requests: SimpleQueue[Request | None] = SimpleQueue()
        self.is_busy = False

    def read(self) -> None:
        """Read requests until the stream ends; a call that is running then ends with it."""
        while True:
            try:
                request = Request.from_frames(read_frames(self._stream))
            except (EOFError, OSError):
                break
            self.is_busy = True
            self.requests.put(request)
            del request
        if self.is_busy:
            os._exit(1)
        self.requests.put(None)


def _pipes() -> tuple[BufferedReader, BufferedWriter]:
    """Take over standard input and output, so that what a node prints is not a response."""
    requests, responses = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    null = os.open(os.devnull, os.O_RDONLY)
    os.dup2(null, 0)
    os.close(null)
    os.dup2(2, 1)
    return requests, responses

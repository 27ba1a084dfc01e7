"""The side that sends calls to workers, and the processes in which workers run."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import warnings
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from io import BufferedReader, BufferedWriter
from typing import cast

from nodegraph.cache_key import code_of
from nodegraph.execute.call import Call, Outcome
from nodegraph.execute.worker.protocol import (
    Environment,
    Frame,
    NodeAddress,
    Request,
    Response,
    ResponseKind,
    read_frames,
    write_frames,
)
from nodegraph.plugin.registry import Registry
from nodegraph.store import Packer, Unreadable, Unstorable


class CallCodec:
    """Encodes calls as requests, and decodes responses to outcomes.

    Parameters
    ----------
    registry
        The plugins that define the nodes.
    packer
        Packs values.
    shares_files
        Whether workers see the same files as this process.
    is_new
        Whether workers start after this process, and so have the same code.
    """

    def __init__(
        self, registry: Registry, packer: Packer, *, shares_files: bool, is_new: bool
    ) -> None:
        self._packer = packer
        self._registry = registry
        self._shares_files = shares_files
        self._environment = Environment.of(registry).encode()
        self._code = None if is_new else code_of(registry)
        self._addresses: dict[int, bytes | None] = {}
        self._reported: set[str] = set()

    def encode(self, call: Call) -> Request | None:
        """Return a call as a request, or None if it must be made in this process."""
        address = self._address(call)
        if address is None or (self._reads_file(call) and not self._shares_files):
            return None
        try:
            packed = self._packer.pack((dict(call.inputs), dict(call.settings)))
        except Unstorable:
            return None
        if not packed.faithful:
            return None
        return Request(self._environment, address, packed.head.encode(), packed.buffers)

    def decode(self, response: Response, worker: str) -> Outcome | None:
        """Return the outcome in a response, or None if the call must be made in this process.

        Parameters
        ----------
        response
        worker
            Name of the worker in messages.
        """
        if response.kind is ResponseKind.UNSENDABLE:
            return None
        if response.differences and response.differences not in self._reported:
            self._reported.add(response.differences)
            warnings.warn(
                f"{worker} has {response.differences}: results may differ in their last digits",
                stacklevel=2,
            )
        if response.kind is ResponseKind.MISSING:
            return replace(response.outcome, reason=f"{worker} {response.outcome.reason}")
        try:
            values = self._packer.unpack(response.head.decode(), response.buffers)
        except Unreadable:
            return None
        return replace(response.outcome, values=values)

    def _address(self, call: Call) -> bytes | None:
        # by identity: the plan keeps the nodes, and comparing them would read their signatures
        known = id(call.node)
        if known not in self._addresses:
            address = NodeAddress.of(call, self._registry, self._code)
            ports = (*call.node.inputs, *call.node.outputs)
            can_go = address is not None and all(self._packer.travels(port.type) for port in ports)
            self._addresses[known] = address.encode() if address is not None and can_go else None
        return self._addresses[known]

    def _reads_file(self, call: Call) -> bool:
        return any(
            setting.is_file and call.settings.get(name) is not None
            for name, setting in call.node.settings.items()
        )


_PROGRAM = (
    "import json, sys, importlib; "
    "module, sys.path[:] = json.loads(sys.argv.pop(1)); "
    "importlib.import_module(module).main()"
)


def start(
    module: str,
    *arguments: str,
    pipe_output: bool = False,
    folder: str | None = None,
    environment: Mapping[str, str] | None = None,
) -> subprocess.Popen[bytes]:
    """Start ``module.main()`` in another process, which finds modules where this one does.

    Its standard input is a pipe; the process should end when that is closed. Ctrl-C does not reach
    it, because it is not in the foreground of the terminal.

    Parameters
    ----------
    module
    *arguments
        Its ``sys.argv[1:]``.
    pipe_output
        Whether its standard output is a pipe, too.
    folder, environment
        Its working directory and environment variables; by default those of this process.
    """
    return subprocess.Popen(
        [
            sys.executable,
            "-P",
            "-c",
            _PROGRAM,
            json.dumps([module, [os.path.abspath(path) for path in sys.path]]),
            *arguments,
        ],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE if pipe_output else None,
        start_new_session=True,
        cwd=folder,
        env=environment,
    )


def kill(process: subprocess.Popen[bytes]) -> None:
    """End a process that `start` returned, and those that it has started, at once."""
    if process.returncode is not None:
        return  # its number may be another process's by now
    with suppress(ProcessLookupError):
        if sys.platform == "win32":
            process.kill()
        else:
            os.killpg(process.pid, signal.SIGKILL)


class WorkerEndedError(Exception):
    """The worker has ended instead of responding; the text says how.

    Attributes
    ----------
    was_ready : bool
        Whether it was ready for calls before.
    """

    def __init__(self, how: str, *, was_ready: bool = True) -> None:
        super().__init__(how)
        self.was_ready = was_ready


class Worker:
    """A process that makes calls. It starts at once, and is ready when it first responds.

    Parameters
    ----------
    memory
        Gigabytes that a call may take beside its inputs.
    folder, environment
        Its working directory and environment variables; by default those of this process.
    """

    _SECONDS_TO_END = 5.0

    def __init__(
        self,
        memory: float | None = None,
        *,
        folder: str | None = None,
        environment: Mapping[str, str] | None = None,
    ) -> None:
        limit = () if memory is None else (str(memory),)
        self._process = start(
            "nodegraph.execute.worker.server",
            *limit,
            pipe_output=True,
            folder=folder,
            environment=environment,
        )
        self._requests = cast(BufferedWriter, self._process.stdin)
        self._responses = cast(BufferedReader, self._process.stdout)
        self._is_ready = False

    @property
    def is_alive(self) -> bool:
        """Whether it can take a request."""
        return self._process.poll() is None

    def send(self, request: Request, timeout: float | None = None) -> Response:
        """Send a request and wait for the response, up to a time limit in seconds.

        Raises
        ------
        TimeoutError
            If it takes longer; the process has been ended.
        WorkerEndedError
            If the process ends first.
        """
        try:
            # each side reads all of a message before it writes: neither can block the other
            write_frames(self._requests, request.frames())
            if not self._is_ready:
                self._is_ready = bool(read_frames(self._responses))
            return Response.from_frames(self._read(timeout))
        except TimeoutError:
            raise
        except (EOFError, OSError) as error:
            raise WorkerEndedError(self._end(), was_ready=self._is_ready) from error

    def close(self) -> None:
        """End the process, with those that nodes have started and left."""
        self.kill()
        for pipe in (self._requests, self._responses):
            with suppress(OSError):  # for what it has not read
                pipe.close()

    def kill(self) -> None:
        """End the process at once; from any thread."""
        kill(self._process)
        self._process.wait()

    def _read(self, timeout: float | None) -> list[Frame]:
        if timeout is None:
            return read_frames(self._responses)
        is_late = threading.Event()

        def end() -> None:
            is_late.set()
            self.kill()

        timer = threading.Timer(timeout, end)
        timer.start()
        try:
            return read_frames(self._responses)
        except (EOFError, OSError):
            if is_late.is_set():
                self._process.wait()  # its pipes close a little before it has ended
                raise TimeoutError from None
            raise
        finally:
            timer.cancel()

    def _end(self) -> str:
        """Return how the process ended, which has closed its pipes."""
        try:
            status = self._process.wait(self._SECONDS_TO_END)
        except subprocess.TimeoutExpired:
            self.kill()
            return "closed its pipes"
        if status >= 0:
            return f"ended with exit status {status}"
        number = -status
        name = signal.Signals(number).name if number in set(signal.Signals) else str(number)
        hint = " (out of memory?)" if name == "SIGKILL" else ""
        return f"was ended by signal {name}{hint}"

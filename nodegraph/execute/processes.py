"""Several calls at a time, each in a process of its own on this machine."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from multiprocessing.connection import Pipe
from typing import TYPE_CHECKING, Any

from nodegraph.errors import NodegraphError
from nodegraph.execute.call import Call, timed_out
from nodegraph.execute.executor import Calls, HowToRun
from nodegraph.execute.messages import CallCodec, Frame
from nodegraph.execute.outcome import Outcome
from nodegraph.execute.threads import in_time, side_by_side
from nodegraph.execute.worker import receive, send
from nodegraph.state import State

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

_MOST_STARTS = 3
"""Of worker processes for one call, of which each ends before it is ready."""

_PROGRAM = (
    "import json, sys, importlib; "
    "module, sys.path[:] = json.loads(sys.argv.pop(1)); "
    "importlib.import_module(module).main()"
)


def processes(schedule: Calls, how: HowToRun) -> Iterator[tuple[int, Outcome]]:
    """Make several calls at a time, each in a process of its own.

    A call whose node or values cannot be sent to another process is made in this one. If a
    process dies, the step that it computed fails, and another process takes its place.
    """
    pool = _Pool(schedule, how.memory)
    count = how.at_a_time
    try:
        yield from side_by_side(schedule, lambda: count, pool.perform, give_up=pool.kill_all)
    finally:
        pool.close()


class _Pool:
    """Worker processes, as many as there are calls at a time."""

    def __init__(self, schedule: Calls, memory: float | None) -> None:
        self._schedule = schedule
        self._memory = memory
        self._codec = CallCodec(schedule.registry, schedule.packer, local=True)
        self._lock = threading.Lock()
        self._workers: set[Worker] = set()
        self._idle: list[Worker] = []
        self._is_given_up = False

    def perform(self, call: Call) -> Outcome:
        """Make a call in a process, or here if it cannot be sent there."""
        request = self._codec.encode(call)
        if request is None:
            return in_time(self._schedule.perform, call)
        try:
            outcome = self._codec.decode(self._response(request, call.timeout), "a process")
        except TimeoutError:
            return timed_out(call)
        except WorkerEndedError as error:
            outcome = Outcome(State.FAILED, reason=f"the process that computed it {error}")
        del request
        if isinstance(outcome, str):
            return in_time(self._schedule.perform, call)
        return self._schedule.keep(call, outcome)

    def kill_all(self) -> None:
        """End all processes at once, whatever they do."""
        with self._lock:
            self._is_given_up = True
            for worker in self._workers:
                worker.kill()

    def close(self) -> None:
        """End the processes, with those that nodes have started and left."""
        self.kill_all()
        for worker in self._workers:
            worker.close()

    def _response(self, request: Sequence[Frame], timeout: float | None) -> list[Frame]:
        for _ in range(_MOST_STARTS):
            with self._worker() as worker:
                try:
                    return worker.send(request, timeout)
                except WorkerEndedError as error:
                    # a process that ended before it was ready has not begun the call
                    if worker.was_ready or self._is_given_up:
                        raise
                    how = error
        raise NodegraphError(f"a worker process does not start: it {how}") from how

    @contextmanager
    def _worker(self) -> Iterator[Worker]:
        with self._lock:
            if self._is_given_up:
                raise WorkerEndedError("was given up")
            worker = self._idle.pop() if self._idle else Worker(self._memory)
            self._workers.add(worker)
        try:
            yield worker
        finally:
            with self._lock:
                if worker.is_alive:
                    self._idle.append(worker)
                elif not self._is_given_up:
                    self._workers.remove(worker)
                    worker.close()


class WorkerEndedError(Exception):
    """The worker has ended instead of responding; the text says how."""


class Worker:
    """A process that makes calls. It starts at once, and is ready when it first responds.

    Parameters
    ----------
    memory
        Gigabytes that a call may take beside its inputs.
    folder, environment
        Its working directory and environment variables; by default those of this process.

    Attributes
    ----------
    was_ready : bool
        Whether it has loaded the plugins.
    """

    _SECONDS_TO_END = 5.0

    def __init__(
        self,
        memory: float | None = None,
        *,
        folder: str | None = None,
        environment: Mapping[str, str] | None = None,
    ) -> None:
        self._connection, there = Pipe()
        limit = () if memory is None else (str(memory),)
        try:
            self._process = start(
                "nodegraph.execute.worker",
                str(there.fileno()),
                *limit,
                connection=there,
                folder=folder,
                environment=environment,
            )
        finally:
            there.close()
        self.was_ready = False

    @property
    def is_alive(self) -> bool:
        """Whether it can take a request."""
        return self._process.poll() is None

    def send(self, request: Sequence[Frame], timeout: float | None = None) -> list[Frame]:
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
            send(self._connection, request)
            if not self.was_ready:
                self.was_ready = bool(self._connection.recv_bytes())
            is_late = not self._connection.poll(timeout)
            if not is_late:
                return receive(self._connection)
        except (EOFError, OSError) as error:
            raise WorkerEndedError(self._end()) from error
        self.kill()
        raise TimeoutError

    def kill(self) -> None:
        """End the process at once, with those that nodes have started and left; in any thread."""
        kill(self._process)
        self._process.wait()

    def close(self) -> None:
        """End the process, and free what this process holds of it."""
        self.kill()
        self._connection.close()
        if self._process.stdin is not None:
            self._process.stdin.close()

    def _end(self) -> str:
        """Return how the process ended, which has closed its end of the connection."""
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


def start(
    module: str,
    *arguments: str,
    connection: Connection | None = None,
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
    connection
        Open in that process, too, under the same number.
    pipe_output
        Whether its standard output is a pipe, too.
    folder, environment
        Its working directory and environment variables; by default those of this process.
    """
    options: dict[str, Any] = {}
    if connection is not None and sys.platform == "win32":
        os.set_handle_inheritable(connection.fileno(), True)
        handles = {"handle_list": [connection.fileno()]}
        options["startupinfo"] = subprocess.STARTUPINFO(lpAttributeList=handles)
    elif connection is not None:
        options["pass_fds"] = [connection.fileno()]
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
        **options,
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

"""Repeat a call of a run: in this process, with more threads, or in another process."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from tempfile import TemporaryDirectory

from nodegraph.audit.drift import CallResult
from nodegraph.errors import NodegraphError
from nodegraph.execute.call import Call, collecting_warnings, perform
from nodegraph.execute.messages import CallCodec
from nodegraph.execute.numeric_threads import one_thread_each
from nodegraph.execute.outcome import Outcome
from nodegraph.execute.processes import Worker, WorkerEndedError
from nodegraph.execute.results import Run
from nodegraph.execute.resume import StoredSteps
from nodegraph.execute.schedule import Schedule
from nodegraph.state import State
from nodegraph.store import DamagedEntry, Packer, Unstorable

_ENVIRONMENT = re.compile(
    "PATH|HOME|USER|TMP|TEMP|SYSTEMROOT|APPDATA|LOCALAPPDATA|XDG_|LD_|DYLD_|PYTHON|VIRTUAL_ENV|CONDA"
    "|NODEGRAPH_|NUMBA_|OMP_|MKL_|OPENBLAS_|BLIS_|VECLIB_|MPL",
    re.IGNORECASE,
)
"""Beginnings of the names of environment variables that a process needs to start as before."""


@dataclass(frozen=True)
class Case:
    """A call that can be repeated.

    Attributes
    ----------
    call : Call
    digests : mapping of port to str
        A digest of each input before the call; empty where the input cannot be stored.
    """

    call: Call
    digests: Mapping[str, str]


class Repeats:
    """Context manager that repeats calls of a finished run, always with the same inputs.

    Parameters
    ----------
    run
        With a store, from which inputs are loaded. Leaving the context ends the other process.
    """

    def __init__(self, run: Run) -> None:
        assert run.cache is not None, "an audit needs a store"
        self._run = run
        # a second cache, because that of the run treats its own new results as computed
        self._cache = StoredSteps(run.plan, run.cache.store)
        registry = run.plan.graph.registry
        self._codec = CallCodec(registry, run.packer, local=True)
        self._worker: Worker | None = None
        self._open = ExitStack()

    def __enter__(self) -> Repeats:
        self._open.enter_context(collecting_warnings())
        self._open.enter_context(one_thread_each())
        return self

    def __exit__(self, *error: object) -> None:
        if self._worker is not None:
            self._worker.close()
        self._open.close()

    def case(self, index: int) -> Case:
        """Return the call of a step with the inputs that it had in the run.

        Raises
        ------
        NodegraphError
            If the inputs are no longer stored and cannot be computed again.
        """
        without_value = {
            step: outcome
            for step, outcome in self._run.outcomes.items()
            if not outcome.state.has_value
        }
        known = {**self._cache.known, **without_value}
        known.pop(index, None)
        schedule = Schedule(
            self._run.plan,
            cache=self._cache,
            known=known,
            packer=self._run.packer,
            wanted=[index],
        )
        while (call := schedule.next()) is not None:
            if call.step == index:
                return Case(call, _digests(call.inputs, self._run.packer))
            schedule.finish(call.step, perform(call))
        reason = schedule.outcomes[index].reason
        raise NodegraphError(f"its inputs cannot be computed again: {reason}")

    def call_here(self, case: Case, threads: int = 1) -> tuple[Outcome, str]:
        """Repeat a call in this process; return its outcome and which inputs it modified."""
        packer = self._run.packer
        # copies: of these, no node has kept anything
        inputs = {port: packer.copy(value) for port, value in case.call.inputs.items()}
        with numeric_threads(threads):
            outcome = perform(replace(case.call, inputs=inputs))
        after = _digests(inputs, packer)
        return outcome, ", ".join(port for port in inputs if case.digests[port] != after[port])

    def call_in_process(self, case: Case) -> Outcome | str:
        """Repeat a call in another process; return its outcome, or why that is not possible.

        That process has another working directory, time zone and language, and none of the
        variables of the environment that only nodes read.

        Raises
        ------
        WorkerEndedError
            If the call ends the process.
        """
        request = self._codec.encode(case.call)
        if request is None:
            return "the node or its inputs cannot be sent there"
        if self._worker is None or not self._worker.is_alive:
            folder = self._open.enter_context(TemporaryDirectory(prefix="nodegraph-"))
            self._worker = Worker(folder=folder, environment=_other_environment())
        try:
            response = self._worker.send(request)
        except WorkerEndedError:
            self._worker.close()
            self._worker = None
            raise
        return self._codec.decode(response, "a process")

    def result(self, outcome: Outcome) -> CallResult:
        """Return the result of a call for comparisons."""
        return CallResult.of(outcome.values, self._run.packer)

    def stored_result(self, index: int) -> CallResult | None:
        """Return the stored result of a step, if there is one."""
        step, key = self._run.plan.steps[index], self._run.outcomes[index].key
        entry = self._cache.entry(step, key)
        if entry is None or entry.state != State.DONE:
            return None
        try:
            values = self._cache.values(step, entry)
        except DamagedEntry:
            return None
        return replace(CallResult.of(values, self._run.packer), digests=entry.digests)


def _other_environment() -> dict[str, str]:
    """Return the variables by which Python, libraries and the system find their way."""
    kept = {name: value for name, value in os.environ.items() if _ENVIRONMENT.match(name)}
    return {**kept, "TZ": "Pacific/Kiritimati", "LC_ALL": "C"}


@contextmanager
def numeric_threads(count: int) -> Iterator[None]:
    """Set the number of threads that numerical libraries use for calls in this thread."""
    from threadpoolctl import OpenBLASController, threadpool_limits

    # threadpoolctl lets one thread control OpenBLAS: one that an earlier run has left would do
    OpenBLASController.clear_controlling_thread(force=True)
    with threadpool_limits(limits=count), _numba_threads(count):
        yield


@contextmanager
def _numba_threads(count: int) -> Iterator[None]:
    numba = sys.modules.get("numba")
    if numba is None:
        yield
        return
    before = numba.get_num_threads()
    numba.set_num_threads(min(count, numba.config.NUMBA_NUM_THREADS))
    try:
        yield
    finally:
        numba.set_num_threads(before)


def _digests(inputs: Mapping[str, object], packer: Packer) -> dict[str, str]:
    digests: dict[str, str] = {}
    for port, value in inputs.items():
        try:
            digests[port] = packer.digest(value)
        except Unstorable:
            digests[port] = ""
    return digests

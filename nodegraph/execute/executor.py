"""The interface of executors, the work that they get, and the choice of an executor."""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

from nodegraph.errors import NodegraphError, nearest
from nodegraph.execute.call import Call
from nodegraph.execute.outcome import Outcome
from nodegraph.plugin.registry import Registry
from nodegraph.store import Packer


@dataclass(frozen=True)
class HowToRun:
    """The executor of a run and its limits.

    Attributes
    ----------
    executor : str
        By default threads, or processes if a step may only take so long or so much memory: in a
        thread, nothing can end it.
    jobs : int or None
        Calls at a time; by default as many as there are processors.
    scheduler : str
        Address of a cluster, for an executor that uses one.
    timeout : float or None
        Seconds that a step may take; see `nodegraph.executors.Call` for nodes with a shorter limit.
    memory : float or None
        Gigabytes that a step may take beside its inputs, for worker processes of this machine.
    """

    executor: str = ""
    jobs: int | None = None
    scheduler: str = ""
    timeout: float | None = None
    memory: float | None = None

    def __post_init__(self) -> None:
        if not self.executor:
            is_limited = self.timeout is not None or self.memory is not None
            object.__setattr__(self, "executor", "processes" if is_limited else "threads")

    @property
    def at_a_time(self) -> int:
        """Calls at a time, with the default filled in."""
        return (os.cpu_count() or 1) if self.jobs is None else self.jobs


class Calls(Protocol):
    """The calls of a run, as an executor sees them."""

    @property
    def registry(self) -> Registry:
        """The plugins that define the nodes."""
        ...

    @property
    def packer(self) -> Packer:
        """The form in which values are sent to other processes."""
        ...

    def next(self) -> Call | None:
        """Return the next call that can be made now, or None."""
        ...

    def perform(self, call: Call) -> Outcome:
        """Make a call in this process, in any thread, and return its outcome."""
        ...

    def keep(self, call: Call, outcome: Outcome) -> Outcome:
        """Store the outcome of a call that was made elsewhere, in any thread, and return it."""
        ...


class Executor(Protocol):
    """Makes every call that a schedule hands out, and yields each step with its outcome."""

    def __call__(self, schedule: Calls, how: HowToRun) -> Iterator[tuple[int, Outcome]]:
        """Yield (step index, outcome) until the schedule has no call left and none is running.

        Each outcome is settled before the iterator continues, so that the schedule then hands out
        the calls that have become possible. When the iterator is closed or interrupted, it gives
        up all calls that still run.
        """
        ...


def executor_of(how: HowToRun, registry: Registry) -> Executor:
    """Return the executor that is named.

    Raises
    ------
    NodegraphError
        If there is none of that name, a number is out of its range, or it cannot limit memory.
    """
    executors = registry.hooks.of("executors")
    if how.executor not in executors:
        raise NodegraphError(f"no executor {how.executor!r}; {nearest(how.executor, executors)}")
    if how.at_a_time < 1:
        raise NodegraphError(f"jobs must be 1 or more, got {how.jobs}")
    for name, limit in (("timeout", how.timeout), ("memory", how.memory)):
        if limit is not None and not 0 < limit < math.inf:
            raise NodegraphError(f"{name} must be above 0, got {limit:g}")
    if how.memory is not None and (how.executor, sys.platform) != ("processes", "linux"):
        raise NodegraphError(
            f"memory cannot be limited with executor {how.executor!r} on {sys.platform}; "
            "it can with 'processes' on linux"
        )
    executor: Executor = executors[how.executor]
    return executor

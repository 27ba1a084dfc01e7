"""What an executor is, how one is chosen, and where its settings stand."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any, Protocol

from nodegraph.errors import NodegraphError, nearest

if TYPE_CHECKING:
    from nodegraph.execute.call import Outcome
    from nodegraph.execute.schedule import Schedule

_OURS = {
    "serial": "nodegraph.execute.executors.serial:serial",
    "threads": "nodegraph.execute.executors.threads:threads",
    "processes": "nodegraph.execute.executors.processes:processes",
}


@dataclass(frozen=True)
class HowToRun:
    """Where and how steps are computed.

    Attributes
    ----------
    executor : str
    jobs : int or None
        Calls at a time; as many as there are processors by default.
    scheduler : str
        Address of a cluster, for the executor that takes one.
    """

    executor: str = "threads"
    jobs: int | None = None
    scheduler: str = ""

    @property
    def at_a_time(self) -> int:
        """Calls at a time, with the default filled in."""
        return (os.cpu_count() or 1) if self.jobs is None else self.jobs


class Executor(Protocol):
    """Makes every call that a schedule hands out, and yields each step with its outcome.

    ``schedule.next()`` returns the next call that can be made now, or None. An executor makes it
    with ``schedule.perform(call)``, in any thread; or elsewhere, with
    `nodegraph.execute.call.perform`, and then gives the outcome to ``schedule.keep(call,
    outcome)``, which returns it. Whoever iterates gives each outcome to the schedule before
    asking for the next one, so that the executor sees what has become ready.
    """

    def __call__(self, schedule: Schedule, how: HowToRun) -> Iterator[tuple[int, Outcome]]:
        """Yield (step index, outcome) until the schedule has nothing left.

        When the iterator is closed or interrupted, everything that still runs is given up.
        """
        ...


def executor_of(how: HowToRun, others: Mapping[str, Any]) -> Executor:
    """Return the executor of that name, ours or a plugin's.

    Parameters
    ----------
    how
        Which one is asked for, and how many calls at a time.
    others
        Those of plugins, by name; they go before ours.

    Raises
    ------
    NodegraphError
        If there is none, the number of calls is below one, or what it needs is not installed.
    """
    names = {**_OURS, **others}
    if how.executor not in names:
        raise NodegraphError(f"no executor {how.executor!r}; {nearest(how.executor, names)}")
    if how.at_a_time < 1:
        raise NodegraphError(f"jobs must be 1 or more, got {how.jobs}")
    if how.executor in others:
        found: Executor = others[how.executor]
        return found
    module, _, name = _OURS[how.executor].partition(":")
    ours: Executor = getattr(import_module(module), name)
    return ours

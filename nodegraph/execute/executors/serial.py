"""One call after the other, in this thread."""

from __future__ import annotations

from collections.abc import Iterator

from nodegraph.execute.call import Outcome
from nodegraph.execute.executors.base import HowToRun, Schedule


def serial(schedule: Schedule, how: HowToRun) -> Iterator[tuple[int, Outcome]]:
    """Make one call after the other, in this thread."""
    while (call := schedule.next()) is not None:
        yield call.step, schedule.perform(call)

"""One call after the other, here."""

from __future__ import annotations

from collections.abc import Iterator

from nodegraph.execute.call import Outcome
from nodegraph.execute.executors.base import HowToRun
from nodegraph.execute.schedule import Schedule


def serial(schedule: Schedule, how: HowToRun) -> Iterator[tuple[int, Outcome]]:
    """Make one call after the other, here."""
    while (call := schedule.next()) is not None:
        yield call.step, schedule.perform(call)

"""Running a plan: calls, executors, the schedule between them, events and results."""

from nodegraph.execute.events import Event, EventKind, Listener
from nodegraph.execute.executor import Executor, HowToRun, executor_of
from nodegraph.execute.results import NotStored, Run, Values
from nodegraph.execute.resume import StoredSteps, open_store
from nodegraph.execute.run import execute
from nodegraph.execute.settings import RunSettings

__all__ = [
    "Event",
    "EventKind",
    "Executor",
    "HowToRun",
    "Listener",
    "NotStored",
    "Run",
    "RunSettings",
    "StoredSteps",
    "Values",
    "execute",
    "executor_of",
    "open_store",
]

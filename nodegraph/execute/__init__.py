"""Running a plan: calls, executors, the schedule between them, events and results."""

from nodegraph.execute.events import Event, EventKind, Listener
from nodegraph.execute.executor import Executor, HowToRun, executor_of
from nodegraph.execute.results import Run, Values
from nodegraph.execute.resume import StoredSteps, open_store
from nodegraph.execute.run import execute

__all__ = [
    "Event",
    "EventKind",
    "Executor",
    "HowToRun",
    "Listener",
    "Run",
    "StoredSteps",
    "Values",
    "execute",
    "executor_of",
    "open_store",
]

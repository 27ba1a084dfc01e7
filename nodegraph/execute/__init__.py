"""Running a plan: calls, executors, the schedule between them, events and results."""

from nodegraph.execute.events import Event, EventKind, Listener
from nodegraph.execute.executor import Executor, HowToRun, executor_of
from nodegraph.execute.results import Run, Values
from nodegraph.execute.run import execute
from nodegraph.execute.step_cache import StepCache, open_store

__all__ = [
    "Event",
    "EventKind",
    "Executor",
    "HowToRun",
    "Listener",
    "Run",
    "StepCache",
    "Values",
    "execute",
    "executor_of",
    "open_store",
]

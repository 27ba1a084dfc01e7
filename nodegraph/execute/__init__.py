"""Running a plan: calls, executors, the schedule between them, events and results."""

from nodegraph.execute.events import Event, Listener
from nodegraph.execute.executors import Executor, HowToRun, executor_of
from nodegraph.execute.recall import Recall, open_store
from nodegraph.execute.results import Run
from nodegraph.execute.run import execute
from nodegraph.execute.values import Values

__all__ = [
    "Event",
    "Executor",
    "HowToRun",
    "Listener",
    "Recall",
    "Run",
    "Values",
    "execute",
    "executor_of",
    "open_store",
]

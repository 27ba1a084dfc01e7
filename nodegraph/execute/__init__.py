"""Running a plan: calls, executors, the schedule between them, events and results."""

from nodegraph.execute.events import Event, Listener
from nodegraph.execute.results import Run, Values
from nodegraph.execute.run import HowToRun, execute

__all__ = ["Event", "HowToRun", "Listener", "Run", "Values", "execute"]

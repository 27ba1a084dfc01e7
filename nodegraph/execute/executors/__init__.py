"""Ways to compute steps: one after the other, in threads, in processes; plugins add others."""

from nodegraph.execute.executors.base import Executor, HowToRun, Schedule, executor_of

__all__ = ["Executor", "HowToRun", "Schedule", "executor_of"]

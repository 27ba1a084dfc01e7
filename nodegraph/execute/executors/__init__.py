"""Ways to compute steps: here one after the other, in threads, in processes, on a cluster."""

from nodegraph.execute.executors.base import Executor, HowToRun, executor_of

__all__ = ["Executor", "HowToRun", "executor_of"]

"""How long a run will still take, from how long steps of each method took."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping

from nodegraph.plan import Gathered, Step

_OVERHEAD = 0.002
"""Seconds that a step takes beside its function: its key, its inputs, storing its result."""


class RemainingTime:
    """Weighs the steps that are left by what steps of their node and method took.

    Parameters
    ----------
    steps
        Those that are to be computed.
    seconds
        What a step took in earlier runs, as `means` returns it.
    """

    def __init__(self, steps: Iterable[Step], seconds: Mapping[str, float]) -> None:
        self._earlier = seconds
        self._left: Counter[str] = Counter()
        self._gathers: dict[str, bool] = {}
        for step in steps:
            name = _kind(step)
            self._left[name] += 1
            if name not in self._gathers:
                inputs = step.inputs.values()
                self._gathers[name] = any(isinstance(source, Gathered) for source in inputs)
        self._ended: Counter[str] = Counter()
        self._seconds: dict[str, float] = defaultdict(float)

    def add(self, step: Step, seconds: float) -> None:
        """Note that a step was computed."""
        name = _kind(step)
        self._ended[name] += 1
        self._seconds[name] += seconds
        self._left[name] -= 1

    def drop(self, step: Step) -> None:
        """Note that a step need not be computed any more."""
        self._left[_kind(step)] -= 1

    def estimate(self, elapsed: float) -> float | None:
        """Return the seconds to go; None before the first step has ended.

        Parameters
        ----------
        elapsed
            Seconds since the first step was begun. The steps that ended in them say how fast
            this is, whatever runs at the same time.
        """
        means = self.means()
        if not means:
            return None
        # the first call of a method also imports and compiles what it needs
        repeated = {name: mean for name, mean in means.items() if self._ended[name] > 1}
        known = {**means, **self._earlier, **repeated}
        ended = self._ended.total()
        spent = sum(self._seconds.values())
        # what gathers reads what many steps gave, and is as slow as the slowest rather than typical
        unknown = {True: max(means.values()), False: spent / ended}
        left = sum(
            count * (known.get(name, unknown[self._gathers.get(name, False)]) + _OVERHEAD)
            for name, count in self._left.items()
            if count > 0
        )
        return elapsed * left / (spent + ended * _OVERHEAD)

    def means(self) -> dict[str, float]:
        """Return the mean seconds of a step by node and method."""
        return {name: self._seconds[name] / count for name, count in self._ended.items()}


def _kind(step: Step) -> str:
    """Return the kind of a step, whose steps take about as long: a method at a place of a graph."""
    return f"{step.node} {step.method.node.name}"

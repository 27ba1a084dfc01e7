"""How long a run will still take, from how long steps of each method took."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping
from statistics import median

from nodegraph.plan import Step

_OVERHEAD = 0.002
"""Seconds that a step takes beside its function: its key, its inputs, storing its result."""


class Remaining:
    """Weighs the steps that are left by the median time of their method.

    Parameters
    ----------
    steps
        Those that are to be computed.
    seconds
        Medians of earlier runs by method, for methods of which nothing has ended yet.
    """

    def __init__(self, steps: Iterable[Step], seconds: Mapping[str, float]) -> None:
        self._left = Counter(step.method.node.name for step in steps)
        self._earlier = seconds
        self._times: dict[str, list[float]] = defaultdict(list)
        self._spent = 0.0

    def add(self, step: Step, seconds: float) -> None:
        """Note that a step was computed."""
        self._times[step.method.node.name].append(seconds)
        self._spent += seconds + _OVERHEAD
        self.drop(step)

    def drop(self, step: Step) -> None:
        """Note that a step need not be computed any more."""
        self._left[step.method.node.name] -= 1

    def estimate(self, elapsed: float) -> float | None:
        """Return the seconds to go; None before the first step has ended.

        Parameters
        ----------
        elapsed
            Seconds since the first step was begun. The steps that ended in them say how fast
            this is, whatever runs at the same time.
        """
        if not self._spent:
            return None
        known = {**self._earlier, **self.medians()}
        computed = [time for times in self._times.values() for time in times]
        typical = sum(computed) / len(computed)
        left = sum(
            count * (known.get(name, typical) + _OVERHEAD)
            for name, count in self._left.items()
            if count > 0
        )
        return elapsed * left / self._spent

    def medians(self) -> dict[str, float]:
        """Return the median seconds of a step by method."""
        return {name: median(times) for name, times in self._times.items()}

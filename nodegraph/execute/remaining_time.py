"""An estimate of the time that a run will still take, from the times of each method's steps."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping
from statistics import fmean, median_low

from nodegraph.plan import Step

_OVERHEAD = 0.002
"""Seconds that a step takes beside its function: its key, its inputs, storing its result."""


class RemainingTime:
    """Weighs the steps that are left by what steps of their node and method took.

    Parameters
    ----------
    steps
        Those that are to be computed.
    seconds
        What a step took in earlier runs, as `typical` returns it.
    """

    def __init__(self, steps: Iterable[Step], seconds: Mapping[str, float]) -> None:
        self._earlier = seconds
        self._to_compute = list(steps)
        self._settled: list[tuple[Step, float | None]] = []
        self._left: Counter[str] = Counter()
        self._took: defaultdict[str, list[float]] = defaultdict(list)

    def add(self, step: Step, seconds: float) -> None:
        """Note that a step was computed."""
        self._settled.append((step, seconds))

    def drop(self, step: Step) -> None:
        """Note that a step need not be computed any more."""
        self._settled.append((step, None))

    def estimate(self, elapsed: float) -> float | None:
        """Return the seconds to go; None before a method was called twice.

        The first call of a method also imports and compiles what it needs, and calls at the same
        time may wait for that: so medians count.

        Parameters
        ----------
        elapsed
            Seconds since the first step was begun. The steps that ended in them say how fast
            this is, whatever runs at the same time.
        """
        known = {**self._earlier, **self.typical()}
        if all(len(seconds) < 2 for seconds in self._took.values()):
            return None
        usual = fmean(known.values())
        left = sum(
            count * (known.get(name, usual) + _OVERHEAD) for name, count in self._left.items()
        )
        ended = [seconds + _OVERHEAD for each in self._took.values() for seconds in each]
        return elapsed * left / sum(ended)

    def typical(self) -> dict[str, float]:
        """Return the seconds of a step by node and method."""
        self._count()
        return {name: median_low(seconds) for name, seconds in self._took.items()}

    def _count(self) -> None:
        """Count what was noted, which most runs are too short to be asked for."""
        self._left.update(map(_kind, self._to_compute))
        for step, seconds in self._settled:
            name = _kind(step)
            self._left[name] -= 1
            if seconds is not None:
                self._took[name].append(seconds)
        self._to_compute.clear()
        self._settled.clear()


def _kind(step: Step) -> str:
    """Return the kind of a step, whose steps take about as long: a method at a place of a graph."""
    return f"{step.node} {step.method.node.name}"

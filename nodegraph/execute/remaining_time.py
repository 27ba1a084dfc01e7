"""An estimate of the time that a run will still take, from the times of each method's steps."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterable, Mapping
from statistics import fmean, median_low

from nodegraph.plan import Gathered, Step

_OVERHEAD = 0.002
"""Seconds that a step takes beside its function: its key, its inputs, storing its result."""
_LATEST = 99
"""Steps of each kind whose seconds are kept."""


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
        self._gathers: dict[str, bool] = {}
        self._first: dict[str, float] = {}
        self._latest: dict[str, deque[float]] = {}
        self._ended, self._spent = 0, 0.0

    def add(self, step: Step, seconds: float) -> None:
        """Note that a step was computed."""
        self._settled.append((step, seconds))

    def drop(self, step: Step) -> None:
        """Note that a step need not be computed any more."""
        self._settled.append((step, None))

    def _count(self) -> None:
        """Count what was noted, which most runs are too short to be asked for."""
        for step in self._to_compute:
            name = _kind(step)
            self._left[name] += 1
            if name not in self._gathers:
                inputs = step.inputs.values()
                self._gathers[name] = any(isinstance(source, Gathered) for source in inputs)
        for step, seconds in self._settled:
            name = _kind(step)
            self._left[name] -= 1
            if seconds is None:
                continue
            if name in self._first:
                self._latest.setdefault(name, deque(maxlen=_LATEST)).append(seconds)
            else:
                self._first[name] = seconds
            self._ended, self._spent = self._ended + 1, self._spent + seconds
        self._to_compute.clear()
        self._settled.clear()

    def estimate(self, elapsed: float) -> float | None:
        """Return the seconds to go; None before a method was called twice, now or in earlier runs.

        The first call of a method also imports and compiles what it needs, and calls at the same
        time may wait for that. So medians of the later calls count, and what the first ones took
        longer is expected of methods that have not been called.

        Parameters
        ----------
        elapsed
            Seconds since the first step was begun. The steps that ended in them say how fast
            this is, whatever runs at the same time.
        """
        self._count()
        repeated = self._repeated()
        known = {**self._earlier, **repeated}
        if not self._ended or not known:
            return None
        usual = fmean(known.values())
        # what gathers reads what many steps gave, and is as slow as the slowest rather than usual
        unknown = {True: max(repeated.values(), default=usual), False: usual}
        more = [max(0.0, self._first[name] - usually) for name, usually in repeated.items()]
        begin = fmean(more) if more else 0.0
        left = 0.0
        for name, count in self._left.items():
            if count > 0:
                each = known.get(name, unknown[self._gathers.get(name, False)])
                left += count * (each + _OVERHEAD) + (0.0 if name in self._first else begin)
        return elapsed * left / (self._spent + self._ended * _OVERHEAD)

    def typical(self) -> dict[str, float]:
        """Return the seconds of a step by node and method."""
        self._count()
        return self._first | self._repeated()

    def _repeated(self) -> dict[str, float]:
        return {name: median_low(latest) for name, latest in self._latest.items()}


def _kind(step: Step) -> str:
    """Return the kind of a step, whose steps take about as long: a method at a place of a graph."""
    return f"{step.node} {step.method.node.name}"

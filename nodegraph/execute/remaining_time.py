"""An estimate of the time that a run will still take, from the times of each method's steps."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from statistics import fmean, median

from nodegraph.plan import Step

_STARTING = 2
"""Calls of a method that may also import and compile what it needs, or wait for that."""
_FEWEST = 5
"""Calls after which the time of a method is known."""
_SHORTEST = 5
"""Seconds that steps which wait for each other, and the report after the last, may add."""


class RemainingTime:
    """Weighs the steps that are left by what steps of their method took.

    Parameters
    ----------
    steps
        The steps to be computed.
    seconds
        Duration of a step in earlier runs, as `typical` returns it.
    """

    def __init__(self, steps: Iterable[Step], seconds: Mapping[str, float]) -> None:
        self._earlier = seconds
        self._to_compute = list(steps)
        self._settled: list[tuple[Step, float | None]] = []
        self._left: Counter[str] = Counter()
        self._took: defaultdict[str, list[float]] = defaultdict(list)

    def add(self, step: Step, seconds: float | None) -> None:
        """Note the time of a step, with its inputs and its result; None if it was not computed."""
        self._settled.append((step, seconds))

    def estimate(self, elapsed: float) -> float | None:
        """Return the seconds to go; None while methods of unknown times may take most of them.

        None, too, for the last five, which steps that wait for each other and the report may
        double.

        A method that was called five times takes the mean of its calls but the first two, wherever
        it stands in the graph, any other what it took in earlier runs. Where that is unknown, it
        takes what its last call took; the first call of all is taken to be as long as the longest
        first call so far, and the others as long as the median of the methods.

        Parameters
        ----------
        elapsed
            Seconds since the first step was begun. The steps that ended in them say how many run
            at the same time.
        """
        self._count()
        if not self._took:
            return None
        usual = {name: _usual(calls) for name, calls in self._took.items()}
        known_now = {n: seconds for n, seconds in usual.items() if len(self._took[n]) >= _FEWEST}
        times = {**self._earlier, **known_now}
        typical = median(times.values() or usual.values())
        first = max(calls[0] for calls in self._took.values())
        known = unknown = 0.0
        for name, count in self._left.items():
            if name in times:
                known += count * times[name]
            elif name in usual:
                unknown += count * usual[name]
            elif count:
                unknown += first + (count - 1) * typical
        ended, left = sum(map(sum, self._took.values())), sum(self._left.values())
        if unknown > known or not (ended and left):
            return None
        # the last does not run as many at a time as the others did
        to_go = (known + unknown) * max(elapsed / ended, 1.0 / left)
        return to_go if to_go >= _SHORTEST else None

    def typical(self) -> dict[str, float]:
        """Return the seconds of a step by its method."""
        self._count()
        return {name: _usual(calls) for name, calls in self._took.items()}

    def _count(self) -> None:
        """Count what was noted, which most runs are too short to be asked for."""
        self._left.update(step.method.node.name for step in self._to_compute)
        for step, seconds in self._settled:
            name = step.method.node.name
            self._left[name] -= 1
            if seconds is not None:
                self._took[name].append(seconds)
        self._to_compute.clear()
        self._settled.clear()


def _usual(calls: Sequence[float]) -> float:
    """Return the mean of the calls after those that may compile, or the last of these."""
    return fmean(calls[_STARTING:] or calls[-1:])

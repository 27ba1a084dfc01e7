"""The events of a run, for progress, logs and other programs."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping
from datetime import datetime
from enum import StrEnum
from types import MappingProxyType
from typing import Any, NamedTuple

from nodegraph.execute.outcome import Outcome
from nodegraph.execute.remaining_time import RemainingTime
from nodegraph.plan import Plan, Step
from nodegraph.state import State

FORMAT = 1
_INTERVAL = 0.5
"""Seconds from one progress event to the next, at least."""


class EventKind(StrEnum):
    """Kinds of events beside the states in which steps end."""

    PLANNED = "planned"
    STARTED = "started"
    PROGRESS = "progress"
    FINISHED = "finished"
    INTERRUPTED = "interrupted"


class Event(NamedTuple):
    """Something that happened in a run.

    Attributes
    ----------
    kind : str
        An `EventKind`, or the `State` in which a step ended.
    seconds : float
        Since the run began.
    step : int
        The step's index in the plan, or -1 for the run as a whole.
    node : str
    labels : mapping of axis to label
    detail : mapping
        Further data of this kind of event: a reason, warnings, counts.
    """

    kind: str
    seconds: float
    step: int = -1
    node: str = ""
    labels: Mapping[str, object] = MappingProxyType({})
    detail: Mapping[str, Any] = MappingProxyType({})

    def as_dict(self) -> dict[str, object]:
        """Return the event as plain data, for a line of JSON."""
        data: dict[str, object] = {"event": self.kind, "seconds": round(self.seconds, 6)}
        if self.step >= 0:
            data |= {"step": self.step, "node": self.node, "labels": plain(self.labels)}
        return data | {name: plain(value) for name, value in self.detail.items()}


def plain(value: object) -> Any:
    """Return a value as JSON can write it; anything that JSON does not have becomes text."""
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, float):
        return value if math.isfinite(value) else str(value)
    return value if value is None or isinstance(value, (str, int)) else str(value)


Listener = Callable[[Event], None]


class EventLog:
    """Turns what becomes of a plan's steps into events, and hands these to listeners.

    Parameters
    ----------
    listeners
    plan
    about
        Further data of the first event, which says what is planned.
    """

    def __init__(
        self,
        listeners: tuple[Listener, ...],
        plan: Plan,
        about: Mapping[str, object],
    ) -> None:
        self.listeners = listeners
        self._start = time.perf_counter()
        self._ended: dict[int, State] = {}
        self._steps = len(plan.steps)
        self._next = _INTERVAL
        self._left: Collection[int] | None = None
        self._remaining = RemainingTime((), {})
        self._begun: dict[int, float] = {}
        if listeners:
            steps = Counter(step.node for step in plan.steps)
            labelled = (step for step in plan.steps if step.method.label)
            alternatives = Counter(f"{step.node}={step.method.label}" for step in labelled)
            self._emit(
                EventKind.PLANNED,
                {
                    "format": FORMAT,
                    "steps": self._steps,
                    "nodes": {name: steps[name] for name in plan.graph.nodes},
                    "alternatives": alternatives,
                    "title": plan.graph.title,
                    "began": datetime.now().astimezone().isoformat(timespec="milliseconds"),
                    **about,
                },
            )

    def seconds(self) -> float:
        """Return the seconds since the run began."""
        return time.perf_counter() - self._start

    def begin(
        self, left: Collection[int], steps: Iterable[Step], seconds: Mapping[str, float]
    ) -> None:
        """Note what is to be computed, once stored results have been looked up.

        Parameters
        ----------
        left
            The steps that are still to be settled, at any time.
        steps
            The steps to be computed.
        seconds
            The result of `typical_seconds` in earlier runs.
        """
        self._left = left
        self._remaining = RemainingTime(steps if self.listeners else (), seconds)

    def typical_seconds(self) -> dict[str, float]:
        """Return the seconds of the steps that were computed, by method."""
        return self._remaining.typical()

    def started(self, step: Step) -> None:
        """Report that a step is being computed."""
        begun = self._emit(EventKind.STARTED, {"use": step.method.node.name}, step)
        self._begun[step.index] = begun

    def settled(self, step: Step, outcome: Outcome) -> None:
        """Report how a step ended, and from time to time the progress of the run."""
        if not self.listeners:
            return
        status = outcome.status
        detail: dict[str, object] = {"took": round(outcome.seconds, 6)}
        if outcome.stored and status is not State.STORED:
            detail["stored"] = True
        if outcome.reason:
            detail["reason"] = outcome.reason
        if outcome.place:
            detail["place"] = outcome.place
        if outcome.warnings:
            detail["warnings"] = list(outcome.warnings)
        now = self._emit(status, detail, step)
        begun = self._begun.get(step.index)
        self._remaining.add(step, None if begun is None else now - begun)
        self._ended[step.index] = status
        if now >= self._next:
            self._next = now + _INTERVAL
            self._emit(EventKind.PROGRESS, self._progress())

    def interrupted(self) -> None:
        """Report that the run ends early."""
        self._emit(EventKind.INTERRUPTED, self._progress())

    def finished(self, counts: Callable[[], Mapping[str, int]]) -> None:
        """Report that the run is over, and how many steps ended in each state."""
        if self.listeners:
            self._emit(EventKind.FINISHED, dict(counts()))

    def _progress(self) -> dict[str, object]:
        counts = Counter(self._ended.values())
        left = self._steps - len(self._ended) if self._left is None else len(self._left)
        elapsed = self.seconds() - next(iter(self._begun.values()), 0.0)
        to_go = self._remaining.estimate(elapsed)
        listed = (State.STORED, State.REFUSED, State.FAILED, State.SKIPPED)
        return {
            "run": counts[State.DONE],
            **{state.value: counts[state] for state in listed},
            "unneeded": self._steps - len(self._ended) - left,
            "left": left,
            "to_go": None if to_go is None else round(to_go, 1),
        }

    def _emit(self, kind: str, detail: Mapping[str, object], step: Step | None = None) -> float:
        """Hand an event to the listeners, and return its time."""
        seconds = time.perf_counter() - self._start
        event = (
            Event(kind, seconds, detail=detail)
            if step is None
            else Event(kind, seconds, step.index, step.node, step.labels, detail)
        )
        for listener in self.listeners:
            listener(event)
        return seconds

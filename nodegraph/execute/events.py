"""The events of a run, for progress, logs and other programs."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
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
        about: Mapping[str, object] = MappingProxyType({}),
    ) -> None:
        self.listeners = listeners
        self._start = time.perf_counter()
        self._ended: dict[int, State] = {}
        self._steps = len(plan.steps)
        self._next = _INTERVAL
        self._left: Callable[[], int] = lambda: self._steps - len(self._ended)
        self._remaining = RemainingTime((), {})
        self._begun: dict[int, float] = {}
        if listeners:
            steps = Counter(step.node for step in plan.steps)
            labelled = (step for step in plan.steps if step.method.label)
            alternatives = Counter(f"{step.node}={step.method.label}" for step in labelled)
            self._emit(
                EventKind.PLANNED,
                None,
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
        self, left: Callable[[], int], steps: Iterable[Step], seconds: Mapping[str, float]
    ) -> None:
        """Note what is to be computed, once stored results have been looked up.

        Parameters
        ----------
        left
            Returns how many steps are still to be settled.
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
        now = self._emit(EventKind.STARTED, step, {"use": step.method.node.name})
        self._begun[step.index] = now

    def settled(self, step: Step, outcome: Outcome) -> None:
        """Report how a step ended, and from time to time the progress of the run."""
        if not self.listeners:
            return
        status = outcome.status
        if step.index in self._begun:
            self._remaining.add(step, self.seconds() - self._begun[step.index])
        else:
            self._remaining.drop(step)
        detail: dict[str, object] = {"took": round(outcome.seconds, 6)}
        if outcome.stored and status is not State.STORED:
            detail["stored"] = True
        for name in ("reason", "place"):
            if text := getattr(outcome, name):
                detail[name] = text
        if outcome.warnings:
            detail["warnings"] = list(outcome.warnings)
        now = self._emit(status, step, detail)
        self._ended[step.index] = status
        if now >= self._next:
            self._next = now + _INTERVAL
            self._emit(EventKind.PROGRESS, None, self._progress())

    def interrupted(self) -> None:
        """Report that the run ends early."""
        self._emit(EventKind.INTERRUPTED, None, self._progress())

    def finished(self, counts: Callable[[], Mapping[str, int]]) -> None:
        """Report that the run is over, and how many steps ended in each state."""
        if self.listeners:
            self._emit(EventKind.FINISHED, None, dict(counts()))

    def _progress(self) -> dict[str, object]:
        counts = Counter(self._ended.values())
        left = self._left()
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

    def _emit(self, kind: str, step: Step | None, detail: Mapping[str, object]) -> float:
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

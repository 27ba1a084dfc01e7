"""What happens during a run, as a stream that progress, logs and other programs draw from."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any

from nodegraph.execute.call import Outcome
from nodegraph.plan import Plan, Step

FORMAT = 1
_PROGRESS = 100
"""How often in a run listeners hear how far it is."""


@dataclass(frozen=True, slots=True)
class Event:
    """One thing that happened.

    Attributes
    ----------
    kind : str
        ``planned``, ``started``, ``done``, ``stored``, ``refused``, ``failed``, ``skipped``,
        ``progress``, ``finished`` or ``interrupted``.
    seconds : float
        Since the run began.
    step : int
        The step's index in the plan, or -1 for the run as a whole.
    node : str
    labels : mapping of axis to label
    detail : mapping
        What else there is to say: a reason, warnings, counts.
    """

    kind: str
    seconds: float
    step: int = -1
    node: str = ""
    labels: Mapping[str, Any] = field(default_factory=dict)
    detail: Mapping[str, Any] = field(default_factory=dict)

    def as_dict(self) -> dict[str, Any]:
        """Return the event as plain data, for a line of JSON."""
        said: dict[str, Any] = {"event": self.kind, "seconds": round(self.seconds, 6)}
        if self.step >= 0:
            said |= {"step": self.step, "node": self.node, "labels": plain(self.labels)}
        return said | {name: plain(one) for name, one in self.detail.items() if name not in said}


def plain(value: Any) -> Any:
    """Return a value as JSON knows it: what has no such form becomes text."""
    if isinstance(value, (list, tuple)):
        return [plain(one) for one in value]
    if isinstance(value, Mapping):
        return {str(key): plain(one) for key, one in value.items()}
    if isinstance(value, float):
        return value if math.isfinite(value) else str(value)
    return value if value is None or isinstance(value, (str, int)) else str(value)


Listener = Callable[[Event], None]


class Teller:
    """Tells listeners what becomes of a plan's steps.

    Attributes
    ----------
    left : callable
        Returns how many steps are still to be settled.
    """

    def __init__(self, listeners: tuple[Listener, ...], plan: Plan) -> None:
        self._listeners = listeners
        self._began = time.perf_counter()
        self._counts: Counter[str] = Counter()
        self._ended: dict[int, str] = {}
        self._each = max(1, len(plan.steps) // _PROGRESS)
        self._steps = len(plan.steps)
        self.left: Callable[[], int] = lambda: self._steps - len(self._ended)
        self._tell(
            "planned",
            None,
            {
                "format": FORMAT,
                "steps": self._steps,
                "nodes": len(plan.graph.nodes),
                "title": plan.graph.title,
                "began": datetime.now().astimezone().isoformat(timespec="milliseconds"),
            },
        )

    def seconds(self) -> float:
        """Return the seconds since the run began."""
        return time.perf_counter() - self._began

    def started(self, step: Step) -> None:
        """Tell that a step is being computed."""
        if self._listeners:
            self._tell("started", step, {"use": step.method.node.name})

    def settled(self, step: Step, outcome: Outcome) -> None:
        """Tell how a step ended, and now and then how far the run is."""
        if not self._listeners:
            return
        kind = "stored" if outcome.stored and outcome.state == "done" else outcome.state
        detail: dict[str, Any] = {"took": round(outcome.seconds, 6)}
        detail |= {"stored": True} if outcome.stored and kind != "stored" else {}
        detail |= {"reason": outcome.told} if outcome.reason else {}
        detail |= {"warnings": list(outcome.warnings)} if outcome.warnings else {}
        self._tell(kind, step, detail)
        self._counts[kind] += 1
        if step.index in self._ended:  # what was stored of it could not be used
            self._counts[self._ended[step.index]] -= 1
        self._ended[step.index] = kind
        if len(self._ended) % self._each == 0:
            self._tell("progress", None, self._progress())

    def interrupted(self) -> None:
        """Tell that the run ends before its time."""
        self._tell("interrupted", None, self._progress())

    def finished(self, counts: Mapping[str, int]) -> None:
        """Tell that the run is over."""
        self._tell("finished", None, dict(counts))

    def _progress(self) -> dict[str, Any]:
        computed = self._counts["done"] + self._counts["failed"] + self._counts["refused"]
        left = self.left()
        to_go = round(self.seconds() / computed * left, 1) if computed else None
        counts = {
            state: self._counts[state] for state in ("stored", "refused", "failed", "skipped")
        }
        unneeded = self._steps - sum(self._counts.values()) - left
        counts = {"run": self._counts["done"], **counts, "unneeded": unneeded}
        return {**counts, "left": left, "to_go": to_go}

    def _tell(self, kind: str, step: Step | None, detail: Mapping[str, Any]) -> None:
        if not self._listeners:
            return
        event = (
            Event(kind, self.seconds(), detail=detail)
            if step is None
            else Event(kind, self.seconds(), step.index, step.node, step.labels, detail)
        )
        for listener in self._listeners:
            listener(event)
